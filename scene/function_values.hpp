// SPDX-License-Identifier: GPL-3.0-or-later
// Sines, cosines, arcsines and square roots of exact numbers: exact where they can be, otherwise
// the nearest decimal of 60 digits, by enclosures in integers that grow until it is certain.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "scene/expression.hpp"

namespace dynwitness::scene {

Integer powerOfTen(unsigned n);

/// An interval with rational ends.
struct Bracket {
  Rational low, high;
};

/// A rational interval around a number with pi in it, narrower as `bits` grows.
Bracket bracket(const Exact& x, unsigned bits);

/// cos x and sin x in units of 2^-bits: |2^bits sin x - sine| <= error, and so for the cosine.
struct FixedSineCosine {
  Integer sine, cosine, error;
};

/** By Taylor's series of what is left of the angle beside quarter turns k pi/2; of these alone it
    is exact.
    @param bits  256 is quick: pi is kept for it */
FixedSineCosine fixedSineCosine(const Exact& angle, unsigned bits);

/// How many significant digits of a function's value that is no rational number (nor a rational
/// multiple of pi) are kept: it is off by at most 0.5e-59 of itself.
inline constexpr int kFunctionDigits = 60;

struct FunctionValue {
  Exact value;
  bool is_rounded;  ///< it is the decimal of kFunctionDigits digits nearest to the true value
};

/// The functions that numbers may have in them.
inline constexpr const char* kFunctionsOfNumbers[] = {"sin", "cos", "asin", "sqrt"};

/** sin, cos, asin or sqrt of an exact number.

    Exact are, by Niven's theorem, sines and cosines of the multiples of pi that give 0, +-1/2 and
    +-1 (and no others), the arcsines of these, and roots of squares. Every other value is the
    decimal with 60 significant digits that is nearest to it, which is a rational number that
    everybody computes with.
    @throws std::domain_error  sqrt of what is negative, asin beyond +-1 */
FunctionValue functionValue(std::string_view function, const Exact& x);

/// Whether a number is such a decimal.
bool isRoundedFunction(const Expression& number);
/// Whether an expression has one in it (one in a parameter that it names is not seen).
bool hasRoundedFunction(const Expression& expression);

/// By how much each parameter that is not mentioned elsewhere may differ from what is written.
using ParameterErrors = std::map<std::string, Rational>;

/** How far an expression's value may be from what it says, since functions in it are rounded: of
    each decimal half a unit of its last digit, carried through sums, products and quotients; 0: it
    is exact.
    @param errors  of parameters that are not exact
    @throws InputError (at `where`)  more than 1e-50 of the value: it cancels, and what is left is
      rounding */
Rational errorOfFunctions(const Expression& expression, const ParameterValues& values,
                          const ParameterErrors& errors, const SourceLocation& where);

}  // namespace dynwitness::scene
