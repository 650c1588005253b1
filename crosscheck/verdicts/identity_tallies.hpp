// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict on both sides of the identities, state by state.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "scene/matrix.hpp"

namespace dynwitness::crosscheck {

/// The largest magnitude that any entry may have.
double largestOf(const scene::MatrixX<Ball>& m);
/// Decimal digits of an answer whose entries are so far off, as a share of the largest entry; none:
/// that is 0, or no number.
std::optional<double> digitsLeft(const scene::MatrixX<Ball>& distance,
                                 const scene::MatrixX<Ball>& of);

/// Both sides in balls at a state: their difference must contain 0.
/// @param excuse  why there may be nothing to compare where a ball is not finite; empty: there is
void addBalls(Tally& tally, int state, const TwoSides<Ball>& sides, const std::string& excuse = {});

/// One tally a law.
class IdentityTallies {
 public:
  IdentityTallies(const std::vector<LawWords>& laws, std::uint64_t seed);
  /// @param is_singular  says why M is singular at a state, or nothing: asked where a law has no
  ///   bound
  void add(int state, const std::vector<TwoSides<RunningError>>& sides,
           const std::function<std::string(int)>& is_singular);
  std::vector<CheckResult> results() const;

 private:
  std::vector<Tally> tallies_;
};

}  // namespace dynwitness::crosscheck
