// SPDX-License-Identifier: GPL-3.0-or-later
// What every witness reads: links joined by joints into a tree, with the numbers as written.
// This header holds data only. How a witness composes placements, shifts inertias or turns about
// an axis is its own business, because that is what the witnesses testify about.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/error.hpp"
#include "scene/expression.hpp"

namespace dynwitness::scene {

using Number = Expression;
using Vector = std::array<Number, 3>;

enum class JointKind {
  kFixed,
  kRevolute,     ///< q: turn about the axis
  kPrismatic,    ///< q: slide along the axis
  kHelical,      ///< q: turn about the axis, which advances along it by pitch [m/rad] q
  kCylindrical,  ///< (d, q): slide along the axis and turn about it
  kUniversal,    ///< (q1, q2): turn about x of the joint frame, then about the new y
  kPlanar,       ///< (x, y, q): shift along x and y, then turn about z (the axis)
  kSpherical,    ///< quaternion (w, x, y, z)
  kFloating,     ///< position of the link's origin in the joint frame, then quaternion
};
inline constexpr JointKind kAllJointKinds[] = {
    JointKind::kFixed,   JointKind::kRevolute,    JointKind::kPrismatic,
    JointKind::kHelical, JointKind::kCylindrical, JointKind::kUniversal,
    JointKind::kPlanar,  JointKind::kSpherical,   JointKind::kFloating};

const char* name(JointKind kind);
/// Degrees of freedom of a joint kind: how many rates qd it has.
int degreesOfFreedom(JointKind kind);

/** What a position says. One q is one slot, except that an orientation is four: a quaternion
    q = (w, x, y, z), which turns link axes into joint axes by

        R = 1 + 2 (w [v]x + [v]x [v]x) / (q'q),   v = (x, y, z)

    A unit quaternion is the usual choice; but R is a rotation for every q except 0, so that nothing
    needs to be normalised, and an element of any field will do. */
enum class SlotKind { kAngle, kLength, kQuaternion };

/** The position slots of a joint kind. Where rates are not the derivatives of slots (spherical and
    floating joints), they are those of the body, in the axes of the moved joint frame: the angular
    velocity (wx, wy, wz), after the velocity of its origin (vx, vy, vz) where it floats. */
const std::vector<SlotKind>& positionSlots(JointKind kind);
/// Whether qd are the derivatives of q.
bool ratesArePositionDerivatives(JointKind kind);
/// Whether the joint has an axis of its own; the others move in the joint frame as it stands.
bool hasAxis(JointKind kind);
/// What tells the rates of one joint apart: "" for the only one, otherwise "slide", "turn", "x",
/// ...
const std::vector<std::string>& rateNames(JointKind kind);

/// One elementary motion of a frame: a translation [m], or a turn about one of its axes [rad].
struct Step {
  enum class Kind { kTranslate, kRotateX, kRotateY, kRotateZ };
  Kind kind;
  Vector translation;  ///< kTranslate
  Number angle;        ///< kRotate*
};

/** Where a joint sits on its parent, in the spelling of the scene's author.

    kXyzRpy   joint frame = parent frame, moved by xyz, then turned R = Rz(yaw) Ry(pitch) Rx(roll);
              the link frame is the joint frame after the joint's motion.
    kDh       (standard Denavit-Hartenberg) the joint moves about/along z of the parent's frame; the
              link frame follows as  Rz(theta + q) Tz(d + q) Tx(a) Rx(alpha),  q in one of the two.
    kMdh      (modified, Craig) joint frame = Rx(alpha) Tx(a) Rz(theta) Tz(d) on the parent's frame;
              the link frame is the joint frame after the joint's motion. */
struct Placement {
  enum class Convention { kXyzRpy, kDh, kMdh };
  Convention convention = Convention::kXyzRpy;
  Vector xyz, rpy;            ///< kXyzRpy [m], [rad]
  Number a, alpha, d, theta;  ///< kDh, kMdh [m], [rad], [m], [rad]

