// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/plan.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace {

/// How many links a state costs the square of: fixed ones pass their reactions on, too.
int sizeOf(const scene::Mechanism& mechanism) {
  return std::max(mechanism.dof(), static_cast<int>(mechanism.links.size()) - 1);
}

}  // namespace

Plan planFor(const scene::Scene& scene, const Options& options) {
  constexpr int kAllStates = 64, kWhole = 128, kMost = 1000, kFewestStates = 2;
  const int n = scene.mechanism.dof();
  if (n > kMost)
    throw scene::InputError(
        {scene.file.string()},
        fmt::format("has {} degrees of freedom, allowed in a crosscheck: {}", n, kMost));
  Plan plan{options.states, n <= kWhole, {}};
  const int usual = Options().states, size = sizeOf(scene.mechanism);
  if (size > kAllStates && options.states == usual) {
    const double share = static_cast<double>(kAllStates) / size;
    plan.states = std::max(kFewestStates, static_cast<int>(usual * share * share));
    plan.told.push_back(fmt::format(
        "{} of the usual {} states: each costs n^2 operations, and n = {} {}; any other "
        "number that --random names is kept",
        plan.states, usual, size, size > n ? "links" : "joints"));
  }
  if (!plan.whole)
    plan.told.push_back(fmt::format(
        "laws of mechanics, exact checks, derived equations and simulated energy are left "
        "out: they cost n^3 operations and more, and n = {}, allowed: {}",
        n, kWhole));
  return plan;
}

double expectedSeconds(const scene::Scene& scene, const Plan& plan) {
  const double n = scene.mechanism.dof(), links = sizeOf(scene.mechanism);
  const double states = (9e-4 * n * n + 1.2e-5 * links * links) * plan.states;
  return 0.5 + states + (plan.whole ? 0.1 * n + 2e-4 * n * n * n : 0.0);
}

}  // namespace dynwitness::crosscheck
