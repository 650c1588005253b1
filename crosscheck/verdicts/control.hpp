// SPDX-License-Identifier: GPL-3.0-or-later
// The run's own control: a small known fault that the judge must find, or the run proves nothing.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/testimony.hpp"

namespace dynwitness::crosscheck {

inline constexpr int kUsualPower = 10;  ///< size 1e-10, where nothing asks for more

/// What a control gets wrong: a heavier kilogram, in every number that has one in it (masses,
/// inertias, springs, friction, loads; lengths, angles and gravity stay); or masses and inertias
/// with their weights as they were, which is what shows in qdd: a kilogram that cancels there is
/// seen by its joint forces only.
enum class TooHeavy { kKilogram, kInertia };

/// The scene with that too large by 10^-power of it.
scene::Scene heavier(const scene::Scene& scene, int power, TooHeavy what = TooHeavy::kKilogram);

/** A witness that reads heavier(scene): Newton-Euler, and articulated bodies for qdd, in double
    with its own error bounds. It is honest at the first of its three states, so that whoever judges
    the first one only does not find it, and asked at these alone.

    How heavy: 1e-10 is 4.5e5 ulp in every entry of a quantity that has the dimension of a mass. A
    limit may be 10^4 times the error that is seen, and no more (then it is no longer one). So the
    control must be found wherever it is 10^4 times what the honest sweep in double is off by from
    the certified truth (in joint forces for qdd, which is judged by them); where 1e-10 is less than
    that, it is the next power of ten that is not. Limits have no part in its size: one that is too
    wide makes it missed, not larger. */
class ControlWitness {
 public:
  ControlWitness(const PreparedScene& scene, const Options& options);
  ~ControlWitness();

  /// Appends its testimony to the others', where it has one at this state.
  bool joins(Quantity quantity, int index, const scene::State<double>& state,
             const Certified& exact, std::vector<Testimony>& said);
  /// What the pairs with it said, a quantity at a time.
  void judgedInPairs(const std::vector<CheckResult>& checks);
  /// Takes what belongs to the control out of what was found.
  void takeFrom(DigitsFound& found);
  std::vector<Control> results() const;  ///< by "pairs" and "truth"

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/** The control before a table, heavy enough to be three units of the last printed digit in some
    entry (or three times the accuracy that the table states): by "table". */
std::vector<Control> controlOfTable(const std::filesystem::path& table, const PreparedScene& scene);

/// Controls of the same quantity become one; those of tables stay apart, being larger.
std::vector<Control> joinedControls(const std::vector<std::vector<Control>>& parts);

}  // namespace dynwitness::crosscheck
