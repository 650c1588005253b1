// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/action_problem.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/squares.hpp"

namespace dynwitness::crosscheck::hamilton {

bool isFinite(const Values& slots, const Values& qd) {
  const auto holds = [](double x) { return std::isfinite(x); };
  return std::all_of(slots.begin(), slots.end(), holds) && std::all_of(qd.begin(), qd.end(), holds);
}

void require(bool holds, const std::string& message) {
  if (!holds) throw scene::InputError({}, message);
}

Problem problemOf(const scene::Scene& scene, const ActionOptions& options) {
  requireTreated(scene, options.potential ? Command::kAction : Command::kGeometry);
  requireMotion(scene);
  const scene::RealNumbers<double> number(scene.mechanism);
  Problem problem = {recursive::buildModel(scene.mechanism, number),
                     options.potential ? recursive::Terms::all() : recursive::Terms::none(),
                     options.damping,
                     options.duration,
                     true,
                     true,
                     {},
                     recursive::Constraints<double>(),
                     {}};
  problem.closures = recursive::buildConstraints(scene.mechanism, number, problem.model);
  require(options.duration > 0 && std::isfinite(options.duration),
          fmt::format("duration is {} s, allowed: positive", options.duration));
  require(options.damping >= 0 && std::isfinite(options.damping),
          fmt::format("damping is {}, allowed: zero or more", options.damping));
  require(options.paths >= 1, fmt::format("{} paths, allowed: one or more", options.paths));
  problem.start.slots = givenOr("start q", options.q, inDouble(scene, scene.start_q));
  problem.start.qd = givenOr("start qd", options.qd, inDouble(scene, scene.start_qd));
  problem.surface = surfaceNear(scene, problem.start.slots, problem.start.qd);
  problem.start = {problem.surface.q, problem.surface.qd};
  requireSquares("velocity", problem.start.qd, weightsAt(problem.model, problem.start.slots));
  for (const auto& link : problem.model.links)
    if (recursive::axisCount(link.kind) > 1) problem.coordinates = false;
  problem.conservative =
      options.damping == 0 && (!options.potential || scene.mechanism.wrenches.empty());
  if (scene.mechanism.closures.empty()) return problem;
  problem.coordinates = false;
  require(problem.conservative,
          "friction or wrenches on a closed mechanism, allowed: a tree, or neither");
  require(problem.n() > 0, "closures leave nothing free to move");
  return problem;
}

}  // namespace dynwitness::crosscheck::hamilton
