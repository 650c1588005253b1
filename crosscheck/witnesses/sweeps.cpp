// SPDX-License-Identifier: GPL-3.0-or-later
// The three witnesses that are sweeps of recursive/: each answers in double, with the running error
// bound of the same sweep.
#include "crosscheck/witnesses/sweep_witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

template <typename Algorithm>
WitnessKind sweepKind() {
  return {{Algorithm::kName, DYNWITNESS_VERSION, Algorithm::kMethod},
          [](const scene::Scene& scene) -> std::unique_ptr<Witness> {
            return std::make_unique<SweepWitness<Algorithm>>(scene);
          }};
}

}  // namespace

WitnessKind newtonEulerKind() {
  return sweepKind<NewtonEuler>();
}
WitnessKind compositeBodyKind() {
  return sweepKind<CompositeBody>();
}
WitnessKind articulatedBodyKind() {
  return sweepKind<ArticulatedBody>();
}

}  // namespace dynwitness::crosscheck