  /// Parent's link frame to joint frame, and moved joint frame to link frame: steps to be composed
  /// from left to right (X = X_step0 * X_step1 * ...). Trivial steps (literal zeros) are left out.
  std::vector<Step> beforeJoint() const;
  std::vector<Step> afterJoint() const;
};

/** Friction of a joint with one q: it takes  viscous qd + coulomb sign(qd)  of the joint's force,
    where coulomb is `positive` while qd > 0 and `negative` while qd < 0 (both magnitudes, zero or
    more). At qd = 0 it is 0, by convention: what holds a joint at rest is no function of its state.
    */
struct Friction {
  Number viscous{0};                ///< [N m s/rad], [N s/m]
  Number positive{0}, negative{0};  ///< [N m], [N]

  bool isCoulomb() const { return !positive.isLiteralZero() || !negative.isLiteralZero(); }
  bool isNone() const { return viscous.isLiteralZero() && !isCoulomb(); }
};

/** A joint that follows another one, its leader:  q = multiplier q_leader + offset. Both have one
    position (revolute, prismatic, helical), and the leader may stand anywhere in the tree, or
    follow a third joint. A follower is no unknown: rates, accelerations and forces are those of the
    other joints, and what it takes to move a follower is part of its leader's force
    (scene/mimic.hpp). The multiplier is a rational number other than 0, and is not a parameter: it
    decides which functions of q there are. */
struct Mimic {
  std::string joint;     ///< the leader's name
  Number multiplier{1};  ///< [rad/rad], [m/rad], ...
  Number offset{0};      ///< [rad], [m]
};

/** A rotor of a joint of several rates nu, geared to all of them: it turns at  psi' = n'nu,  n its
    ratios. Several make the joint's rotor inertia a full matrix,

        D = sum of J n n'           tau = D nudot + ...,   T = nu'D nu / 2 + ...          (N'J N)

    and every symmetric matrix without negative eigenvalues is that of as many rotors as it has
    rank. With an axis a (of length 1 here) the rotor is gyroscopic: a symmetric body on the parent
    link, whose mass properties include it as it stands, that spins about a as the parent sees it;
    with w the parent's angular velocity

        T = J (a'w + psi')^2 / 2 - J (a'w)^2 / 2
        tau += n J (psi'' + a'dw/dt)              the parent's moment += J psi'' a + w x J psi' a

    The rates of spherical and floating joints are no derivatives, so that psi is no function of
    where the joint is: its gears hold it like wheels that roll. Such a rotor has an equation of its
    own, J (psi'' + a'dw/dt) = the moment of its gears, which takes part in tau with n (d'Alembert).
    There is no term of Hamel in it, which Lagrange's equations of T in the joint's rates alone
    would add: a constraint of rates must not be put into T before T is differentiated. */
struct Rotor {
  Number inertia{0};           ///< J [kg m^2]
  std::vector<Number> ratio;   ///< n, one a rate of the joint [rad/rad], [rad/m]
  std::optional<Vector> axis;  ///< of a gyroscopic one: in the joint frame, of any length but zero
};

/** A joint: the link moves about or along `axis`, given in the joint frame and of any non-zero
    length (revolute, prismatic, helical, cylindrical; the normal of a planar joint, whose x and y
    are those of the joint frame turned by AxisTurn). The others move in the joint frame as it
    stands. A rotor of inertia J [kg m^2], geared n times faster than the joint, adds n^2 J to the
    joint's own inertia; a spring adds  stiffness (q - rest)^2 / 2  to V. They and friction go with
    joints that have one q; joints of several have `rotors`.

    That is all of a rotor whose spin nobody else feels. A `gyroscopic` one is a symmetric body on
    the parent link, which turns at n qd about the joint's axis as the parent sees it. The parent's
    mass properties include it as it stands, locked to the parent; with w the parent's angular
    velocity and z the axis, its spin then adds to T

        J (z'w + n qd)^2 / 2 - J (z'w)^2 / 2  =  n^2 J qd^2 / 2 + n J qd z'w

    A driven joint follows its motion, q(t), one function of time a position; whatever force that
    takes is there. M, c, g and the forward dynamics of the tree do not know it; simulation and
    hybrid dynamics do. */
struct Joint {
  std::string name;
  JointKind kind = JointKind::kFixed;
  Placement placement;
  Vector axis{Number(0), Number(0), Number(1)};
  Number pitch{0};  ///< helical: advance a radian [m/rad]
  Number rotor_inertia{0}, gear_ratio{1};
  bool gyroscopic = false;
  std::vector<Rotor> rotors;  ///< of a joint of several rates
  Friction friction;
  Number stiffness{0}, rest{0};
  std::vector<Expression> motion;  ///< of t [rad], [m]; none: the joint is free
  std::optional<Mimic> mimic;      ///< none: it follows no other

