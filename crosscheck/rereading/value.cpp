// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/rereading/value.hpp"

#include <cctype>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <boost/math/constants/constants.hpp>

namespace dynwitness::crosscheck::rereading {
namespace {

/// x, with what forming it lost.
Value formed(Real x, double carried) {
  const double size = static_cast<double>(abs(x));
  return {std::move(x), carried + kLoss * size};
}

bool isDigit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool isLetter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// How long a decimal without a sign is at the start of a text; 0: there is none.
std::size_t decimalLength(std::string_view text) {
  std::size_t at = 0, digits = 0;
  const auto skipDigits = [&] {
    for (; at < text.size() && isDigit(text[at]); ++at) ++digits;
  };
  skipDigits();
  if (at < text.size() && text[at] == '.') {
    ++at;
    skipDigits();
  }
  if (digits == 0) return 0;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    std::size_t exponent = at + 1;
    if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
    if (exponent < text.size() && isDigit(text[exponent])) {
      for (at = exponent; at < text.size() && isDigit(text[at]);) ++at;
    }
  }
  return at;
}

/// The functions that an expression may call: the value and how steep it is at most around there.
Value called(std::string_view function, const Value& x) {
  // a rounding of x, of the function and of what is left beside multiples of pi
  const auto with = [&x](Real value, double steepness) {
    const double size = static_cast<double>(abs(value));
    return Value{std::move(value), steepness * x.error + kLoss * (1 + x.size() + size)};
  };
  if (function == "sin") return with(sin(x.value), 1);
  if (function == "cos") return with(cos(x.value), 1);
  if (function == "asin") {
    if (abs(x.value) > 1) throw std::runtime_error("an arcsine beyond -1 to 1");
    // 1 - x^2 at the steepest place; where none is left, |asin a - asin b| <= pi/2 sqrt(|a - b|)
    const double room = static_cast<double>(1 - x.value * x.value) - 4 * x.error;
    const double steepness = room > x.error ? 1 / std::sqrt(room) : 1.6 / std::sqrt(x.error);
    return with(asin(x.value), x.error > 0 ? steepness : 0);
  }
  if (x.value < 0) throw std::runtime_error("the square root of a negative number");
  const Real root = sqrt(x.value);
  return formed(root, x.error > 0 ? x.error / static_cast<double>(root) : 0);
}

/// The two stacks.
class ShuntingYard {
 public:
  ShuntingYard(std::string_view text, const Parameters& parameters)
      : text_(text), parameters_(parameters) {}

  Value run() {
    bool wants_operand = true;
    for (skipSpaces(); at_ < text_.size(); skipSpaces()) {
      const char c = text_[at_];
      if (wants_operand)
        wants_operand = !operand(c);
      else
        wants_operand = operation(c);
    }
    if (wants_operand) fail("ends where a number was expected");
    while (!operators_.empty()) {
      if (operators_.back() == '(') fail("a parenthesis is not closed");
      apply();
    }
    return operands_.back();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(fmt::format("\"{}\": {}", text_, what));
  }
  void skipSpaces() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }

  /// @return whether it is complete: not after a sign or an opening parenthesis
  bool operand(char c) {
    if (c == '(' || c == '-' || c == '+') {
      ++at_;
      if (c != '+') operators_.push_back(c == '-' ? kSign : c);
      return false;
    }
    const std::string_view rest = text_.substr(at_);
    if (const std::size_t length = decimalLength(rest); length > 0) {
      operands_.push_back(decimal(rest.substr(0, length)));
      at_ += length;
      return true;
    }
    std::size_t length = 0;
    while (length < rest.size() &&
           (isLetter(rest[length]) || (length > 0 && isDigit(rest[length]))))
      ++length;
    const std::string_view name = rest.substr(0, length);
    if (name.empty()) fail(fmt::format("'{}' where a number was expected", c));
    at_ += length;
    skipSpaces();
    if (at_ < text_.size() && text_[at_] == '(') {
      functions_.push_back(name);
      operators_.push_back(kCall);
      return false;
    }
    if (name == "pi") {
      operands_.push_back(formed(boost::math::constants::pi<Real>(), 0));
      return true;
    }
    const auto found = parameters_.find(name);
    if (found == parameters_.end()) fail(fmt::format("there is no parameter {}", name));
    operands_.push_back(found->second);
    return true;
  }

