// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/motion_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/studies/dependent_rates.hpp"
#include "crosscheck/studies/near_motion.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck::hamilton {

namespace {

/// The independent rates have to tell the others all along.
void requireDependence(const Problem& problem, const Node& node, double at_start) {
  constexpr double kLeast = 1e-6;
  if (!isFinite(node.slots, node.qd)) return;
  const double regularity = Dependence(problem, node.slots).regularity;
  if (!(regularity * at_start > 0 && std::abs(regularity) > kLeast))
    throw scene::InputError(
        {}, fmt::format("up to t = {:.6g} s the mechanism passes a place where the rates that are "
                        "independent at the start do not tell the others; allowed: a shorter "
                        "duration",
                        node.time));
}

/// When equal steps over `duration` leave the numbers [s]; never: infinity.
double leavesNumbers(const Problem& problem, double duration, int steps) {
  Flow<double> flow = problem.flow<double>();
  PhasePoint<double> y = problem.start;
  const double h = duration / steps;
  for (int k = 1; k <= steps; ++k) {
    y = flow.step(y, h);
    if (!isFinite(y.slots, y.qd)) return h * k;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<Node> motionOf(const Problem& problem, int steps) {
  Flow<double> flow = problem.flow<double>();
  Near<double> near(problem);
  const double h = problem.duration / steps;
  const Values none(problem.n(), 0.0);
  std::vector<Node> nodes;
  PhasePoint<double> y = problem.start;
  const double at_start = problem.isClosed() ? Dependence(problem, y.slots).regularity : 0;
  for (int k = 0; k <= steps; ++k) {
    if (k > 0) y = flow.step(y, h);
    const double share = k == 0 || k == steps ? 1 : k % 2 == 1 ? 4 : 2;
    Node node = {h * k, share * h / 3, y.slots, flow.slotRates(y), y.qd, {}};
    near.at(node, none, none);
    node.Q = near.forces();
    nodes.push_back(node);
    if (problem.isClosed()) requireDependence(problem, node, at_start);
  }
  return nodes;
}

double energyDrift(const Problem& problem, const std::vector<Node>& nodes) {
  recursive::Workspace<double> ws(problem.model);
  double start = 0, drift = 0;
  for (const Node& node : nodes) {
    const auto x = slotPositions(node.slots);
    double E = recursive::kineticEnergy(problem.model, x, node.qd, ws);
    if (problem.terms.gravity) E += recursive::potentialEnergy(problem.model, x, ws);
    if (&node == &nodes.front()) start = E;
    drift = std::max(drift, std::abs(E - start));
  }
  return drift;
}

void requireMotionAtStart(const Problem& problem) {
  Flow<double> flow = problem.flow<double>();
  require(isFinite(flow.slotRates(problem.start), flow.accelerations(problem.start)),
          "qdd is not finite at the start: M is singular there, or the numbers are too large; "
          "allowed: a start from which it moves");
}

[[noreturn]] void refuseUnresolved(const Problem& problem) {
  const double duration = problem.duration;
  double left = std::numeric_limits<double>::infinity();
  int steps = kMostSteps / 2;
  for (; steps <= kMostSteps; steps *= 2) {
    left = leavesNumbers(problem, duration, steps);
    if (std::isfinite(left)) break;
  }
  double passed = duration / 2;
  while (std::isfinite(leavesNumbers(problem, passed, kMostSteps / 2))) passed /= 2;
  throw scene::InputError(
      {}, fmt::format("duration is {} s: {} steps of {:.3g} s leave the numbers at t = {:.6g} s, "
                      "these steps do not resolve the motion; allowed: a shorter duration; of its "
                      "halves, {:.6g} s is the first that {} steps end",
                      duration, steps, duration / steps, left, passed, kMostSteps / 2));
}

}  // namespace dynwitness::crosscheck::hamilton
