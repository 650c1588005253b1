// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/function_values.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace dynwitness::scene {
namespace {

using boost::multiprecision::abs;
using boost::multiprecision::denominator;
using boost::multiprecision::msb;
using boost::multiprecision::numerator;

Integer floorOf(const Rational& x) {
  const Integer n = numerator(x), d = denominator(x), quotient = n / d;
  return n < 0 && quotient * d != n ? Integer(quotient - 1) : quotient;
}

// ------------------------------------------------------------------------------------------- pi

/// floor(2^bits arctan(1/x)), but for a unit a term, by the alternating series.
Integer scaledArctanOfInverse(unsigned x, unsigned bits) {
  Integer power = (Integer(1) << bits) / x, sum = power;
  for (unsigned k = 3; power != 0; k += 2) {
    power /= x * x;
    sum += k % 4 == 3 ? -(power / k) : Integer(power / k);
  }
  return sum;
}

/// An integer within 1 of 2^bits pi, by Machin's formula pi/4 = 4 arctan(1/5) - arctan(1/239).
Integer scaledPi(unsigned bits) {
  const auto compute = [](unsigned b) -> Integer {
    constexpr unsigned kGuard = 32;  // bits that swallow the rounding of the series
    const unsigned wide = b + kGuard;
    return (4 * (4 * scaledArctanOfInverse(5, wide) - scaledArctanOfInverse(239, wide))) >> kGuard;
  };
  // what angles and numbers with pi ask for, over and over
  static const std::pair<unsigned, Integer> usual[] = {{256, compute(256)}, {264, compute(264)}};
  for (const auto& [of, value] : usual)
    if (bits == of) return value;
  return compute(bits);
}

// ------------------------------------------------------------------------- functions in intervals

Bracket sineOrCosine(bool is_sine, const Exact& x, unsigned bits) {
  const FixedSineCosine v = fixedSineCosine(x, bits);
  const Integer& middle = is_sine ? v.sine : v.cosine;
  const Integer unit = Integer(1) << bits;
  return {Rational(middle - v.error, unit), Rational(middle + v.error, unit)};
}

/// floor(2^bits sqrt(low)) and one above that of high.
Bracket squareRoot(const Bracket& x, unsigned bits) {
  const Integer unit = Integer(1) << bits;
  const auto root = [&](const Rational& r) {
    return Integer(boost::multiprecision::sqrt(floorOf(r * unit * unit)));
  };
  return {Rational(root(x.low), unit), Rational(root(x.high) + 1, unit)};
}

/** Bisection of what is between 0 and pi/2 while the sine, in its interval, tells on which side x
    is: the sine increases there.
    @param x  between 0 and 1 */
Bracket arcSine(const Rational& x, unsigned bits) {
  const Integer unit = Integer(1) << bits;
  Integer low = 0, high = 2 * unit;  // asin(x) < pi/2 < 2
  while (high - low > 1) {
    const Integer middle = (low + high) / 2;
    const FixedSineCosine v = fixedSineCosine({Rational(middle, unit), 0}, bits);
    // beyond pi/2, where the cosine is negative, is too far
    if (v.cosine + v.error < 0 || Rational(v.sine - v.error, unit) > x)
      high = middle;
    else if (v.cosine - v.error > 0 && Rational(v.sine + v.error, unit) < x)
      low = middle;
    else
      break;
  }
  return {Rational(low, unit), Rational(high, unit)};
}

/// The decimal of kFunctionDigits digits nearest to everything in an interval above 0; nothing
/// where it is too wide for that.
std::optional<Rational> nearestDecimal(const Bracket& v) {
  if (v.low <= 0) return {};
  // 10^exponent <= low < 10^(exponent + 1)
  int exponent =
      (static_cast<int>(msb(numerator(v.low))) - static_cast<int>(msb(denominator(v.low)))) * 3 /
          10 -
      2;
  const auto power = [](int n) {
    return n < 0 ? Rational(1, powerOfTen(static_cast<unsigned>(-n)))
                 : Rational(powerOfTen(static_cast<unsigned>(n)));
  };
  while (power(exponent + 1) <= v.low) ++exponent;
  while (power(exponent) > v.low) --exponent;
  const Rational unit = power(exponent - kFunctionDigits + 1), half(1, 2);
  const Integer digits = floorOf(v.low / unit + half);
  if (digits != floorOf(v.high / unit + half)) return {};
  return digits * unit;
}

/// sin(k pi/6) where that is rational.
std::optional<Rational> rationalSine(int k) {
  switch (((k % 12) + 12) % 12) {
    case 0:
    case 6:
      return Rational(0);
    case 1:
    case 5:
      return Rational(1, 2);
    case 3:
      return Rational(1);
    case 7:
    case 11:
      return Rational(-1, 2);
    case 9:
      return Rational(-1);
    default:
      return {};
  }
}

std::optional<Exact> exactSineOrCosine(bool is_sine, const Exact& x) {
  const Rational sixths = x.pi_multiple * 6;
  if (x.rational != 0 || denominator(sixths) != 1) return {};
  const int k = static_cast<int>(Integer(numerator(sixths) % 12)) + (is_sine ? 0 : 3);
  const std::optional<Rational> value = rationalSine(k);
  if (!value) return {};
  return Exact{*value, 0};
}

std::optional<Exact> exactArcSine(const Rational& x) {
  for (const int k : {0, 1, 3})
    for (const int sign : {1, -1})
      if (x == sign * *rationalSine(k)) return Exact{0, Rational(sign * k, 6)};
  return {};
}

std::optional<Exact> exactRoot(const Exact& x) {
  if (!x.isRational()) return {};
  const Rational root(boost::multiprecision::sqrt(Integer(numerator(x.rational))),
                      boost::multiprecision::sqrt(Integer(denominator(x.rational))));
  if (root * root != x.rational) return {};
  return Exact{root, 0};
}

// ---------------------------------------------------------------------------------------- errors

/// |what is written - value| <= error
struct Uncertain {
  Rational value, error;
};

class ErrorOfFunctions {
 public:
  ErrorOfFunctions(const ParameterValues& values, const ParameterErrors& errors)
      : values_(values), errors_(errors) {}

