// SPDX-License-Identifier: GPL-3.0-or-later
// How our own roads compute: for the files that compile it, one a scalar.
#pragma once

#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/mechanism_formulas.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/constrained_reactions.hpp"
#include "recursive/hybrid_dynamics.hpp"

namespace dynwitness::recursive::detail {
template <>
struct Rounds<crosscheck::AdjointError> : std::true_type {};
}  // namespace dynwitness::recursive::detail

namespace dynwitness::crosscheck {

/// Newton and Euler with the wrenches of constraints as outer loads.
template <typename Numbers, typename T = typename Numbers::Scalar>
VectorX<T> reactionsUnder(const scene::Mechanism& mechanism, const Numbers& number,
                          const scene::State<T>& state, const std::vector<T>& qdd,
                          const VectorX<T>& lambda, const VectorX<T>& nu) {
  recursive::MechanismOfJoints<T> of(mechanism, number);
  std::vector<T> out(6 * (mechanism.links.size() - 1), T(0));
  recursive::constrainedReactions(mechanism, number, state.x, state.qd, qdd, lambda, nu, of, out);
  return column(out);
}

/// What both sweeps start from: the model, the closures' equations, the springs' pull.
template <typename Numbers>
struct SweptWhole {
  using T = typename Numbers::Scalar;
  SweptWhole(const scene::Mechanism& mechanism, const Numbers& number, const scene::State<T>& state)
      : model(recursive::buildModel(mechanism, number)),
        ws(model),
        closures(recursive::buildConstraints(mechanism, number, model)),
        driven(recursive::drivenRates(mechanism)),
        pull(model.dof(), T(0)),
        tau(state.tau) {
    recursive::constraintEquations(model, state.x, state.qd, ws, closures);
    recursive::addSpringForces(model, recursive::buildPointSprings(mechanism, number, model),
                               closures.X_W, ws, pull);
    for (std::size_t i = 0; i < tau.size(); ++i) tau[i] += pull[i];
  }
  recursive::Model<T> model;
  recursive::Workspace<T> ws;
  recursive::Constraints<T> closures;
  std::vector<char> driven;
  std::vector<T> pull, tau;  ///< of the springs; with them
};

/// A sweep counts its equations by pivots, and leaves out what it takes for dependent: fewer than
/// were asked for are another mechanism's.
inline void requireAll(int counted, int asked) {
  if (counted < asked)
    throw std::runtime_error(fmt::format(
        "of {} constraint equations the sweep can tell {} apart: the next pivot of N_0 is below "
        "cbrt(eps)^2 of the first",
        asked, counted));
}

template <typename Numbers, typename T>
PartsOf<T> LagrangeMultipliers::operator()(const scene::Mechanism& mechanism, const Numbers& number,
                                           const MechanismState& at,
                                           const scene::State<T>& state) const {
  const DenseEquations<T> e = derivedEquations<true>(*derived, mechanism, number, state);
  Solved<T> x(e, mechanism, at, state);
  scene::State<T> moving = state;
  moving.qdd.assign(x.qdd.begin(), x.qdd.end());
  part(x.parts, MechanismQuantity::kReactions) =
      derivedReactions(*cut, e, mechanism, number, moving, x.forces, pullByLength(number));
  return x.parts;
}

template <typename Numbers, typename T>
PartsOf<T> DenseSystem::operator()(const scene::Mechanism& mechanism, const Numbers& number,
                                   const MechanismState& at, const scene::State<T>& state) const {
  Solved<T> x(sweptEquations(mechanism, number, state), mechanism, at, state);
  const auto k = static_cast<Eigen::Index>(mechanism.acceleration_constraints.size());
  part(x.parts, MechanismQuantity::kReactions) =
      cut ? cutForces(*cut, number, state, x.qdd, x.forces)
          : reactionsUnder(mechanism, number, state, std::vector<T>(x.qdd.begin(), x.qdd.end()),
                           VectorX<T>(x.forces.head(x.forces.size() - k)),
                           VectorX<T>(x.forces.tail(k)));
  return x.parts;
}

template <typename Numbers, typename T>
PartsOf<T> LoopsEliminated::operator()(const scene::Mechanism& mechanism, const Numbers& number,
                                       const MechanismState& at,
                                       const scene::State<T>& state) const {
  SweptWhole<Numbers> s(mechanism, number, state);
  const auto swept = recursive::closedForwardDynamics(s.model, state.x, state.qd, s.tau, s.closures,
                                                      s.ws, false, s.driven, state.qdd);
  requireAll(swept.rank, static_cast<int>(at.rows.size()));
  PartsOf<T> out;
  part(out, MechanismQuantity::kQdd) = column(swept.qdd);
  const VectorX<T> force = s.closures.J.transpose() * swept.lambda;
  part(out, MechanismQuantity::kConstraintForce) = force;
  if (!at.is_redundant) part(out, MechanismQuantity::kLambda) = swept.lambda;
  std::vector<T> taken(s.model.dof(), T(0));
  recursive::inverseDynamics(s.model, state.x, state.qd, swept.qdd, s.ws, taken);
  part(out, MechanismQuantity::kDrive) =
      ofDriven<T>(s.driven, column(taken) - column(s.pull) - force);
  part(out, MechanismQuantity::kReactions) =
      reactionsUnder(mechanism, number, state, swept.qdd, swept.lambda, VectorX<T>());
  return out;
}

template <typename Numbers, typename T>
PartsOf<T> HybridSweep::operator()(const scene::Mechanism& mechanism, const Numbers& number,
                                   const MechanismState&, const scene::State<T>& state) const {
  SweptWhole<Numbers> s(mechanism, number, state);
  const auto held =
      recursive::accelerationConstraints(mechanism, number, s.model, state.x, state.qd, s.ws);
  const int k = static_cast<int>(held.size());
  recursive::ConstraintWorkspace<T> cws(s.model, k);
  std::vector<T> qdd = state.qdd, tau = s.tau;
  recursive::hybridDynamics(s.model, state.x, state.qd, s.driven, held, s.ws, cws, qdd, tau);
  requireAll(cws.of_N.rank(), k);
  recursive::MatrixX<T> J(k, s.model.dof());
  if (k > 0) recursive::taskJacobian(s.model, held, s.ws, J);
  PartsOf<T> out;
  part(out, MechanismQuantity::kQdd) = column(qdd);
  part(out, MechanismQuantity::kConstraintForce) = J.transpose() * cws.nu;
  part(out, MechanismQuantity::kNu) = cws.nu;
  part(out, MechanismQuantity::kDrive) = ofDriven<T>(s.driven, column(tau) - column(s.pull));
  part(out, MechanismQuantity::kReactions) =
      reactionsUnder(mechanism, number, state, qdd, VectorX<T>(), VectorX<T>(cws.nu));
  return out;
}

}  // namespace dynwitness::crosscheck
