// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "scene/function_values.hpp"
#include "scene/rational_signs.hpp"

namespace dynwitness::scene {
namespace {

// Limits that no mechanism comes near; they keep hostile input from filling memory or the stack.
constexpr int kMaxNesting = 200;           // parentheses inside parentheses
constexpr int kMaxHeight = 1000;           // operations above one another, 1+1+1+... counts too
constexpr int kMaxExponent = 64;           // of x^n
constexpr int kMaxDecimalExponent = 400;   // of 1e-3; double ends at 308 and -324
constexpr std::size_t kMaxDigits = 1000;   // of one decimal
constexpr unsigned kMaxValueBits = 20000;  // of numerator or denominator of an exact value

constexpr const char* kFunctions[] = {"sin", "cos", "asin", "sqrt", "exp"};

using boost::multiprecision::abs;
using boost::multiprecision::denominator;
using boost::multiprecision::msb;
using boost::multiprecision::numerator;

// -------------------------------------------------------------------------- correct rounding

/// The double nearest to a rational, ties to even; infinite beyond the range of double.
double nearestDouble(const Rational& x) {
  Integer n = numerator(x);
  const Integer d = denominator(x);
  const bool is_negative = n.sign() < 0;  // asking x itself would divide
  if (is_negative) n = -n;
  if (n.is_zero()) return 0;
  // integers below 2^53 are doubles, and their quotient is rounded once
  if (msb(n) <= 52 && msb(d) <= 52) {
    const double result = static_cast<double>(static_cast<std::uint64_t>(n)) /
                          static_cast<double>(static_cast<std::uint64_t>(d));
    return is_negative ? -result : result;
  }
  int e = static_cast<int>(msb(n)) - static_cast<int>(msb(d));  // 2^e <= |x| < 2^(e+1), or one less
  if (e >= 0 ? n < (d << e) : (n << -e) < d) --e;
  const int unit = std::max(e - 52, -1074);  // exponent of the last place; -1074: subnormal
  const Integer top = unit < 0 ? Integer(n << -unit) : n,
                bottom = unit > 0 ? Integer(d << unit) : d;
  Integer quotient, remainder;
  boost::multiprecision::divide_qr(top, bottom, quotient, remainder);
  remainder *= 2;
  if (remainder > bottom || (remainder == bottom && bit_test(quotient, 0))) ++quotient;
  const double result = std::ldexp(quotient.convert_to<double>(), unit);
  return is_negative ? -result : result;
}

std::string excerpt(std::string_view text) {
  const std::size_t kLongest = 80;
  return text.size() <= kLongest ? std::string(text)
                                 : std::string(text.substr(0, kLongest)) + "...";
}

bool isNameStart(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool isDigit(char c) {
  return c >= '0' && c <= '9';
}
bool isSpace(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool isReserved(std::string_view name) {
  return name == "pi" || name == "inf" || name == "nan";
}

/// "0.125" for 1/8; empty when the decimal does not end or is long.
std::string terminatingDecimal(const Rational& x) {
  const unsigned kLongest = 40;
  if (bottom(x) == 1) return top(x).str();
  const unsigned twos = lsb(bottom(x));  // 2^twos 5^fives divides the denominator
  Integer rest = bottom(x) >> twos;
  unsigned fives = 0;
  for (; rest != 1 && rest % 5 == 0; rest /= 5) ++fives;
  const unsigned places = std::max(twos, fives);
  if (rest != 1 || places > kLongest) return {};
  std::string digits = Integer(top(x) * (powerOfTen(places) / bottom(x))).str();
  if (digits.size() <= places) digits.insert(0, places + 1 - digits.size(), '0');
  return digits.insert(digits.size() - places, ".");
}

}  // namespace

// ------------------------------------------------------------------------------------- Exact

double Exact::toDouble() const {
  if (scene::isZero(pi_multiple)) return nearestDouble(rational);
  // an irrational number is never halfway between two doubles, so this ends
  for (unsigned bits = 256;; bits *= 2) {
    const Bracket b = bracket(*this, bits);
    const double low = nearestDouble(b.low), high = nearestDouble(b.high);
    if (low == high) return low;
  }
}

Rational Exact::approximation() const {
  if (scene::isZero(pi_multiple)) return rational;
  static const Rational kRelative(Integer(1), powerOfTen(60));
  for (unsigned bits = 256;; bits *= 2) {
    const Bracket b = bracket(*this, bits);
    if (b.high - b.low <= kRelative * abs(b.low) && b.low.sign() == b.high.sign()) {
      return (b.low + b.high) / 2;
    }
  }
}

// -------------------------------------------------------------------------------- Expression

bool isParameterName(std::string_view name) {
  return !name.empty() && isNameStart(name.front()) && !isReserved(name) &&
         std::all_of(name.begin(), name.end(), [](char c) { return isNameStart(c) || isDigit(c); });
}

struct Expression::Node {
  Kind kind = Kind::kNumber;
  Rational number;   // kNumber
  std::string text;  // kNumber: as it was spelled; kParameter, kCall: its name
  Expression left{nullptr}, right{nullptr};
  int exponent = 0;         // kPower
  int height = 0;           // operations on the longest way down to a leaf
  bool is_rounded = false;  // kNumber: a function's value (function_values.hpp)
};

/// Builds nodes, and reads expressions by recursive descent, one function a line of the grammar.
struct ExpressionParser {
  using Kind = Expression::Kind;

  std::string_view text;
  SourceLocation where;
  bool of_time = false;  // whether "t" and functions are allowed
  std::size_t at = 0;
  int nesting = 0;

  static Expression leaf(Kind kind, Rational number, std::string spelling) {
    auto node = std::make_shared<Expression::Node>();
    node->kind = kind;
    node->number = std::move(number);
    node->text = std::move(spelling);
    return Expression(std::move(node));
  }

  static Expression operation(Kind kind, const Expression& left, const Expression& right,
                              int exponent = 0) {
    auto node = std::make_shared<Expression::Node>();
    node->kind = kind;
    node->left = left;
    node->right = right;
    node->exponent = exponent;
    node->height = 1 + std::max(left.node_->height, right.node_ ? right.node_->height : 0);
    return Expression(std::move(node));
  }
  static Expression operation(Kind kind, const Expression& only, int exponent = 0) {
    return operation(kind, only, Expression(std::shared_ptr<const Expression::Node>()), exponent);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(where, "expression \"" + excerpt(text) + "\": " + what);
  }

  /// "column 3: found "x", allowed: ..."
  [[noreturn]] void unexpected(const std::string& allowed) const {
    const std::string found = at < text.size() ? '"' + std::string(1, text[at]) + '"' : "its end";
    fail("column " + std::to_string(at + 1) + ": found " + found + ", allowed: " + allowed);
  }

  void skipSpaces() {
    while (at < text.size() && isSpace(text[at])) ++at;
  }

  bool accept(char c) {
    skipSpaces();
    if (at >= text.size() || text[at] != c) return false;
    ++at;
    return true;
  }

  Expression checked(Expression e) const {
    if (e.node_->height > kMaxHeight) {
      fail("more than " + std::to_string(kMaxHeight) + " operations upon one another");
    }
    return e;
  }

  Expression whole() {
    skipSpaces();
    if (at == text.size()) fail("empty, allowed: a number or an expression in the parameters");
    Expression e = sum();
    skipSpaces();
    if (at < text.size() && text[at] == ')') {
      fail("unbalanced parenthesis: \")\" at column " + std::to_string(at + 1) + " closes nothing");
    }
    if (at < text.size()) unexpected("an operator + - * / ^ or the end");
    return e;
  }

  Expression sum() {
    Expression e = product();
    while (true) {
      if (accept('+')) {
        e = checked(operation(Kind::kAdd, e, product()));
      } else if (accept('-')) {
        e = checked(operation(Kind::kSubtract, e, product()));
      } else {
        return e;
      }
    }
  }

  Expression product() {
    Expression e = unary();
    while (true) {
      if (accept('*')) {
        e = checked(operation(Kind::kMultiply, e, unary()));
      } else if (accept('/')) {
        e = checked(operation(Kind::kDivide, e, unary()));
      } else {
        return e;
      }
    }
  }

  Expression unary() {
    const bool negative = accept('-');
    if (!negative) accept('+');
    const Expression e = power();
    // programs that export scenes write "-0.0", which is the structural zero all the same
    return negative && !e.isLiteralZero() ? checked(operation(Kind::kNegate, e)) : e;
  }

  Expression power() {
    Expression base = atom();
    if (!accept('^')) return base;
    skipSpaces();
    const bool negative = accept('-');
    if (at >= text.size() || !isDigit(text[at])) unexpected("an integer exponent");
    int n = 0;
    while (at < text.size() && isDigit(text[at])) {
      n = std::min(10 * n + (text[at++] - '0'), kMaxExponent + 1);
    }
    if (at < text.size() && (text[at] == '.' || text[at] == 'e')) unexpected("an integer exponent");
    if (n > kMaxExponent) {
      const std::string limit = std::to_string(kMaxExponent);
      fail("exponent too large, allowed: integers from -" + limit + " to " + limit);
    }
    return checked(operation(Kind::kPower, base, negative ? -n : n));
  }

  Expression atom() {
    skipSpaces();
    const char c = at < text.size() ? text[at] : '\0';
    if (isDigit(c) || c == '.') return decimal();
    if (isNameStart(c)) return name();
    if (c == '*' && at > 0 && text[at - 1] == '*')
      fail("column " + std::to_string(at) + ": \"**\", allowed: ^ for powers, as in x^2");
    if (c != '(') unexpected("a number, a parameter, pi or \"(\"");
    const std::size_t opened = at++;
    if (++nesting > kMaxNesting) {
      fail("more than " + std::to_string(kMaxNesting) + " parentheses inside one another");
    }
    Expression e = sum();
    if (!accept(')')) {
      if (at < text.size()) unexpected("an operator + - * / ^ or \")\"");
      fail("unbalanced parenthesis: \"(\" at column " + std::to_string(opened + 1) +
           " is never closed");
    }
    --nesting;
    return e;
  }

  Expression name() {
    const std::size_t start = at;
    while (at < text.size() && (isNameStart(text[at]) || isDigit(text[at]))) ++at;
    std::string word(text.substr(start, at - start));
    if (word == "pi") return leaf(Kind::kPi, 0, {});
    if (isReserved(word)) fail("\"" + word + "\" is not a finite number");
    if (of_time && word == "t") return leaf(Kind::kTime, 0, {});
    skipSpaces();
    if (at < text.size() && text[at] == '(') {
      if (!of_time) return functionOfNumber(word);
      const auto is_word = [&word](const char* function) { return word == function; };
      if (std::none_of(std::begin(kFunctions), std::end(kFunctions), is_word)) {
        fail("no function \"" + word + "\", allowed: sin, cos, asin, sqrt, exp");
      }
      Expression call = operation(Kind::kCall, atom());
      std::const_pointer_cast<Expression::Node>(call.node_)->text = word;
      return checked(call);
    }
    return leaf(Kind::kParameter, 0, std::move(word));
  }

  /// A function of numbers is a number: exact, or the decimal that is nearest to it.
  Expression functionOfNumber(const std::string& word) {
    const auto is_word = [&word](const char* function) { return word == function; };
    if (std::none_of(std::begin(kFunctionsOfNumbers), std::end(kFunctionsOfNumbers), is_word))
      fail("no function \"" + word + "\" of numbers, allowed: sin, cos, asin, sqrt" +
           (word == "exp" ? " (exp: in motions alone)" : ""));
    const Expression argument = atom();
    const std::string spelling = word + "(" + argument.text() + ")";
    if (const std::set<std::string> names = argument.parameters(); !names.empty())
      fail("\"" + spelling + "\" is a function of parameter \"" + *names.begin() +
           "\", which --set may change and exact checks draw at random, and no number then has all "
           "digits of it; allowed: functions of numbers and pi, here or as one more parameter (" +
           (word == "sqrt" ? "r = \"sqrt(2)\")"
                           : "c = \"" + word + (word == "asin" ? "(1/3)\")" : "(pi/10)\")")));
    if (hasRounded(argument))
      fail("\"" + spelling + "\" is a function of a number that is rounded itself, allowed: " +
           "functions of rational + rational*pi");
    try {
      const FunctionValue found = functionValue(word, exactValue(argument, {}, where));
      if (!isZero(found.value.pi_multiple))
        return operation(Kind::kMultiply, Expression(found.value.pi_multiple),
                         leaf(Kind::kPi, 0, {}));
      Expression value = leaf(Kind::kNumber, found.value.rational, spelling);
      std::const_pointer_cast<Expression::Node>(value.node_)->is_rounded = found.is_rounded;
      return value;
    } catch (const std::domain_error& outside) {
      fail("\"" + spelling + "\": " + outside.what());
    }
  }

  static bool hasRounded(const Expression& e) {
    const auto isRounded = [](const Expression& operand) {
      return operand.node_ && hasRounded(operand);
    };
    return e.node_->is_rounded || isRounded(e.left()) || isRounded(e.right());
  }

  std::string digits() {
    const std::size_t start = at;
    while (at < text.size() && isDigit(text[at])) ++at;
    return std::string(text.substr(start, at - start));
  }

  Expression decimal() {
    const std::size_t start = at;
    std::string mantissa = digits();
    int places = 0;
    if (at < text.size() && text[at] == '.') {
      ++at;
      const std::string fraction = digits();
      mantissa += fraction;
      places = static_cast<int>(fraction.size());
    }
    if (mantissa.empty()) unexpected("a digit");
    int exponent = 0;
    if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
      ++at;
      const bool negative = at < text.size() && text[at] == '-';
      if (at < text.size() && (text[at] == '-' || text[at] == '+')) ++at;
      if (at >= text.size() || !isDigit(text[at])) unexpected("the digits of a decimal exponent");
      while (at < text.size() && isDigit(text[at])) {
        exponent = std::min(10 * exponent + (text[at++] - '0'), kMaxDecimalExponent + 1);
      }
      if (negative) exponent = -exponent;
    }
    const std::string spelling(text.substr(start, at - start));
    if (std::abs(exponent) > kMaxDecimalExponent) {
      const std::string limit = std::to_string(kMaxDecimalExponent);
      fail("number " + excerpt(spelling) + " is too large or too small to be finite in a double, " +
           "allowed: decimal exponents from -" + limit + " to " + limit);
    }
    if (mantissa.size() > kMaxDigits) {
      fail("a number of more than " + std::to_string(kMaxDigits) + " digits");
    }
    mantissa.erase(0, std::min(mantissa.find_first_not_of('0'), mantissa.size() - 1));
    const Integer significand(mantissa);  // without leading zeros: they would make it octal
    const int shift = exponent - places;
    Rational value = shift >= 0 ? Rational(significand * powerOfTen(shift))
                                : Rational(significand, powerOfTen(-shift));
    return leaf(Kind::kNumber, std::move(value), spelling);
  }
};

Expression::Expression() : node_(nullptr) {
  static const Expression zero(Rational(0));  // shared: most numbers of a scene are left out
  node_ = zero.node_;
}

bool isRoundedFunction(const Expression& number) {
  return number.kind() == Expression::Kind::kNumber && ExpressionParser::hasRounded(number);
}

bool hasRoundedFunction(const Expression& expression) {
  return ExpressionParser::hasRounded(expression);
}

// Only what the grammar calls a decimal is one leaf: -2 is the negative of 2, and 1/3 a quotient,
// just as if they had been read, so that text() and parse() are inverse for built numbers too.
Expression::Expression(Rational value) : node_(nullptr) {
  using Build = ExpressionParser;
  if (isNegative(value)) {
    *this = Build::operation(Kind::kNegate, Expression(Rational(-value)));
    return;
  }
  std::string spelling = terminatingDecimal(value);
  if (spelling.empty()) {
    *this = Build::operation(Kind::kDivide, Expression(Rational(numerator(value))),
                             Expression(Rational(denominator(value))));
    return;
  }
  *this = Build::leaf(Kind::kNumber, std::move(value), std::move(spelling));
}

Expression Expression::parse(std::string_view text, const SourceLocation& where) {
  ExpressionParser parser{text, where};
  return parser.whole();
}
Expression Expression::parseOfTime(std::string_view text, const SourceLocation& where) {
  ExpressionParser parser{text, where, true};
  return parser.whole();
}

Expression::Kind Expression::kind() const {
  return node_->kind;
}
const Rational& Expression::number() const {
  return node_->number;
}
const std::string& Expression::parameter() const {
  return node_->text;
}
const std::string& Expression::function() const {
  return node_->text;
}
const Expression& Expression::left() const {
  return node_->left;
}
const Expression& Expression::right() const {
  return node_->right;
}
int Expression::exponent() const {
  return node_->exponent;
}

bool Expression::isLiteralZero() const {
  return kind() == Kind::kNumber && isZero(number());
}

std::set<std::string> Expression::parameters() const {
  if (kind() == Kind::kParameter) return {parameter()};
  std::set<std::string> names;
  for (const Expression& operand : {left(), right()}) {
    if (operand.node_) names.merge(operand.parameters());
  }
  return names;
}

std::string Expression::text() const {
  // how tightly a node binds: sum 0, product 1, negation 2, power 3, atom 4
  const auto strength = [](Kind kind) {
    switch (kind) {
      case Kind::kAdd:
      case Kind::kSubtract:
        return 0;
      case Kind::kMultiply:
      case Kind::kDivide:
        return 1;
      case Kind::kNegate:
        return 2;
      case Kind::kPower:
        return 3;
      default:
        return 4;
    }
  };
  const auto operand = [&strength](const Expression& e, int least) {
    return strength(e.kind()) >= least ? e.text() : "(" + e.text() + ")";
  };
  switch (kind()) {
    case Kind::kNumber:
    case Kind::kParameter:
      return node_->text;
    case Kind::kPi:
      return "pi";
    case Kind::kTime:
      return "t";
    case Kind::kCall:
      return function() + "(" + left().text() + ")";
    case Kind::kNegate:
      return "-" + operand(left(), 3);
    case Kind::kAdd:
      return operand(left(), 0) + " + " + operand(right(), 1);
    case Kind::kSubtract:
      return operand(left(), 0) + " - " + operand(right(), 1);
    case Kind::kMultiply:
      return operand(left(), 1) + "*" + operand(right(), 2);
    case Kind::kDivide:
      return operand(left(), 1) + "/" + operand(right(), 2);
    case Kind::kPower:
      return operand(left(), 4) + "^" + std::to_string(exponent());
  }
  throw std::logic_error("Expression::text: unknown kind");
}

// ------------------------------------------------------------------------------- exact values

namespace {

struct ExactEvaluation {
  const Expression& whole;
  const ParameterValues& values;
  const SourceLocation& where;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(where, "expression \"" + excerpt(whole.text()) + "\": " + what);
  }

