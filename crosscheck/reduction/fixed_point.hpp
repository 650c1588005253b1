// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse dynamics in whole numbers: how many bits each signal needs for an error of joint forces.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "crosscheck/reduction/envelope.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {

/// One number of the kernel: integer x 2^-fraction, in two's complement.
struct FixedSignal {
  enum class Kind { kInput, kConstant, kResult };
  Kind kind = Kind::kResult;
  std::string name;          ///< "cos q2", "qd3", "qdd1", "0.4318", "t57", "tau_2"
  double value = 0;          ///< of a constant: the double nearest to it
  double low = 0, high = 0;  ///< proven: within these everywhere in the envelope; SI units
  int integer = 0;           ///< bits before the point, without the sign; negative: zeros behind it
  int fraction = 0;          ///< bits behind it
  double error = 0;          ///< proven: at most so far from the exact number
  bool is_used = false;      ///< the code has it; a program may leave slots out

  int word() const;  ///< all bits, the sign's among them; 1 at least
};

/// A joint's force.
struct FixedForce {
  double certified = 0;  ///< proven: at most so far from the exact one everywhere in the envelope
  double measured = 0;   ///< the most at the states that were run
  EnvelopeState worst;
};

struct FixedPoint {
  double error = 0;  ///< asked for [N m, N]
  symbolic::Program program;
  std::vector<FixedSignal> signals;  ///< by slot of the program
  std::vector<FixedForce> forces;
  int boxes = 0;   ///< in q, over which ranges and errors were proven
  int states = 0;  ///< that the compiled code was run at
  int shifts = 0;
  std::string code;  ///< C99

  int widestWord() const;     ///< of all signals
  int widestProduct() const;  ///< of all that a multiplication or addition holds in between
  bool isKept() const;        ///< no state was seen above what is certified
};

/** tau of q, qd, qdd by the smallest program of the scene (kernel/roads.hpp) in whole numbers: each
    signal has a word length of its own, every product and sum is rounded to it by an addition and
    a shift.

    Ranges: the program in ball arithmetic over boxes that divide the envelope in q. Errors: with a
    bound e of what each signal is off, a sum's is e_a + e_b, a product's
    |a| e_b + |b| e_a + e_a e_b, and half a unit of the last place where bits are dropped; inputs
    are the nearest to the exact numbers. Over each box with its own |a|, |b|; the largest of all
    boxes is what is certified. Fraction bits: as many that each rounding may make the same share of
    the error, by its derivative at sampled states; then less of the error until what is certified
    is within it. Samples choose bits; what is promised is proven by the balls alone.

    The code is compiled and run at random q, at random and extreme qd and qdd of the envelope,
    beside the sweep of
    recursive/ in double.
    @param error  of each tau_i [N m, N]
    @throws scene::InputError  as envelopeBounds() and reduced(); the program divides; a product or
      sum of more than 63 bits; no C compiler */
FixedPoint fixedPoint(const scene::Scene& scene, const std::vector<scene::JointRanges>& ranges,
                      double error, const std::function<void(const std::string&)>& stage);

/// The code of the signals that are there.
std::string fixedPointC(const scene::Scene& scene, const FixedPoint& fixed);
/// Compiles and runs it: forces' `measured` and `worst`, and `states`.
void runFixedPoint(const scene::Scene& scene, const std::vector<scene::JointRanges>& ranges,
                   FixedPoint* fixed);

/// For people; programs (crosscheck/reduction/fixed_point.schema.json).
std::string fixedPointText(const scene::Scene& scene, const FixedPoint& fixed);
std::string fixedPointJson(const scene::Scene& scene, const FixedPoint& fixed,
                           const std::string& version);

}  // namespace dynwitness::crosscheck