  /// How many rates it brings along: those of its kind, but a follower none.
  int ownRates() const { return mimic ? 0 : degreesOfFreedom(kind); }
};

/** Mass [kg], centre of mass [m] in the link frame, and the rotational inertia [kg m^2] I = [xx xy
    xz; xy yy yz; xz yz zz]: products of inertia carry the matrix's sign (xy = -sum m x y). `about`
    says about which point; `rpy` turns link axes into the axes in which I is given (zero: link
    axes). */
struct MassProperties {
  enum class About { kCenterOfMass, kLinkOrigin };
  Number mass{0};
  Vector com;
  About about = About::kCenterOfMass;
  Vector rpy;
  Number xx, yy, zz, xy, xz, yz;
};

/// A link and the joint that carries it. The root (index 0) has parent -1 and rests in the world.
struct Link {
  std::string name;
  int parent = -1;
  Joint joint;
  MassProperties inertia;
  SourceLocation where;  ///< for messages about this link

  // compiled once, as those of Mechanism and Scene are: hundreds of files copy one
  Link();
  Link(const Link&);
  Link(Link&&) noexcept;
  Link& operator=(const Link&);
  Link& operator=(Link&&) noexcept;
  ~Link();
};

/// A constant force [N] and moment [N m] on a link, the force acting at the point `at` (link frame,
/// m); both are given in link axes or in world axes.
struct Wrench {
  enum class Axes { kLink, kWorld };
  int link = 0;
  Vector force, moment, at;
  Axes axes = Axes::kLink;
};

/// A frame fixed to a link: the link frame, moved by xyz [m], then turned by rpy [rad].
struct Attachment {
  int link = 0;
  Vector xyz, rpy;

