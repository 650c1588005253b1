// SPDX-License-Identifier: GPL-3.0-or-later
// The three witnesses that are sweeps of recursive/: each answers in double, with the running error
// bound of the same sweep.
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/sweep_witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

template <typename Algorithm, typename MakeExact>
WitnessKind sweepKind(const MakeExact& make_exact) {
  return {{Algorithm::kName, DYNWITNESS_VERSION, Algorithm::kMethod},
          [](const PreparedScene& scene) { return makeWitness<SweepWitness<Algorithm>>(scene); },
          make_exact};
}

}  // namespace

WitnessKind newtonEulerKind() {
  return sweepKind<NewtonEuler>(exactNewtonEuler);
}
WitnessKind compositeBodyKind() {
  return sweepKind<CompositeBody>(exactCompositeBody);
}
WitnessKind articulatedBodyKind() {
  return sweepKind<ArticulatedBody>(exactArticulatedBody);
}

}  // namespace dynwitness::crosscheck