  Exact checked(Exact x) const {
    for (const Rational* part : {&x.rational, &x.pi_multiple}) {
      if (isZero(*part)) continue;
      const unsigned bits = std::max(msb(abs(numerator(*part))), msb(denominator(*part)));
      if (bits > kMaxValueBits) {
        fail("a value of more than " + std::to_string(kMaxValueBits) + " bits on the way");
      }
    }
    return x;
  }

  Exact multiply(const Exact& a, const Exact& b) const {
    if (!isZero(a.pi_multiple) && !isZero(b.pi_multiple)) {
      fail("a product of two numbers with pi in them, allowed: rational + rational*pi");
    }
    return checked(
        {a.rational * b.rational, a.rational * b.pi_multiple + a.pi_multiple * b.rational});
  }

  Exact divide(const Exact& a, const Exact& b) const {
    const bool has_pi = !isZero(b.pi_multiple);
    if (!has_pi && isZero(b.rational)) fail("division by zero");
    if (!has_pi) return checked({a.rational / b.rational, a.pi_multiple / b.rational});
    // the quotient is rational when numerator and denominator are proportional: 2*pi / pi
    if (a.rational * b.pi_multiple != a.pi_multiple * b.rational) {
      fail("a division by a number with pi in it, allowed: rational + rational*pi");
    }
    return checked({a.pi_multiple / b.pi_multiple, 0});
  }

