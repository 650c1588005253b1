// SPDX-License-Identifier: GPL-3.0-or-later
// How many digits survive: every witness against the certified truth.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/verdicts/testimony.hpp"
#include "crosscheck/verdicts/truth.hpp"

namespace dynwitness::crosscheck {

/// Digits, and what they are judged by.
struct DigitsFound {
  std::vector<DigitsResult> digits;
  /// "truth", one a witness: its answers lie within their bounds of the certified truth. It
  /// disagrees when an entry at some state is proven to lie outside (the truth's own width, below
  /// 2^-80 of it, does not count), and says which joint and state.
  std::vector<CheckResult> checks;
  /// Who lies beyond rounding, within a documented loss: one a witness, its worst quantity.
  std::vector<Finding> losses;
};

/** All witnesses in double, judged by the bounds of their answers; then the sweeps in float and
    long double, which are not judged. A float run gets the state rounded to float: that rounding is
    part of what float does, and is counted. */
class DigitsCount {
 public:
  DigitsCount(const PreparedScene& scene, const Options& options);
  ~DigitsCount();
  /// The truth at that state, whatever is said.
  Certified truth(Quantity quantity, const scene::State<double>& state);
  void add(Quantity quantity, int index, const scene::State<double>& state,
           const std::vector<Testimony>& said, const Certified& exact);
  DigitsFound found() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Every quantity that the witnesses answer, at the options' states.
DigitsFound measureDigits(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                          const Options& options);

}  // namespace dynwitness::crosscheck
