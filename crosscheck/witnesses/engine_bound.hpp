// SPDX-License-Identifier: GPL-3.0-or-later
// How far an outside engine may be from the truth: the error bound of its algorithm, run by us.
#pragma once

#include <memory>

#include "crosscheck/arithmetic/running_error.hpp"
#include "crosscheck/witness.hpp"

namespace dynwitness::crosscheck {

/// How an engine finds qdd: by a sweep of its own, or from M qdd = tau - c - g.
enum class ForwardDynamicsBy { kSweep, kMassMatrix };

/** Bounds for an engine that computes in double, in axes of its own, on the links as they stand in the
    scene. We run our sweep of the same kind with running error bounds, fixed joints kept, on a model
    whose numbers are as uncertain as they are in other axes. Turning a vector r (three products and two
    sums an entry) leaves an error of up to 3 u |r| in every entry, where ours may have an exact zero. An
    engine turns three times to pass a joint (its inboard frame, its motion, its outboard frame), which
    is 9 u for an orientation; a joint's offset is turned on both sides of the joint, 6 u |p|; a centre
    of mass once, 3 u |h|; an inertia once from each side, 6 u |I|; gravity and loads once, the moment of a load's
    force twice. For the same reason all entries of
    the answer get the largest bound among them: the engine may collect its rounding in world axes.

    A quaternion is made one of length 1 first (4 u in each component), and R of it has entries of two
    products of components each: 20 u more for that orientation. Rates of spherical and floating joints
    are turned into the engine's axes, and its answers back, by an R of that kind: 23 u |x| more on
    either side, and what is turned can be 2 times as uncertain.

    Reactions are turned as a whole from world axes to those of the joint, by an orientation that is as
    uncertain as all joints on the way make it: (9 depth + 3) u |x| more, and what is turned can be 2
    times as uncertain.

    Measured at 2 000 states of each of the 23 bundled scenes, seed 7: Simbody uses at most 90 % of the
    sum of its bound and ours. */
class EngineBound {
 public:
  explicit EngineBound(const scene::Mechanism& mechanism,
                       ForwardDynamicsBy method = ForwardDynamicsBy::kSweep);
  ~EngineBound();

  /// Shaped like the quantity. The state is exact, or carries bounds of its own.
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<double>& state);
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<RunningError>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dynwitness::crosscheck