  Exact value(const Expression& e) const {
    using Kind = Expression::Kind;
    switch (e.kind()) {
      case Kind::kNumber:
        return {e.number(), 0};
      case Kind::kPi:
        return {0, 1};
      case Kind::kParameter: {
        const auto found = values.find(e.parameter());
        if (found != values.end()) return found->second;
        std::string names;
        constexpr std::size_t kMostLetters = 500;
        for (const auto& [name, unused] : values) {
          if (names.size() < kMostLetters)
            names += (names.empty() ? "" : ", ") + name;
          else if (names.compare(names.size() - 3, 3, "...") != 0)
            names += ", ...";
        }
        fail("parameter \"" + excerpt(e.parameter()) + "\" is not defined, allowed: " +
             (names.empty() ? "pi (there are no parameters)" : names + ", pi"));
      }
      case Kind::kNegate: {
        const Exact a = value(e.left());
        return {-a.rational, -a.pi_multiple};
      }
      case Kind::kAdd:
      case Kind::kSubtract: {
        const Exact a = value(e.left()), b = value(e.right());
        const int sign = e.kind() == Kind::kAdd ? 1 : -1;
        return checked({a.rational + sign * b.rational, a.pi_multiple + sign * b.pi_multiple});
      }
      case Kind::kMultiply:
        return multiply(value(e.left()), value(e.right()));
      case Kind::kDivide:
        return divide(value(e.left()), value(e.right()));
      case Kind::kPower: {
        const Exact base = value(e.left());
        Exact result{1, 0};
        for (int i = 0; i < std::abs(e.exponent()); ++i) result = multiply(result, base);
        return e.exponent() < 0 ? divide({1, 0}, result) : result;
      }
      case Kind::kTime:
      case Kind::kCall:
        fail("a function of time, allowed: an expression in the parameters");
    }
    throw std::logic_error("exactValue: unknown expression kind");
  }
};

/// Whether lengths alone tell: |x| < 2^(msb(numerator) + 1), and pi < 4.
bool isSurelyFinite(const Exact& x) {
  constexpr unsigned kMostBits = 1000;  // of 1024
  const auto isSmall = [](const Rational& part) {
    const Integer n = abs(numerator(part));
    return n.is_zero() || msb(n) < kMostBits;
  };
  return isSmall(x.rational) && isSmall(x.pi_multiple);
}

}  // namespace

Exact exactValue(const Expression& expression, const ParameterValues& values,
                 const SourceLocation& where) {
  if (expression.isLiteralZero()) return {};  // most numbers of a scene
  const ExactEvaluation evaluation{expression, values, where};
  Exact result = evaluation.value(expression);
  if (!isSurelyFinite(result) && !std::isfinite(result.toDouble())) {
    evaluation.fail("not finite: beyond the largest double (1.8e308)");
  }
  return result;
}

}  // namespace dynwitness::scene
