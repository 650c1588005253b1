// SPDX-License-Identifier: GPL-3.0-or-later
// States drawn from an envelope.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "crosscheck/reduction/envelope.hpp"

namespace dynwitness::crosscheck {

/** One state after another, from a seed: q anywhere in its ranges; rates, and what is given with
    them, in every second state, the first among them, at an end of theirs, otherwise anywhere. */
class EnvelopeSampler {
 public:
  enum class Given { kQdd, kTau };

  /// @param ranges  kept by reference; those of tau are there where it is given
  EnvelopeSampler(const std::vector<scene::JointRanges>& ranges, std::uint64_t seed,
                  Given given = Given::kQdd)
      : ranges_(ranges), random_(seed), given_(given) {}

  EnvelopeState next() {
    EnvelopeState state;
    for (const scene::JointRanges& r : ranges_) {
      state.q.push_back(drawn(r.q, false));
      state.qd.push_back(drawn(r.qd, at_end_));
      if (given_ == Given::kQdd)
        state.qdd.push_back(drawn(r.qdd, at_end_));
      else
        state.tau.push_back(drawn(*r.tau, at_end_));
    }
    at_end_ = !at_end_;
    return state;
  }

 private:
  double drawn(const scene::Range& range, bool at_end) {
    const double share = share_(random_);
    return range.low + (at_end ? std::round(share) : share) * (range.high - range.low);
  }

  const std::vector<scene::JointRanges>& ranges_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> share_{0, 1};
  Given given_;
  bool at_end_ = true;
};

}  // namespace dynwitness::crosscheck