  std::vector<Step> steps() const;  ///< link frame to this frame, to be composed from left to right
};

/// Which relative motions of frame b on frame a a closure takes away.
enum class ClosureKind {
  kDistance,     ///< the origins keep their distance, as if a massless rod joined them
  kPlane,        ///< b's origin stays in a's xy plane: z
  kPlanarPoint,  ///< b's origin stays on a's z axis: x, y. For mechanisms that move in that plane
  kPoint,        ///< b's origin stays at a's: x, y, z
  kHinge,        ///< a point, and b's z axis stays parallel to a's: a turn about z is left
  kWeld,         ///< a hinge, and b's y axis stays at right angles to a's x axis: nothing is left
  kSkate,        ///< a blade at b's origin along its x axis, which does not slip sideways: y
  kRolling,      ///< b is a disc about its z axis that rolls on a's xy plane: x, y, z
};
const char* name(ClosureKind kind);
/// 1, 1, 2, 3, 5, 6, 1, 3
int equationCount(ClosureKind kind);
/// Whether equation `row` of this kind is about rates alone, so that no position fails it
/// (nonholonomic): of a skate, and the first two of a rolling disc.
bool isOfRates(ClosureKind kind, int row);

/** A loop closure: two frames of two links, held together. With d the origin of b seen from a, in
    a's axes, and x, y, z the axes of the frame named, its equations phi = 0 are, in this order,

        d_x, d_y;   d_z;   x_a . z_b, y_a . z_b;   x_a . y_b

    as far as the kind goes; of a distance  (d . d - length^2) / 2, of a plane  d_z.

    A skate asks  y_b . d' = 0, d' the rate of d in a's axes.

    A rolling disc of radius r about z_b, its centre h = d_z > 0 above the plane, touches it at

        rho = -(n - (n . z_b) z_b) r^2 / h  from its centre; n = z_a, and |rho| = r while it touches

    The point of the disc that is there rests:  (d' + w x rho)_x,  (d' + w x rho)_y = 0, w being how
    b turns on a; that it touches is  (h - (1 - (n . z_b)^2) r^2 / h) / 2 = 0, whose rate is
    (d' + w x rho)_z there. So all three multipliers are the force on the disc in a's axes. Nothing
    is divided by what vanishes before the disc lies flat, h = 0. */
struct Closure {
  std::string name;
  ClosureKind kind = ClosureKind::kPoint;
  Attachment a, b;
  Number length{0};  ///< of a distance; the radius of a rolling disc [m]
  SourceLocation where;
};

/** A spring with a damper between the origins of two frames, at distance l:
    they pull towards each other with  stiffness (l - rest) + damping dl/dt  [N]. */
struct Spring {
  std::string name;
  Attachment a, b;                           ///< rpy is not used
  Number stiffness{0}, rest{0}, damping{0};  ///< [N/m], [m], [N s/m]
  SourceLocation where;
};

/** What is asked of the acceleration of a link, one number: with xdd that of the point `at` (link
    frame), wd the link's angular acceleration, both against the world,

        direction . xdd + rotation . wd + compliance nu = value          [m/s^2], [rad/s^2]

    nu [N], [N m] is the force along the direction, or the moment, that holds it; compliance > 0
    [1/kg], [1/(kg m^2)] lets it give way. The same table is the task of an operational-space
    controller. */
struct AccelerationConstraint {
  enum class Axes { kLink, kWorld };
  std::string name;
  int link = 0;
  Vector at, direction, rotation;
  Axes axes = Axes::kWorld;  ///< of direction and rotation
  Number value{0}, compliance{0};
  SourceLocation where;
};

struct Parameter {
  std::string name;
  Number value;  ///< in terms of the parameters before it
  SourceLocation where;
};

/// A tree of links in topological order: links[i].parent < i, links[0] is the root.
struct Mechanism {
  std::vector<Parameter> parameters;
  bool has_gravity = false;
  Vector gravity;  ///< [m/s^2], world axes
  std::vector<Link> links;
  std::vector<Wrench> wrenches;
  std::vector<Closure> closures;
  std::vector<Spring> springs;  ///< between two points; those of joints stand with the joint
  std::vector<AccelerationConstraint> acceleration_constraints;

  Mechanism();
  Mechanism(const Mechanism&);
  Mechanism(Mechanism&&) noexcept;
  Mechanism& operator=(const Mechanism&);
  Mechanism& operator=(Mechanism&&) noexcept;
  ~Mechanism();

  int dof() const;  ///< how many rates qd there are; followers have none
  int positions()
      const;  ///< how many position slots there are: one a rate, a quaternion and a follower
  bool hasMimics() const;
  bool hasGearedRotors() const;  ///< whether some joint has `rotors`
  /// Whether rates belong together beyond the axes of a joint: by followers or by geared rotors.
  /// Sweeps then cannot solve for each axis where they pass it.
  bool hasCoupledRates() const { return hasMimics() || hasGearedRotors(); }
  /// True when the tree alone is the whole mechanism: no closures, no springs between points.
  bool isOpenTree() const { return closures.empty() && springs.empty(); }
  bool hasClosuresOfRates() const;  ///< of rates alone (isOfRates)
  bool hasFriction() const;
  bool hasCoulombFriction() const;
  bool hasGyroscopicRotors() const;
  /// Indices of the links whose joints move, in the order of q; those of followers among them.
  std::vector<int> movingLinks() const;
  /// By degree of freedom: the driven ones' functions of t, nullptr for the free.
  std::vector<const Expression*> motions() const;
  bool isDriven() const;  ///< whether any joint is
  /// What each position slot says, in the order of q.
  std::vector<SlotKind> slots() const;
  /// Names of the degrees of freedom, in the order of qd: that of the joint, or "joint.turn".
  std::vector<std::string> rateLabels() const;
  /// All q zero, orientations that of the joint frame: (1, 0, 0, 0). Followers are where that puts
  /// them.
  std::vector<Number> restPosition() const;
  /// Exact values of all parameters.
  ParameterValues parameterValues() const;
};

}  // namespace dynwitness::scene