  /// @return whether an operand has to follow
  bool operation(char c) {
    ++at_;
    if (c == '^') {
      raise();
      return false;
    }
    if (c == ')') {
      while (!operators_.empty() && operators_.back() != '(') apply();
      if (operators_.empty()) fail("a parenthesis closes nothing");
      operators_.pop_back();
      if (!operators_.empty() && operators_.back() == kCall) call();
      return false;
    }
    if (c != '+' && c != '-' && c != '*' && c != '/')
      fail(fmt::format("'{}' where an operator was expected", c));
    while (!operators_.empty() && strength(operators_.back()) >= strength(c)) apply();
    operators_.push_back(c);
    return true;
  }

  /// The last function to the last operand.
  void call() {
    operators_.pop_back();
    const std::string_view name = functions_.back();
    functions_.pop_back();
    if (name != "sin" && name != "cos" && name != "asin" && name != "sqrt")
      fail(fmt::format("there is no function {}", name));
    operands_.back() = called(name, operands_.back());
  }

  /// The last operand to the whole number that follows: nothing binds more strongly.
  void raise() {
    skipSpaces();
    const bool inverse = at_ < text_.size() && text_[at_] == '-';
    if (inverse) ++at_;
    int exponent = 0;
    const std::size_t begin = at_;
    for (; at_ < text_.size() && isDigit(text_[at_]) && exponent < 1000; ++at_)
      exponent = 10 * exponent + (text_[at_] - '0');
    if (at_ == begin) fail("no whole number after ^");
    const Value base = operands_.back();
    Value power = 1;
    for (int k = 0; k < exponent; ++k) power = power * base;
    operands_.back() = inverse ? Value(1) / power : power;
  }

  static int strength(char operation) {
    switch (operation) {
      case '+':
      case '-':
        return 1;
      case '*':
      case '/':
        return 2;
      case kSign:
        return 3;
      default:
        return 0;  // an open parenthesis stops everything
    }
  }

  void apply() {
    const char operation = operators_.back();
    operators_.pop_back();
    const Value b = operands_.back();
    if (operation == kSign) {
      operands_.back() = -b;
      return;
    }
    operands_.pop_back();
    Value& a = operands_.back();
    a = operation == '+' ? a + b : operation == '-' ? a - b : operation == '*' ? a * b : a / b;
  }

  static constexpr char kSign = '~', kCall = 'f';
  std::string_view text_;
  const Parameters& parameters_;
  std::size_t at_ = 0;
  std::vector<Value> operands_;
  std::vector<char> operators_;
  std::vector<std::string_view> functions_;  ///< of the operators that are calls, in their order
};

}  // namespace

Value operator+(const Value& a, const Value& b) {
  return formed(a.value + b.value, a.error + b.error);
}
Value operator-(const Value& a, const Value& b) {
  return formed(a.value - b.value, a.error + b.error);
}
Value operator*(const Value& a, const Value& b) {
  return formed(a.value * b.value, a.size() * b.error + b.size() * a.error);
}
Value operator/(const Value& a, const Value& b) {
  const double room = b.size() - b.error;
  if (!(room > 0)) throw std::runtime_error("a division by zero");
  return formed(a.value / b.value, (a.error + a.size() / b.size() * b.error) / room);
}

Value decimal(std::string_view text) {
  const bool has_sign = !text.empty() && (text[0] == '-' || text[0] == '+');
  const std::string_view digits = text.substr(has_sign ? 1 : 0);
  if (digits.empty() || decimalLength(digits) != digits.size())
    throw std::runtime_error(fmt::format("\"{}\" is no decimal", text));
  const Value x = formed(Real(std::string(digits)), 0);
  return has_sign && text[0] == '-' ? -x : x;
}

Value evaluated(std::string_view text, const Parameters& parameters) {
  return ShuntingYard(text, parameters).run();
}

}  // namespace dynwitness::crosscheck::rereading