  Uncertain operator()(const Expression& e) const {
    using Kind = Expression::Kind;
    switch (e.kind()) {
      case Kind::kNumber:
        return {e.number(), isRoundedFunction(e)
                                ? Rational(abs(e.number()) / (2 * powerOfTen(kFunctionDigits - 1)))
                                : Rational(0)};
      case Kind::kPi:
        return {Exact{0, 1}.approximation(), 0};
      case Kind::kParameter: {
        const auto error = errors_.find(e.parameter());
        return {values_.at(e.parameter()).approximation(),
                error == errors_.end() ? Rational(0) : error->second};
      }
      case Kind::kNegate: {
        const Uncertain a = (*this)(e.left());
        return {-a.value, a.error};
      }
      case Kind::kAdd:
      case Kind::kSubtract: {
        const Uncertain a = (*this)(e.left()), b = (*this)(e.right());
        const int sign = e.kind() == Kind::kAdd ? 1 : -1;
        return {a.value + sign * b.value, a.error + b.error};
      }
      case Kind::kMultiply:
        return product((*this)(e.left()), (*this)(e.right()));
      case Kind::kDivide:
        return quotient((*this)(e.left()), (*this)(e.right()));
      case Kind::kPower: {
        const Uncertain base = (*this)(e.left());
        Uncertain power{1, 0};
        for (int k = 0; k < std::abs(e.exponent()); ++k) power = product(power, base);
        return e.exponent() < 0 ? quotient({1, 0}, power) : power;
      }
      case Kind::kTime:
      case Kind::kCall:
        break;
    }
    throw std::logic_error("errorOfFunctions: not an expression in the parameters alone");
  }

 private:
  static Uncertain product(const Uncertain& a, const Uncertain& b) {
    return {a.value * b.value, abs(a.value) * b.error + abs(b.value) * a.error + a.error * b.error};
  }
  /// Where b may be 0 everything is possible, which is more than any value allows.
  static Uncertain quotient(const Uncertain& a, const Uncertain& b) {
    const Rational room = abs(b.value) - b.error, value = a.value / b.value;
    return {value, room > 0 ? Rational((a.error + abs(value) * b.error) / room)
                            : Rational(abs(value) + 1)};
  }

  const ParameterValues& values_;
  const ParameterErrors& errors_;
};

}  // namespace

Integer powerOfTen(unsigned n) {
  return boost::multiprecision::pow(Integer(10), n);
}

Bracket bracket(const Exact& x, unsigned bits) {
  if (x.pi_multiple.is_zero()) return {x.rational, x.rational};
  // over one denominator: lowest terms are looked for once
  const Integer middle = scaledPi(bits), scale = Integer(1) << bits;
  const Integer n = numerator(x.rational), d = denominator(x.rational);
  const Integer pi_n = numerator(x.pi_multiple), pi_d = denominator(x.pi_multiple);
  const Integer whole = n * pi_d * scale, part = pi_n * d, bottom = d * pi_d * scale;
  const Rational a(Integer(whole + part * (middle - 1)), bottom);
  const Rational b(Integer(whole + part * (middle + 1)), bottom);
  return pi_n.sign() < 0 ? Bracket{b, a} : Bracket{a, b};
}

