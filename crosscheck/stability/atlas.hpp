// SPDX-License-Identifier: GPL-3.0-or-later
// Turns the dial of a family for every method, counts digits against the certified truth, and finds
// the severity at which each method breaks.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/stability/family.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck::stability {

/// One way to compute, in one arithmetic.
struct Method {
  std::string name;
  const Arithmetic* numbers = &inDouble();
  Road road = Road::kAny;  ///< kAny: not known
  bool is_ours = false;
  /// Compiles a program for every mechanism: asked at every fourth severity only.
  bool is_compiled = false;
  bool is_derived = false;  ///< leaves large families out
  /// The answer, exactly as it is. @throws what the method throws
  std::function<MatrixX<Ball>(const Case&, Quantity)> value;
  /// Whether what the method knows of its own error says that fewer than kFewestDigits digits are
  /// certain. Empty: it knows nothing.
  std::function<bool(const Case&, Quantity)> warns = {};
  /// What it knows is an estimate, told with every answer: whether it warns is asked everywhere.
  /// Otherwise it is a bound, asked where an answer is wrong.
  bool is_estimated = false;
};

/// The mechanism at the least severity.
Case harmlessCase(const Family& family);

/// Those of the kinds that are present, and our sweeps in float after them. Programs of the engine
/// protocol are started anew for every severity.
std::vector<Method> methodsOf(const std::vector<WitnessKind>& kinds);

/// Whoever has as many has no reason to be warned of.
inline constexpr int kPlentyOfDigits = 6;

/// A method at one severity: the worst of the variants.
struct Point {
  double severity = 0;
  double digits = 0;  ///< not-a-number: it stopped
  std::string stop;   ///< why it did: what it threw, how its process ended, "not a number"
  bool warned = false;

  bool isBroken() const { return !(digits >= kFewestDigits); }
  /// It warned, and kPlentyOfDigits are right.
  bool isFalseAlarm() const { return digits >= kPlentyOfDigits && warned; }
  bool isSilent() const { return digits < kFewestDigits && !warned; }
};

/// What became of a method in a family.
struct Course {
  std::string method, numbers;
  bool is_ours = false;
  bool is_step = false;       ///< a Measure, and no answer: it has nothing to tell by
  std::string left_out;       ///< why it was not asked, or did not answer where all is harmless
  std::vector<Point> points;  ///< by severity
  double breaks_at = 0;       ///< smallest severity seen to break it; not-a-number: none
  double predicted = 0;       ///< by theory; not-a-number: theory sees no break in the range
  bool has_theory = false;

  bool breaks() const { return breaks_at == breaks_at; }
  bool isPredicted() const { return predicted == predicted; }
  double ratio() const { return breaks_at / predicted; }  ///< where both are
  /// Within a factor of two, or both do not break.
  bool isAsPredicted() const;
  /// "as predicted", "earlier than predicted", "outlasts the theory", ...
  std::string verdict() const;
  /// How it ended where it broke: "" as numbers with fewer digits, else why it stopped.
  std::string end() const;
  int silent() const;       ///< severities of wrong answers without a word
  int falseAlarms() const;  ///< severities of right answers with a warning
};

struct Turned {
  std::string family;
  std::vector<Course> courses;
};

struct Settings {
  int severities = 25;   ///< of a dial, equal steps of its logarithm
  double patience = 20;  ///< [s] for one method at one severity; then it is killed and has stopped
};

/// What is right of what a family asks. Not of one that has measures.
/// @throws std::runtime_error  nothing can be certified
MatrixX<Ball> truthOf(const Family& family, const Case& given);

/** All methods at all severities of a family, each in a copy of this process; between the last
    severity that it held and the first that it did not, bisection until they are within
    family.narrow.
    @param chosen  of families of trees; whole mechanisms have roads of their own, and of the
    engines
                   only those that are chosen
    @throws std::runtime_error  no truth can be certified */
Turned turn(const Family& family, const std::vector<Method>& chosen, const Settings& settings);

/// Severity from which an error leaves fewer than kFewestDigits; not-a-number: none up to the last.
double firstBroken(const Family& family, const std::function<double(double)>& error);
/// Severity at which a theory expects fewer than kFewestDigits; not-a-number: none up to family.to.
double predictedBreak(const Family& family, const Theory& theory, const Arithmetic& numbers);

/// The theory about a method; nullptr: none.
const Theory* theoryFor(const Family& family, Road road, const std::string& method);

}  // namespace dynwitness::crosscheck::stability
