// SPDX-License-Identifier: GPL-3.0-or-later
// A number of a file with 50 digits, and how far it may be from what is written.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace dynwitness::crosscheck::rereading {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_50::backend_type,
                                           boost::multiprecision::et_off>;

/// What one operation (of Real, sines and pi among them) loses at most, relatively; the rest of the
/// factor is room for bounds being added in double.
inline const double kLoss = 8 * static_cast<double>(std::numeric_limits<Real>::epsilon());

/// |value - what is written| <= error, first order (second orders are below 1e-100).
struct Value {
  Real value = 0;
  double error = 0;

  Value() = default;
  Value(int whole) : value(whole) {}  // NOLINT(google-explicit-constructor): exact
  Value(Real x, double e) : value(std::move(x)), error(e) {}
  /// A double, which is exact.
  static Value of(double x) { return {Real(x), 0}; }

  double size() const { return static_cast<double>(abs(value)); }

  friend Value operator+(const Value& a, const Value& b);
  friend Value operator-(const Value& a, const Value& b);
  friend Value operator*(const Value& a, const Value& b);
  /// @throws std::runtime_error  b may be 0
  friend Value operator/(const Value& a, const Value& b);
  Value operator-() const { return {-value, error}; }
};

using Vector = std::array<Value, 3>;
using Parameters = std::map<std::string, Value, std::less<>>;

/// A decimal with an optional sign ("-1.5e-3"). @throws std::runtime_error  it is none
Value decimal(std::string_view text);

/** An arithmetic expression in decimals, named parameters, pi, and sin, cos, asin and sqrt of such
    expressions, by operator precedence on two stacks (Dijkstra's shunting yard), from the weakest:

        + -    * /    sign    ^ (by a whole number)        each from left to right

    so that -a^2 = -(a^2), a - b + c = (a - b) + c, a / b * c = (a / b) * c.
    @throws std::runtime_error  what could not be understood */
Value evaluated(std::string_view text, const Parameters& parameters);

}  // namespace dynwitness::crosscheck::rereading
