// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/impulse.hpp"

#include <cmath>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/impulse_laws.hpp"
#include "crosscheck/studies/squares.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"
#include "recursive/constrained_solver.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {
namespace {

using Error = RunningError;

recursive::Vector3<Error> vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

template <typename From, typename To>
void copy(const From& from, To* to) {
  for (Eigen::Index i = 0; i < from.size(); ++i) (*to)[i] = from(i).value();
}

}  // namespace

ImpulseResult strike(const scene::Scene& scene, const ImpulseOptions& options) {
  const scene::Mechanism& mechanism = scene.mechanism;
  requireTreated(scene, Command::kImpulse);
  requireMotion(scene);
  scene::State<double> state;
  std::vector<scene::Number>
      own;  // one a position that is given: followers are where their leaders put them
  for (const int slot : scene::givenSlots(mechanism)) own.push_back(scene.start_q[slot]);
  for (const double q :
       scene::allPositions(mechanism, givenOr("q", options.q, inDouble(scene, own))))
    state.x.push_back(scene::jointPosition(q));
  state.qd = givenOr("qd", options.qd, inDouble(scene, scene.start_qd));
  state.qdd.assign(state.qd.size(), 0.0);
  state.tau = state.qdd;
  if (!options.joints.empty() && options.joints.size() != state.qd.size())
    throw scene::InputError({}, fmt::format("joint impulses: {} values, allowed: {}",
                                            options.joints.size(), state.qd.size()));
  if (!(options.restitution >= 0 && options.restitution <= 1))
    throw scene::InputError(
        {}, fmt::format("restitution is {}, allowed: from 0 to 1", options.restitution));
  const double length =
      std::hypot(options.direction[0], options.direction[1], options.direction[2]);
  const bool is_impact = length > 0;

  // which closure equations stand for all
  const scene::RealNumbers<double> number(mechanism);
  const auto model = recursive::buildModel(mechanism, number);
  auto closures = recursive::buildConstraints(mechanism, number, model);
  recursive::Workspace<double> ws(model);
  recursive::constraintEquations(model, state.x, state.qd, ws, closures);
  Eigen::MatrixXd M(model.dof(), model.dof());
  recursive::massMatrix(model, state.x, ws, M);
  const double weight = weightOf(M);
  requireSquares("impulse", options.force, weight);
  requireSquares("moment", options.moment, weight);
  requireSquares("joint impulse", options.joints, weight);
  requireSquares("velocity", state.qd, weight);
  requireSquares("point", options.at);
  requireSquares("normal of the wall", options.direction);
  recursive::ConstrainedSolver<double> solver;
  solver.factorize(M, closures.J);

  ImpulseModel<Error> with_bounds(mechanism, RunningErrorNumbers(mechanism),
                                  solver.independentRows());
  const scene::State<Error> at = runningErrorState(state, mechanism);
  Impulse<Error> impulse;
  impulse.point = {linkNamed(scene, options.link), vector(options.at)};
  impulse.p = {vector(options.force), vector(options.moment)};
  impulse.joints.assign(state.qd.size(), Error(0));
  for (std::size_t i = 0; i < options.joints.size(); ++i) impulse.joints[i] = options.joints[i];
  impulse.direction = vector({0, 0, 1});
  if (is_impact) {
    const std::array<double, 3>& d = options.direction;
    impulse.direction = vector({d[0] / length, d[1] / length, d[2] / length});
  }
  impulse.restitution = options.restitution;
  const Struck<Error> struck =
      is_impact ? with_bounds.impact(at, impulse) : with_bounds.strike(at, impulse);

  ImpulseResult out;
  out.before = state.qd;
  for (Eigen::Index i = 0; i < struck.after.size(); ++i) {
    out.after.push_back(struck.after(i).value());
    out.after_bound.push_back(struck.after(i).bound());
  }
  copy(struck.point_before.head<3>().eval(), &out.point_before);
  copy(struck.point_after.head<3>().eval(), &out.point_after);
  copy(struck.p, &out.impulse);
  for (Eigen::Index i = 0; i < struck.closures.size(); ++i)
    out.closures.push_back(struck.closures(i).value());
  out.equations = closures.rows();
  copy(struck.momentum_jump, &out.momentum_jump);
  copy(struck.support, &out.support);
  out.energy_before = struck.energy_before.value();
  out.energy_after = struck.energy_after.value();
  out.effective_mass = struck.effective_mass.value();

  // the laws of what happened: the wall's impulse as a given one
  if (is_impact) impulse.p = {struck.p.head<3>(), struck.p.tail<3>()};
  out.checks = withinBounds(ImpulseLaws::words(mechanism),
                            ImpulseLaws::sides(mechanism, Blow<Error>(with_bounds, at, impulse)));
  return out;
}

}  // namespace dynwitness::crosscheck
