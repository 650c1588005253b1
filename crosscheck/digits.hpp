// SPDX-License-Identifier: GPL-3.0-or-later
// How many digits survive: every witness against the certified truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/crosscheck.hpp"
#include "crosscheck/truth.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** What is left of one quantity by one witness, over the states of a crosscheck.

    Digits are counted against the quantity as a whole,
        digits = -log10( max_i |x_i - truth_i| / max_i |truth_i| ),
    because an entry that should be 0 has no digits of its own. Distance to the truth means to the
    farthest point of its enclosure, so no digit is counted that is not there. Digits that a scalar has
    no room for are not counted either: 9 in float, 17 in double, 21 in long double (max_digits10). */
struct DigitsResult {
  std::string scene, witness, quantity;
  std::string scalar;        ///< "double"; our sweeps in "float" and "long double" too
  int states = 0;            ///< that have digits: the truth is certified and not 0
  double worst = 0;          ///< digits, over those states
  double median = 0;
  double worst_single = 0;   ///< digits of a single entry against itself, over entries known as not 0
  int worst_state = 0;       ///< where `worst` is
  std::string worst_entry;   ///< the entry farthest from the truth there
  /// Largest distance to the truth / the witness's own error bound. Empty for float and long double,
  /// where no bound is computed.
  std::optional<double> bound_ratio;
  /// Where there are bounds: agree when every entry at every state is proven to lie within its bound,
  /// disagree when one is proven not to.
  std::optional<Verdict> verdict;
  std::string reason;        ///< of a disagreement: which joint, which state; or why there is no verdict
};

/** Every quantity that the witnesses answer, at the options' states: all witnesses in double, judged by
    the bounds of their answers; then the sweeps in float and long double. A float run gets the state
    rounded to float: that rounding is part of what float does, and is counted. */
std::vector<DigitsResult> measureDigits(const scene::Scene& scene,
                                        const std::vector<WitnessKind>& kinds,
                                        const Options& options);

/// The same, but for one way of computing: collects answers state by state.
class DigitsTally {
 public:
  /// @param description  scene, witness, quantity, scalar
  /// @param max_digits   what the scalar has room for
  DigitsTally(DigitsResult description, const scene::Mechanism& mechanism, int max_digits);

  /// An answer, exactly as it is, against the truth; `bound` as in Answer, or none.
  void add(int state, const MatrixOf<Ball>& answer, const Certified& truth,
           const Eigen::MatrixXd* bound);
  /// The witness could not answer at this state.
  void fail(int state, const std::string& reason);

  DigitsResult result() const;

 private:
  double digits(double error, double size) const;
  std::string joints(Eigen::Index row, Eigen::Index column, Eigen::Index size) const;
  void judge(int state, const std::string& where, double at_least, double at_most, double bound);

  DigitsResult result_;
  std::vector<std::string> joint_names_;
  double max_digits_;
  std::vector<double> by_state_;
  std::string disagreement_, undecided_;
};

}  // namespace dynwitness::crosscheck
