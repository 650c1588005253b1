// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness is: one independent way to answer questions about a mechanism.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/prepared_scene.hpp"
#include "crosscheck/witnesses/refusal.hpp"
#include "crosscheck/witnesses/witness_info.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

struct ExactWitness;
enum class Parameters;

/// What can be asked. Shapes: M n x n; c, g, tau, qdd n x 1; energies 1 x 1; momentum 6 x 1;
/// reactions 6 (links - 1) x 1.
enum class Quantity { kM, kc, kg, kTau, kQdd, kKinetic, kPotential, kMomentum, kReactions };

inline constexpr Quantity kAllQuantities[] = {
    Quantity::kM,         Quantity::kc,        Quantity::kg,
    Quantity::kTau,       Quantity::kQdd,      Quantity::kKinetic,
    Quantity::kPotential, Quantity::kMomentum, Quantity::kReactions};

/// "M", "c", "g", "tau", "qdd", "kinetic", "potential", "momentum", "reactions"
const char* name(Quantity quantity);
/// The quantity of that name. @throws scene::InputError listing the names that exist.
Quantity quantityNamed(const std::string& text);

struct Answer {
  Eigen::MatrixXd value;
  /// Entry by entry, how far value may be from the exact number: proven where the arithmetic is
  /// ours; for an outside engine the bound of its algorithm (engine_bound.hpp).
  Eigen::MatrixXd bound;
  /// The part of `bound` that is no rounding but a loss which the witness's convention card
  /// documents. Empty: none.
  Eigen::MatrixXd known_loss = {};
  /// Of qdd alone, the same two in the equations that it solves: how far
  ///     M value + c + g + friction - tau - Q
  /// may be from 0 [N m, N] (solve_bound.hpp). Empty for other quantities.
  Eigen::MatrixXd residual_bound = {}, residual_loss = {};
};

class Witness {
 public:
  virtual ~Witness() = default;
  virtual const std::string& name() const = 0;
  virtual bool answers(Quantity quantity) const = 0;
  /** The quantity at a state:  M(q);  c(q, qd), velocity products only;  g = dV/dq; tau = M qdd + c
      + g + friction(qd) - Q;  qdd from M qdd + c + g + friction(qd) = tau + Q, with Q the scene's
      loads; momentum of all moving links, with the rotors that they carry, in world axes about the
      world's origin, linear part first; reactions at q, qd, qdd: for every joint of the scene,
      fixed ones too, in the order of the links (all but the root), the wrench that the parent
      exerts on the link through the joint [N, N m], linear part first, about the origin of the
      moved joint frame and in its axes. It is all that passes: what the bearings hold and what
      drive, spring and friction do about the axis. The inertia d = n^2 J of a rotor takes its part
      of tau before the link; the moment by which a gyroscopic rotor is carried passes through its
      parent's joint. So along a joint's axis the wrench has

          Z'f = tau - d qdd - n J z'(dw/dt) - stiffness (q - rest) - friction(qd)

      with the third term for a gyroscopic rotor only, w being its parent's angular velocity; a
      rotor geared to several rates takes the same of each, n_k J (psi'' + a'(dw/dt)). */
  virtual Answer answer(Quantity quantity, const scene::State<double>& state) = 0;
  /// answer().value, without the work for its bound where that can be left out: for timing.
  virtual Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) {
    return answer(quantity, state).value;
  }
};

/// A witness of a scene, or why it cannot hold the scene.
using MadeWitness = OrRefusal<std::unique_ptr<Witness>>;

/// How witnesses are made: one entry a witness, in the order of the reports.
struct WitnessKind {
  WitnessInfo info;
  std::function<MadeWitness(const PreparedScene&)> make;
  /// The same formulas in the prime field (exact_witness.hpp). Empty: it computes in double only.
  std::function<OrRefusal<ExactWitness>(const PreparedScene&, Parameters)> make_exact = {};
  /// For each scene code is compiled, which takes ten times as long as all its other checks.
  bool is_compiled = false;
};

/// All witnesses that this build knows, the absent ones too (info.present = false).
std::vector<WitnessKind> witnessKinds();

/// The kinds of these names; of none: those that are present. @throws scene::InputError on a
/// name that does not exist or is absent from this build.
std::vector<WitnessKind> selectWitnesses(const std::vector<std::string>& names);

}  // namespace dynwitness::crosscheck
