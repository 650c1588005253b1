// SPDX-License-Identifier: GPL-3.0-or-later
// The identities where rounding bounds in double say nothing.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** Both sides of each law of identities.hpp as balls, at a state of doubles taken as the numbers
    that they are. The precision is doubled until every difference is known to 2^-20 of an ulp of
    the larger side, or until 2048 bits. */
class IdentitiesInBalls {
 public:
  explicit IdentitiesInBalls(const scene::Mechanism& mechanism);
  ~IdentitiesInBalls();

  std::vector<TwoSides<Ball>> operator()(const scene::State<double>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// M = L D L' has positive pivots at this state, proven in balls of up to 2048 bits.
class PositivePivots {
 public:
  explicit PositivePivots(const scene::Mechanism& mechanism);
  ~PositivePivots();

  /// The largest radius / pivot; infinite where a pivot is negative or cannot be told from zero.
  double operator()(const scene::State<double>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dynwitness::crosscheck
