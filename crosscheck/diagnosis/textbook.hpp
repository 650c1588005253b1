// SPDX-License-Identifier: GPL-3.0-or-later
// A textbook's dynamics into which mistakes can be put: what an engine that makes them answers.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

using Vector3d = Eigen::Vector3d;
using Matrix3d = Eigen::Matrix3d;

/// Of an inner frame in an outer one: x_outer = R x_inner + p.
struct Frame {
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();

  Frame operator*(const Frame& inner) const { return {R * inner.R, p + R * inner.p}; }
};

/// One step of a placement as a number: a shift, or a turn about x, y, z [rad].
struct PlacementStep {
  int axis = -1;  ///< 0, 1, 2: of the turn; -1: a shift
  double angle = 0;
  Vector3d shift = Vector3d::Zero();
};
Frame composed(const std::vector<PlacementStep>& steps);

/** One link and the joint that carries it, in the numbers that the protocol of engines gives
    (witnesses/engine_protocol.md) and in those that it leaves out: placements step by step, and the
    inertia as it was written. */
struct TextbookLink {
  std::string name, joint;
  int parent = -1;
  double mass = 0;
  Vector3d com = Vector3d::Zero();      ///< in the link frame [m]
  Matrix3d inertia = Matrix3d::Zero();  ///< about the centre of mass, in link axes [kg m^2]
  Matrix3d written = Matrix3d::Zero();  ///< in axes of its own, turned by `axes` into link axes
  Matrix3d axes = Matrix3d::Identity();
  bool about_origin = false;  ///< written about the link's origin
  scene::JointKind kind = scene::JointKind::kFixed;
  bool is_dh = false, is_mdh = false;  ///< as the placement was written
  std::vector<PlacementStep> before_steps, after_steps;
  Frame before, after;
  Vector3d axis = Vector3d::UnitZ();
  double pitch = 0, rotor = 0, gear = 1;  ///< rotor: J [kg m^2]; it adds gear^2 J to its joint
  double added = 0;                       ///< gear^2 J
  double spin = 0;                        ///< gear J of a gyroscopic rotor
  double viscous = 0, coulomb[2] = {0, 0}, stiffness = 0, rest = 0;
  int q = 0, qd = 0;  ///< where its positions and rates begin
};

struct TextbookWrench {
  int link;
  bool in_world;
  Vector3d force, moment, at;
};

struct TextbookModel {
  int positions = 0, dof = 0;
  Vector3d gravity = Vector3d::Zero();
  std::vector<TextbookLink> links;
  std::vector<TextbookWrench> wrenches;
};
/// Of a tree of joints that follow no others.
TextbookModel textbookModel(const scene::Scene& scene);

/** How the formulas are applied. Everything as it stands here is right. The terms are those of

        tau = factor_M M qdd + factor_c c + g + friction - Q                                     (1)
        c = sum over links of  Jv' m (dJv/dt qd) + Jw' (I (dJw/dt qd) + w x I w)                 (2)

    with Jv, Jw the Jacobians of the centre of mass and of the turn of the link. */
struct Formulas {
  /// What is left of (2): accelerations that come of velocities, of points, of turns, w x I w.
  bool point_bias = true, turn_bias = true, gyroscopic = true;
  int not_gyroscopic = -1;     ///< the link that alone has no w x I w
  bool centripetal = true;     ///< w x (w x r)
  bool slide_coriolis = true;  ///< 2 w x v of slides
  /// What a moved axis adds to wd and a, or, as v x Z qd, to the spatial acceleration.
  enum class Bias { kKept, kMoved, kSpatial } joint_bias = Bias::kKept;
  int biased_joint = -1;  ///< the link that it carries; -1: every
  enum class Products { kAll, kSquares, kMixed } products = Products::kAll;  ///< of rates, in c
  double factor_M = 1, factor_c = 1, factor_kinetic = 1;
  bool factor_in_tau = true;  ///< whether tau has these factors as well
  bool c_times_qd = false;    ///< c multiplied by the rates, entry by entry
  bool qdd_ignored = false;
  bool gravity_in_c = false, g_twice_in_tau = false;
  bool gravity_not_turned = false;  ///< every link has the world's gravity in its own axes
  int gravity_turns_with = -1;      ///< the link in whose axes it is taken
  enum class Triangle { kBoth, kLower, kUpper } triangle = Triangle::kBoth;
  bool triangle_in_tau = false;
  /// M has this triangle of itself in the other one, too, which matters where it is not symmetric.
  Triangle mirrored = Triangle::kBoth;
  /// Sine and cosine of joints' angles: terms of their series. 0: as they are.
  int sine_terms = 0, cosine_terms = 0;
  bool reduced = false;  ///< angles are brought to [-pi, pi] first
  /// Sweeps in world axes, which are other numbers where a turn is no rotation.
  bool in_world = false;
  int turned_back = -1;  ///< the link whose orientation in its parent is transposed
  enum class Com { kOwn, kParentFrame, kParentAxes };
  int com_elsewhere = -1;  ///< the link whose centre of mass is taken so
  Com com = Com::kOwn;
  /// Of reactions: about which point of the link the moment is, in whose axes both stand.
  enum class About { kJoint, kLink, kCom } reaction_about = About::kJoint;
  enum class Axes { kJoint, kLink, kWorld } reaction_axes = Axes::kJoint;
  bool reaction_on_parent = false;  ///< what the link exerts on its parent
  bool moment_first = false;
};

