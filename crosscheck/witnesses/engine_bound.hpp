// SPDX-License-Identifier: GPL-3.0-or-later
// How far an outside engine may be from the truth: the error bound of its algorithm, run by us.
#pragma once

#include <memory>

#include "crosscheck/witness.hpp"

namespace dynwitness::crosscheck {

/// How an engine finds qdd: by a sweep of its own, or from M qdd = tau - c - g.
enum class ForwardDynamicsBy { kSweep, kMassMatrix };

/** Bounds for an engine that computes in double, in axes of its own, on the links as they stand in the
    scene. We run our sweep of the same kind with running error bounds, fixed joints kept, on a model
    whose numbers are as uncertain as they are in other axes: turning a vector r (three products and two
    sums an entry) leaves an error of up to 3 u |r| in every entry, where ours may have an exact zero;
    turning a matrix does it twice, 6 u |I|. For the same reason all entries of the answer get the
    largest bound among them: the engine may collect its rounding in world axes. */
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
