// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of fewer and fewer inertial parameters, in the order in which samples miss them least.
#pragma once

#include <vector>

#include "crosscheck/reduction/reduce.hpp"

namespace dynwitness::crosscheck {

/// A scene on the way from all parameters to few.
struct ReducedBase {
  scene::Scene scene;
  std::vector<DroppedParameter> dropped;
  double sampled = 0;  ///< the largest error at samples, as a share
};

/// States of the envelope at which scenes are compared: they decide an order and promise nothing.
class ReductionSamples {
 public:
  /// @param ranges  each with tau, of kQdd
  ReductionSamples(const scene::Mechanism& mechanism, const std::vector<scene::JointRanges>& ranges,
                   ReducedQuantity of);

  /// By joint: how far another mechanism's answer is off, and at which state most.
  struct Worst {
    double error = 0;
    EnvelopeState state;
  };
  /// No answer (M is singular) is infinitely far off.
  std::vector<Worst> worst(const scene::Mechanism& mechanism) const;
  /// The largest of worst(), each as a share of `largest`.
  double error(const scene::Mechanism& mechanism, const std::vector<double>& largest) const;

 private:
  std::vector<std::vector<double>> of(const scene::Mechanism& mechanism) const;

  ReducedQuantity of_;
  std::vector<EnvelopeState> states_;
  std::vector<std::vector<double>> answers_;
};

/// Parameters go one after the other, the one first that is missed least, until samples err by more
/// than the share `until`; the scene as it is first.
std::vector<ReducedBase> parameterSequence(const scene::Scene& scene,
                                           const ReductionSamples& samples,
                                           const std::vector<double>& largest, double until);

}  // namespace dynwitness::crosscheck
