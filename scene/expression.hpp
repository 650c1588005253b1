// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of a scene, exactly as their author wrote them.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include <boost/multiprecision/cpp_int.hpp>

#include "scene/error.hpp"

namespace dynwitness::scene {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

/** An exact real number of the form rational + pi_multiple * pi.

    Every number that a scene can spell has this form: sums, and products or quotients with a
    rational number, stay inside it, and pi * pi or 1 / pi are refused. So a length is the rational
    that was printed, and an angle of "pi/2" is a right angle and not the double beside it. */
struct Exact {
  Rational rational = 0;
  Rational pi_multiple = 0;

  bool isRational() const { return pi_multiple == 0; }
  bool isZero() const { return rational == 0 && pi_multiple == 0; }
  /// The nearest double (correctly rounded: formed with 60 digits of pi and rounded once).
  double toDouble() const;
  /// A rational within 1e-60 (relative) of the number: for comparisons such as "is it negative".
  Rational approximation() const;
  friend bool operator==(const Exact& a, const Exact& b) {
    return a.rational == b.rational && a.pi_multiple == b.pi_multiple;
  }
};

/** An arithmetic expression in numbers, named parameters and pi, as an immutable tree.

    Grammar:  sum     = product { ("+" | "-") product }
              product = unary { ("*" | "/") unary }
              unary   = ["-" | "+"] power
              power   = atom ["^" integer]            (so -x^2 is -(x^2))
              atom    = decimal | name | "pi" | "(" sum ")"
    Decimals ("0.4318", ".5", "1e-3") are exact rationals: 0.4318 is 4318/10000.

    A function of time has two atoms more: the time "t", and sin, cos, asin, sqrt and exp of a sum
    in parentheses (scene/motion.hpp). No such expression has an exact value. */
class Expression {
 public:
  enum class Kind {
    kNumber,
    kParameter,
    kPi,
    kNegate,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kPower,
    kTime,
    kCall
  };

  Expression();                ///< the number 0
  Expression(Rational value);  // NOLINT(google-explicit-constructor): numbers are expressions
  Expression(int value) : Expression(Rational(value)) {}  // NOLINT(google-explicit-constructor)

  /// Reads an expression. @throws InputError naming `where`, the text read and what is allowed.
  static Expression parse(std::string_view text, const SourceLocation& where = {});
  /// The same for a function of time.
  static Expression parseOfTime(std::string_view text, const SourceLocation& where = {});

  Kind kind() const;
  const Rational& number() const;        ///< kNumber: its value
  const std::string& parameter() const;  ///< kParameter: its name
  const std::string& function() const;   ///< kCall: its name; left() is the argument
  const Expression& left() const;        ///< first operand (the only one of kNegate, kPower, kCall)
  const Expression& right() const;       ///< second operand of a binary operation
  int exponent() const;                  ///< kPower: the exponent, may be negative

  /// True for the literal number 0 (not for an expression that happens to evaluate to 0).
  bool isLiteralZero() const;
  std::set<std::string> parameters() const;  ///< names that occur in the expression
  /// The expression in the grammar above; parse(text()) gives the same tree. A number keeps the
  /// decimal spelling that it was read in.
  std::string text() const;

  struct Node;

 private:
  explicit Expression(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  std::shared_ptr<const Node> node_;
  friend struct ExpressionParser;
};

/// True for a name that a parameter may have: letters, digits and _, not starting with a digit, and
/// none of pi, inf, nan.
bool isParameterName(std::string_view name);

/// Values of the parameters, exact.
using ParameterValues = std::map<std::string, Exact>;

/** The exact value of an expression.
    @throws InputError (at `where`) on an unknown parameter, a division by zero, a product or
    quotient that leaves rational + rational * pi, or a value that is not finite as a double. */
Exact exactValue(const Expression& expression, const ParameterValues& values,
                 const SourceLocation& where = {});

/** The value of an expression in any algebra: `Algebra` supplies `number(Rational)`,
    `parameter(name)` and `pi()`, each returning T, and T has + - * / and unary minus. */
template <typename T, typename Algebra>
T evaluateIn(const Expression& e, const Algebra& algebra) {
  switch (e.kind()) {
    case Expression::Kind::kNumber:
      return algebra.number(e.number());
    case Expression::Kind::kParameter:
      return algebra.parameter(e.parameter());
    case Expression::Kind::kPi:
      return algebra.pi();
    case Expression::Kind::kNegate:
      return -evaluateIn<T>(e.left(), algebra);
    case Expression::Kind::kAdd:
      return evaluateIn<T>(e.left(), algebra) + evaluateIn<T>(e.right(), algebra);
    case Expression::Kind::kSubtract:
      return evaluateIn<T>(e.left(), algebra) - evaluateIn<T>(e.right(), algebra);
    case Expression::Kind::kMultiply:
      return evaluateIn<T>(e.left(), algebra) * evaluateIn<T>(e.right(), algebra);
    case Expression::Kind::kDivide:
      return evaluateIn<T>(e.left(), algebra) / evaluateIn<T>(e.right(), algebra);
    case Expression::Kind::kPower: {
      const T base = evaluateIn<T>(e.left(), algebra);
      const int n = e.exponent();
      T result = algebra.number(Rational(1));
      for (int i = 0; i < (n < 0 ? -n : n); ++i) result = result * base;
      return n < 0 ? T(algebra.number(Rational(1)) / result) : result;
    }
    case Expression::Kind::kTime:
    case Expression::Kind::kCall:
      break;
  }
  throw std::logic_error("evaluateIn: not an expression in the parameters alone");
}

}  // namespace dynwitness::scene