FixedSineCosine fixedSineCosine(const Exact& angle, unsigned bits) {
  // angle = k pi/2 + rest, |rest| < 1; a huge angle takes several rounds of 60 digits each
  static const Rational half_pi = Exact{0, Rational(1, 2)}.approximation();
  Integer k = 0;
  Exact rest = angle;
  for (Integer more = 1; more != 0; k += more) {
    more = floorOf(rest.approximation() / half_pi + Rational(1, 2));
    rest.pi_multiple -= Rational(more, 2);
  }
  const Integer one = Integer(1) << bits;
  FixedSineCosine out{0, one, 0};
  if (!rest.isZero()) {
    // a unit that pi in it is off by, and one that is cut off
    const Integer turns = abs(numerator(rest.pi_multiple)) / denominator(rest.pi_multiple) + 1;
    const Bracket b = bracket(rest, bits + 8 + msb(turns));
    const Integer x = floorOf(b.low * one);
    const Integer error_of_x = floorOf(b.high * one) - x + 1;
    // terms x^n / n!: each is off by at most what the one before is, times |x| / n, and by the two
    // units that are cut off, together below 4; those that are left out add up to less than 10
    Integer cosine = 0, term = one;
    unsigned n = 0;
    for (; term != 0; ++n) {
      (n % 2 == 0 ? cosine : out.sine) += n % 4 < 2 ? term : Integer(-term);
      term = term * x / one / (n + 1);
    }
    out.cosine = cosine;
    out.error = error_of_x + 4 * n + 10;
  }
  switch (static_cast<int>(Integer(((k % 4) + 4) % 4))) {
    case 0:
      break;
    case 1:
      std::tie(out.sine, out.cosine) = std::make_tuple(out.cosine, Integer(-out.sine));
      break;
    case 2:
      std::tie(out.sine, out.cosine) = std::make_tuple(Integer(-out.sine), Integer(-out.cosine));
      break;
    default:
      std::tie(out.sine, out.cosine) = std::make_tuple(Integer(-out.cosine), out.sine);
      break;
  }
  return out;
}

FunctionValue functionValue(std::string_view function, const Exact& x) {
  const bool is_sine = function == "sin", is_root = function == "sqrt", is_arc = function == "asin";
  std::optional<Exact> exact;
  if (is_root) {
    if (x.approximation() < 0) throw std::domain_error("the square root of a negative number");
    exact = exactRoot(x);
  } else if (is_arc) {
    if (abs(x.approximation()) > 1)
      throw std::domain_error("the arcsine of a number beyond -1 to 1");
    if (!x.isRational()) throw std::domain_error("the arcsine of a number with pi in it");
    exact = exactArcSine(x.rational);
  } else {
    exact = exactSineOrCosine(is_sine, x);
  }
  if (exact) return {*exact, false};
  for (unsigned bits = 256;; bits *= 2) {
    Bracket v = is_root  ? squareRoot(bracket(x, 2 * bits), bits)
                : is_arc ? arcSine(abs(x.rational), bits)
                         : sineOrCosine(is_sine, x, bits);
    const bool is_negative = is_arc ? x.rational < 0 : v.high < 0;
    if (!is_arc && is_negative) v = {-v.high, -v.low};
    // none of these values is halfway between two decimals, since none is rational: it ends
    if (const std::optional<Rational> decimal = nearestDecimal(v))
      return {{is_negative ? Rational(-*decimal) : *decimal, 0}, true};
  }
}

Rational errorOfFunctions(const Expression& expression, const ParameterValues& values,
                          const ParameterErrors& errors, const SourceLocation& where) {
  const auto namesRounded = [&] {
    const std::set<std::string> names = expression.parameters();
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return errors.count(name) > 0; });
  };
  if (!hasRoundedFunction(expression) && (errors.empty() || !namesRounded())) return 0;
  const Uncertain x = ErrorOfFunctions(values, errors)(expression);
  static const Rational kMost(1, powerOfTen(50));
  if (x.error > kMost * abs(x.value))
    throw InputError(where, "\"" + expression.text() + "\": functions are rounded to " +
                                std::to_string(kFunctionDigits) +
                                " digits, and these cancel here, allowed: what leaves 50 of them "
                                "(a number that is meant to be 0 is written 0)");
  return x.error;
}

}  // namespace dynwitness::scene
