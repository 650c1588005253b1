// SPDX-License-Identifier: GPL-3.0-or-later
// How far an outside engine may be from the truth: the error bound of its algorithm, run by us.
#pragma once

#include <memory>

#include "crosscheck/witness.hpp"

namespace dynwitness::crosscheck {

/// How an engine takes geared rotors into its accelerations.
enum class RotorsBy {
  kInertia,    ///< d is added to the joint's own inertia
  kMultiplier  ///< tree without rotors, then one multiplier a rotor: a = a_free - M^-1 G' lambda
};

/** Bounds for an engine that computes in double, in axes of its own, on the links as they stand in the
    scene. We run our sweep of the same kind with running error bounds on a model as unfavourable as
    the engine's may be: fixed joints kept, axes turned, multiples of pi/2 rounded. Since the engine
    may have collected its rounding in world axes, where each component of a force reaches every entry,
    all entries get the largest bound. */
class EngineBound {
 public:
  explicit EngineBound(const scene::Mechanism& mechanism, RotorsBy rotors = RotorsBy::kInertia);
  ~EngineBound();

  /// Shaped like the quantity.
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<double>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dynwitness::crosscheck