/// How positions, rates and forces are passed on. Right as it stands.
struct Passing {
  std::vector<int> order;  ///< of one-axis joints' slots: theirs[i] is taken for i; empty: as it is
  std::vector<int> position_order;  ///< the same of positions
  std::vector<double> sign;         ///< of rates and of the positions that go with them
  std::vector<double> position_sign;
  bool xyzw = false;      ///< quaternions (w, x, y, z) are taken for (x, y, z, w)
  double angle_unit = 1;  ///< positions of turns are multiplied by it
  /// Rates of spherical and floating joints are taken in the axes of the joint frame: angular
  /// velocities, velocities of floating joints (with their derivative in these axes).
  bool world_turns = false, world_slides = false;
  bool world_forces = true;  ///< and so are the forces
};

/// What of the state is that of the question before.
struct Stale {
  bool q = false, qd = false, qdd = false;
};

/// Somebody's mistaken idea of a mechanism's dynamics.
struct Belief {
  TextbookModel model;
  Formulas formulas;
  Passing passing;
  Stale stale;  ///< for whoever knows the question before
};

/** Newton and Euler as a textbook of robotics has them (Luh, Walker and Paul), in vectors of three,
    accelerations of points, link by link in the moved joint frame:

        w = E (w_p) + Z_w qd,   wd = E wd_p + Z_w qdd + (E w_p) x Z_w qd
        a = E (a_p + wd_p x r + w_p x (w_p x r)) + Z_v qdd + 2 (E w_p) x Z_v qd + Z_w qd x Z_v qd
        F = m (a + wd x rc + w x (w x rc)),   N = I wd + w x I w

    and inward f, n with tau = Z_v' f + Z_w' n. It shares no code with the sweeps of recursive/, so
    that a right engine is not measured by what may be wrong there. The same sweep runs in axes of
    the world, with E = 1. */
class Textbook {
 public:
  explicit Textbook(const Belief& belief);

  /// M, c, g, tau, kinetic, potential, momentum, reactions: shaped like the quantity.
  /// @param solved_for_qdd  of tau: as it stands in the equations that forward dynamics solves,
  ///                        from which M qdd is not left out whoever leaves it out of tau
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<double>& state,
                             bool solved_for_qdd = false) const;
  /// M qdd by one sweep, where M as it is answered has no more to it.
  Eigen::VectorXd inertial(const scene::State<double>& state) const;

 private:
  struct Part {
    enum class Kind { kRigid, kTurn, kSlide, kBall, kFree } kind = Kind::kRigid;
    int parent = -1, link = -1;  ///< part; link: that it carries, -1: none
    int joint = -1;              ///< link whose joint it is a part of
    int q = 0, qd = 0, rates = 0;
    Frame before;
    Vector3d axis = Vector3d::UnitZ();
    double pitch = 0;
    double mass = 0;
    Vector3d com = Vector3d::Zero();
    Matrix3d inertia = Matrix3d::Zero();
    Frame after;
    double added = 0, spin = 0, viscous = 0, coulomb[2] = {0, 0}, stiffness = 0, rest = 0;
  };
  struct Placed {
    Matrix3d E;  ///< parent axes to own
    Vector3d r;  ///< own origin in the parent's frame
    Vector3d com;
    Matrix3d Z = Matrix3d::Identity();  ///< the part's axes to those of the sweep
  };
  using Vector = Eigen::VectorXd;
  struct Input {
    Vector q, qd, qdd;
  };

  Input received(const scene::State<double>& state) const;
  std::vector<Placed> placed(const Vector& q) const;
  std::vector<Placed> inWorldAxes(std::vector<Placed> at) const;
  /// Of a part, in the axes of the sweep.
  struct Motion {
    Vector3d w = Vector3d::Zero(), v = Vector3d::Zero();
    Vector3d wd = Vector3d::Zero(), a = Vector3d::Zero();      // with what velocities add
    Vector3d wd_J = Vector3d::Zero(), a_J = Vector3d::Zero();  // J qdd alone, and gravity
    Matrix3d R = Matrix3d::Identity();                         // own axes to the world's
  };
  struct Wrench {
    Vector3d f, n;  ///< n about the part's origin
  };
  /// Through the joint.
  struct JointMotion {
    Vector3d w = Vector3d::Zero(), v = w, wd = w, a = w;
  };
  static JointMotion jointMotion(const Part& part, const Matrix3d& Z, const Vector& qd,
                                 const Vector& qdd);
  Motion moved(const Part& part, const Placed& at, const Motion& up, const JointMotion& J) const;
  Wrench needed(const Part& part, const Placed& at, const Motion& here, bool raw_gravity) const;
  void addLoads(const std::vector<Placed>& at, const std::vector<Motion>& m,
                std::vector<Wrench>& through) const;
  Vector passedInward(const std::vector<Placed>& at, const std::vector<Motion>& m, const Vector& qd,
                      const Vector& qdd, std::vector<Wrench>& through) const;
  /// @param reactions  if given, becomes what passes through the joints
  Vector sweep(const std::vector<Placed>& at, const Vector& qd, const Vector& qdd, bool gravity,
               bool loads, Eigen::MatrixXd* reactions = nullptr) const;
  Eigen::MatrixXd answeredReactions(const std::vector<Placed>& at, const std::vector<Motion>& m,
                                    const std::vector<Wrench>& through) const;
  Vector springs(const Vector& q) const;
  Vector friction(const Vector& qd) const;
  Vector3d gravity(const std::vector<Placed>& at) const;
  double potential(const std::vector<Placed>& at, const Vector& q) const;
  Vector momentum(const std::vector<Placed>& at, const Vector& qd) const;
  Eigen::MatrixXd answeredForces(const Vector& tau, const Vector& q) const;

  Formulas formulas_;
  Passing passing_;
  Vector3d gravity_;
  int dof_ = 0, positions_ = 0;
  bool simple_ = true, has_loads_ = false;
  std::vector<Part> parts_;
  std::vector<int> place_of_link_;
  std::vector<TextbookWrench> wrenches_;
};

}  // namespace dynwitness::crosscheck
