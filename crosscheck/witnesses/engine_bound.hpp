// SPDX-License-Identifier: GPL-3.0-or-later
// How far an outside engine may be from the truth: the error bound of its algorithm, run by us.
#pragma once

#include <memory>

#include "crosscheck/witness.hpp"

namespace dynwitness::crosscheck {

/// How an engine finds qdd: by a sweep of its own, or from M qdd = tau - c - g.
enum class ForwardDynamicsBy { kSweep, kMassMatrix };

/** Bounds for an engine that computes in double, in axes of its own, on the links as they stand in the
    scene. We run our sweep of the same kind with running error bounds on a model as unfavourable as
    the engine's may be: fixed joints kept, axes turned, multiples of pi/2 rounded. Since the engine
    may have collected its rounding in world axes, where each component of a force reaches every entry,
    all entries get the largest bound. */
class EngineBound {
 public:
  explicit EngineBound(const scene::Mechanism& mechanism,
                       ForwardDynamicsBy method = ForwardDynamicsBy::kSweep);
  ~EngineBound();

  /// Shaped like the quantity.
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<double>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dynwitness::crosscheck
