// SPDX-License-Identifier: GPL-3.0-or-later
// Roads to the accelerations and forces of a whole mechanism: closures, springs between points,
// driven joints and acceleration constraints together, as the scene has them.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/prepared_scene.hpp"
#include "crosscheck/witnesses/refusal.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** What is asked about a whole mechanism,

        M qdd + c + g + friction = tau + Q + springs + J' lambda,    J qdd + gamma = 0 (= value)

    kConstraintForce is J' lambda of all constraints together, n, which is unique also where
    redundant closures leave lambda undetermined. kReactions are what the joints of the tree
    transmit, as Witness::answer has it, with the wrenches of all these forces on the links. */
enum class MechanismQuantity {
  kQdd,              ///< n [rad/s^2, m/s^2]
  kConstraintForce,  ///< n [N m, N]
  kLambda,           ///< one a closure equation
  kNu,               ///< one an acceleration constraint
  kDrive,            ///< one a driven joint's rate [N m, N]: what the drive takes
  kReactions,        ///< 6 a link but the root [N, N m]
};
inline constexpr MechanismQuantity kMechanismQuantities[] = {
    MechanismQuantity::kQdd, MechanismQuantity::kConstraintForce, MechanismQuantity::kLambda,
    MechanismQuantity::kNu,  MechanismQuantity::kDrive,           MechanismQuantity::kReactions};
/// "mechanism qdd", "mechanism constraint force", "mechanism lambda", "mechanism nu", "mechanism
/// drive force": quantities of a crosscheck without that word are those of the tree.
const char* name(MechanismQuantity quantity);

/// A state of a mechanism, its closures closed.
struct MechanismState {
  scene::State<double> state;  ///< qdd: that of driven joints; tau: of the others
  /// Closure equations that stand for all; the others follow from them where phi = 0.
  std::vector<int> rows;
  bool is_redundant = false;  ///< rows are not all
  /// By reaction: 0 where redundant constraints leave it open. Empty: all are determined.
  std::vector<char> determined;
  int index = 0;
};

/// One road's numbers, and how far each may be from the exact one. Empty: not answered.
struct MechanismAnswer {
  struct Part {
    Eigen::VectorXd value, bound;
  };
  std::array<Part, std::size(kMechanismQuantities)> parts;
  Part& operator[](MechanismQuantity q) { return parts[static_cast<std::size_t>(q)]; }
  const Part& operator[](MechanismQuantity q) const { return parts[static_cast<std::size_t>(q)]; }
};

/** Limits are of first order: what each rounding of that very computation does to each number
    (AdjointTape::firstOrder), so that they neither run away on long chains nor know of any
    condition. Where closures are redundant, roads may let other equations stand for all, which is
    the same at a state that closes them and no two doubles do exactly: the state stands then for
    all that round to it. */
class MechanismRoad {
 public:
  virtual ~MechanismRoad() = default;
  virtual const std::string& name() const = 0;
  /// @throws std::exception  there is no answer at this state
  virtual MechanismAnswer answer(const MechanismState& state) = 0;
  /// Why it leaves a quantity out, where it does.
  virtual std::string whyLeftOut(MechanismQuantity) const { return ""; }
};

/// A road of this name, or why it cannot hold the scene.
struct NamedRoad {
  std::string name;
  OrRefusal<std::shared_ptr<MechanismRoad>> road;
};

/** All of them:
      loops_eliminated   closures: articulated bodies, each loop eliminated where it closes
      hybrid_sweep       no closures: hybrid dynamics, constraints by Popov and Vereshchagin
      lagrange_multipliers  one dense system, derived from T, V and the places of frames
      dense_system       the same made of M, bias, J and gamma of the sweeps
      simbody            Simbody's own constraints, springs and prescribed motions
      mujoco             M, bias and springs of MuJoCo, the rows of its equality constraints, and
                         the accelerations that they have without qdd; one dense system, solved
                         here. Its own solver keeps constraints soft, and leaves these out
    Reactions: the first two by Newton and Euler with the constraints' wrenches as outer loads
    (constrainedReactions()); lagrange_multipliers by multipliers of cut joints
    (symbolic::Reactions); dense_system by sweeps through the mechanism whose joints are cut, and
    where joints follow others, which the first two do not hold, as these; simbody by
    calcMobilizerReactionForces; mujoco none. */
std::vector<NamedRoad> mechanismRoads(const PreparedScene& scene);

/** The certified truth: Lagrange's dense system in balls, the precision doubled until the radius of
    every part is below 2^-104 of its largest entry. Its bound is that radius, and what rounding its
    middle to double may lose. */
std::shared_ptr<MechanismRoad> certifiedMechanism(const PreparedScene& scene);

/// What Simbody says (simbody.cpp), in the order of kMechanismQuantities; lambda and nu are empty,
/// and so are drives and reactions of a mechanism with rotors.
using SimbodyMechanism = std::function<std::array<Eigen::VectorXd, std::size(kMechanismQuantities)>(
    const scene::State<double>&)>;
/// @throws std::invalid_argument  the scene has what is not built there
SimbodyMechanism simbodyMechanism(const PreparedScene& scene);

template <typename T>
struct DenseEquations;

/// What MuJoCo says of a whole mechanism at a state (mujoco.cpp).
struct MujocoEquations {
  /// In the scene's rates and rows.
  std::shared_ptr<DenseEquations<double>> equations;
  /// How far each force may be off at these accelerations, since MuJoCo gathers forces in the axes
  /// of the world, about the tree's centre of mass. Until the next state is asked for.
  std::function<double(const Eigen::VectorXd& qdd)> force_error;
};
using MujocoMechanism = std::function<MujocoEquations(const scene::State<double>&)>;
/// @throws std::exception  MuJoCo is absent, or has no words for what the scene has
MujocoMechanism mujocoMechanism(const PreparedScene& scene);

}  // namespace dynwitness::crosscheck
