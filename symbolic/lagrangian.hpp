// SPDX-License-Identifier: GPL-3.0-or-later
// Kinetic and potential energy of a mechanism, with 3-D frames, velocities and moments of mass.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "scene/mimic.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/graph.hpp"

namespace dynwitness::symbolic {

using Vector3 = std::array<Value, 3>;

/// A symmetric matrix; (i, j) and (j, i) are one entry.
struct Symmetric {
  Value xx, yy, zz, xy, xz, yz;
  Value& operator()(int i, int j);
  const Value& operator()(int i, int j) const { return const_cast<Symmetric&>(*this)(i, j); }
};

/// One elementary motion of a frame, as scene::Step, with nodes for its numbers; or any turn.
struct FrameStep {
  bool is_rotation;
  int axis;    ///< rotation: 0, 1, 2 for x, y, z; -1: the turn that `columns` are
  Value c, s;  ///< rotation: cosine and sine of its angle
  Vector3 translation;
  std::array<Vector3, 3> columns{};  ///< axis -1: R, from coordinates after it to those before it
};

/// The moments of a body's mass about the origin of a frame, in that frame's axes: m [kg],
/// integral of r dm [kg m], and the inertia integral of (r'r 1 - r r') dm [kg m^2].
struct MassMoments {
  Value mass;
  Vector3 first;
  Symmetric second;
};

/** A body is a link that moves on its parent, with all that is fixed to it. Its frame is the joint
    frame after the joint's motion, turned (by a constant) so that the joint's axis is a coordinate
    axis: everything constant lies between one joint's motion and the next. */
struct Body {
  /// Cylindrical, universal and planar joints are turns and slides in a row.
  enum class Joint { kTurn, kSlide, kScrew, kBall, kFree };

  std::string name, joint_name;
  int parent;  ///< body, -1: the world
  Joint joint;
  int rate, slot;  ///< the joint's first rate (of a follower: its leader's) and position
  int axis;        ///< of the joint in the body's frame: 0, 1, 2
  bool reversed;   ///< the joint's direction is minus that axis
  std::vector<FrameStep> before;  ///< parent body's frame to this body's frame at q = 0
  MassMoments moments;
  Value rotor;  ///< gear_ratio^2 rotor_inertia
  Value spin;   ///< gear_ratio rotor_inertia of a gyroscopic rotor, otherwise 0
  Value stiffness, rest, pitch;
  Value ratio;           ///< of a follower's rate to its leader's
  bool follows = false;  ///< another joint: it has no rate of its own

  bool turns() const { return joint != Joint::kSlide; }
  bool hasOneRate() const { return joint != Joint::kBall && joint != Joint::kFree; }
  int rates() const { return hasOneRate() ? 1 : joint == Joint::kBall ? 3 : 6; }
  int quaternion() const { return joint == Joint::kFree ? slot + 3 : slot; }
};

/// Forms the energies of a mechanism in a graph.
class Lagrangian {
 public:
  Lagrangian(const scene::Mechanism& mechanism, const Options& options, Graph* graph);

  const std::vector<Body>& bodies() const { return bodies_; }
  int slots() const { return slots_; }

  /// X_i of each rate.
  std::vector<Direction> directions();

  /// The next revolute joint inboard, if it turns about the same direction as this one; else -1.
  int parallelInboard(int body);

  /// Shares of the bodies in T = sum (m v'v / 2 + (v x w)' first + w' second w / 2) + rotor qd^2/2
  /// + spin qd (angular velocity of the parent about the axis).
  std::vector<Value> kineticByVelocities();
  /** T once more, as a sum over joints instead of links: with h the momentum that the bodies
      outboard of joint i would have if body i rested, and I_i their composite moments of mass,
          T = sum_i (qd_i^2 s_i' I_i s_i / 2 + qd_i s_i' h_i). */
  Value kineticByCompositeBodies();
  /// Shares of the bodies in V = -gravity' (integral of r dm) + stiffness (q - rest)^2 / 2.
  std::vector<Value> potentialByBody();
  /// V with the first moments of mass gathered from the tips inward.
  Value potential();
  /// sum of f' v_at + m' w over the constant wrenches [W].
  Value wrenchPower();
  /** Rayleigh's function of the joints' friction [W]: its derivative by qd is what friction takes
      of tau.
          R = sum (viscous qd^2 / 2 + coulomb(sign qd) qd),  the sign being a constant of its own */
  Value dissipation();
  /** phi of all closures, one after the other (scene::Closure has the equations): both frames are
      placed in the world, and their origins and axes compared. */
  std::vector<Value> closureResiduals();
  /// Origin and x, y, z axis of a frame in the world, twelve numbers.
  std::vector<Value> placeAndAxes(const scene::Attachment& at);

 private:
  struct WorldOrBodyFrame {
    int body;                       ///< -1: the world
    std::vector<FrameStep> offset;  ///< body's frame to the scene's link frame
  };
  struct Velocities {
    Vector3 angular, linear;
    Value inboard;  ///< angular velocity of the parent about the axis of a joint of one rate
  };

  Value constant(const Rational& r) { return {graph_, graph_->constant(r)}; }
  Value number(const scene::Number& n);
  Vector3 vector(const scene::Vector& v);
  bool isExact(const scene::Number& n) const;
  std::pair<Value, Value> cosSin(const scene::Number& angle);
  std::vector<FrameStep> steps(const std::vector<scene::Step>& scene_steps);
  std::vector<FrameStep> axisSteps(const scene::Vector& axis, int* coordinate, bool* reversed);
  MassMoments linkMoments(const scene::MassProperties& inertia);
  void regroup();

  struct PlacedFrame {
    Vector3 origin;
    std::array<Vector3, 3> axes;
  };
  PlacedFrame inWorld(const scene::Attachment& at);
  /// One thing that a joint does: a turn about a coordinate axis of its body, a shift along it, or
  /// both, with this rate.
  struct Axis {
    int coordinate;
    bool turns, shifts;
    int rate_index;
    Value rate;
  };
  void addBodies(const scene::Link& link, WorldOrBodyFrame* frame);
  std::vector<FrameStep> uprightSteps(const scene::Vector& axis);
  std::vector<Axis> axesOf(int body);
  /// The joint's own motion: a turn by q, a shift by q, or both.
  std::vector<FrameStep> jointSteps(int body);
  std::vector<Velocities> velocities();
  int bodyCount() const { return static_cast<int>(bodies_.size()); }

  const scene::Mechanism& mechanism_;
  const Options options_;
  Graph* graph_;
  scene::ParameterValues values_;
  /// Size of an angle -> the angle as first written, and whether that was negative: so that an
  /// angle and its negative share their cosine.
  std::map<std::string, std::pair<scene::Number, bool>> angles_;
  std::map<std::string, int> axes_;  ///< axis -> the joint that names its angles
  std::vector<Body> bodies_;
  std::vector<scene::Follower> followers_;
  std::size_t next_follower_ = 0;
  int rates_ = 0, slots_ = 0;             ///< of the bodies so far
  std::vector<WorldOrBodyFrame> frames_;  ///< of the scene's links
  MassMoments world_;                     ///< what is fixed to the world
  Vector3 gravity_;
};

/// The parts of derive(): T, V and p, with what says how rates move positions; Q.
void formEnergies(const scene::Mechanism& mechanism, Lagrangian& lagrangian, Equations& e);
void formForces(Lagrangian& lagrangian, Equations& e);

}  // namespace dynwitness::symbolic
