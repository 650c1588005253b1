// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/expression.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/function_values.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness::scene;

namespace {

Exact valueOf(const std::string& text, const ParameterValues& values = {}) {
  return exactValue(Expression::parse(text), values);
}

std::string complaint(const std::string& text, const ParameterValues& values = {}) {
  try {
    exactValue(Expression::parse(text, {"file.toml", 7}), values, {"file.toml", 7});
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The algebra of plain doubles.
struct Doubles {
  double number(const Rational& r) const { return r.convert_to<double>(); }
  double parameter(const std::string& name) const { return name == "x" ? 1.75 : 0.375; }
  double pi() const { return M_PI; }
};

/// A random sentence of the grammar in the parameters x and y.
std::string sentence(std::mt19937* random, int depth) {
  const auto pick = [random](int n) {
    return static_cast<int>((*random)() % static_cast<unsigned>(n));
  };
  const char* const atoms[] = {"x", "y", "2", "0.25", "1e-3", ".5", "3", "7.50"};
  if (depth == 0) return atoms[pick(8)];
  const std::string a = sentence(random, depth - 1), b = sentence(random, depth - 1);
  switch (pick(7)) {
    case 0:
      return a + " +" + b;
    case 1:
      return a + "- " + b;
    case 2:
      return "(" + a + ")*(" + b + ")";
    case 3:
      return a + " * " + b;
    case 4:
      return "-(" + a + ")";
    case 5:
      return "(" + a + ")^" + std::to_string(pick(4));
    default:
      return "(" + a + ")/" + b;
  }
}

// pi to 100 decimals, as printed in the literature (A000796)
const char* const kPiDigits =
    "3.1415926535897932384626433832795028841971693993751058209749445923078164062862089986280348253421170679";

}  // namespace

BOOST_AUTO_TEST_SUITE(exact_numbers)

BOOST_AUTO_TEST_CASE(a_decimal_is_the_rational_that_was_printed) {
  BOOST_TEST((valueOf("0.4318") == Exact{Rational(4318, 10000), 0}));
  BOOST_TEST((valueOf("1e-3") == Exact{Rational(1, 1000), 0}));
  BOOST_TEST((valueOf(".5") == Exact{Rational(1, 2), 0}));
  BOOST_TEST((valueOf("5.") == Exact{5, 0}));
  BOOST_TEST((valueOf("2.5E+2") == Exact{250, 0}));
  BOOST_TEST((valueOf("010") == Exact{10, 0}));  // a leading zero does not mean octal
  BOOST_TEST((valueOf("0.0") == Exact{0, 0}));
  BOOST_TEST((valueOf("0.1 + 0.2 - 0.3").isZero()));
}

// strtod of glibc is correctly rounded and shares no code with us
BOOST_DATA_TEST_CASE(
    decimals_round_to_the_double_that_strtod_gives,
    data::make({"0.4318", "0.1", "1e-3", "1", "0", "9007199254740993", "9007199254740992.99999",
                "9007199254740995", "1.7976931348623157e308", "2.2250738585072014e-308",
                "2.2250738585072011e-308", "5e-324", "2.4703282292062328e-324",
                "2.4703282292062327e-324", "1e-323", "7.4e-324", "1e-400",
                "3.0000000000000004440892098500626", "123456789012345678901234567890"}),
    text) {
  BOOST_TEST(valueOf(text).toDouble() == std::strtod(text, nullptr));
  BOOST_TEST(valueOf("-" + std::string(text)).toDouble() == -std::strtod(text, nullptr));
}

BOOST_DATA_TEST_CASE(random_decimals_round_to_the_double_that_strtod_gives, data::xrange(2000u),
                     seed) {
  std::mt19937 random(seed);
  std::string text = std::to_string(random() % 10) + ".";
  for (auto n = random() % 25; n > 0; --n) text += std::to_string(random() % 10);
  text += "e" + std::to_string(static_cast<int>(random() % 640) - 335);
  const double expected = std::strtod(text.c_str(), nullptr);
  BOOST_TEST((Exact{Expression::parse(text).number(), 0}.toDouble() == expected), text);
}

// IEEE division is correctly rounded
BOOST_DATA_TEST_CASE(quotients_of_integers_round_as_division_does, data::xrange(500), seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  const int n = static_cast<int>(random() % 1000000) - 500000,
            d = 1 + static_cast<int>(random() % 1000000);
  BOOST_TEST((Exact{Rational(n, d), 0}.toDouble()) == static_cast<double>(n) / d);
}

BOOST_AUTO_TEST_CASE(multiples_of_pi_round_to_the_nearest_double) {
  BOOST_TEST(valueOf("pi").toDouble() == M_PI);  // the literals of math.h have 20 digits
  BOOST_TEST(valueOf("pi/2").toDouble() == M_PI_2);
  BOOST_TEST(valueOf("-pi/4").toDouble() == -M_PI_4);
  // what is left after 50 decimals of pi: the next digits, from the same printed source
  const std::string head = std::string(kPiDigits).substr(0, 52),
                    tail = std::string(kPiDigits).substr(52);
  BOOST_TEST(valueOf("pi - " + head).toDouble() ==
             std::strtod(("0." + tail + "e-50").c_str(), nullptr));
}

BOOST_AUTO_TEST_CASE(approximation_has_60_digits_of_pi) {
  const Rational pi = valueOf("pi").approximation(), printed = valueOf(kPiDigits).rational;
  const Rational difference = pi - printed;
  const Rational limit(Integer(1), boost::multiprecision::pow(Integer(10), 60));
  BOOST_TEST((abs(difference) < 3 * limit));
  // relative to the number, also after cancellation
  const std::string head = std::string(kPiDigits).substr(0, 32);
  const Rational small = valueOf("pi - " + head).approximation(),
                 expected = printed - valueOf(head).rational;
  BOOST_TEST((abs(Rational(small - expected)) < abs(expected) * limit));
}

BOOST_AUTO_TEST_CASE(arithmetic_stays_inside_rational_plus_rational_times_pi) {
  BOOST_TEST((valueOf("2*pi/3 - 1/4") == Exact{Rational(-1, 4), Rational(2, 3)}));
  BOOST_TEST((valueOf("(2*pi)/pi") == Exact{2, 0}));
  BOOST_TEST((valueOf("(3 + 6*pi)/(1 + 2*pi)") == Exact{3, 0}));
  BOOST_TEST((valueOf("pi^1") == Exact{0, 1}));
  BOOST_TEST((valueOf("pi^0") == Exact{1, 0}));
  BOOST_TEST(contains(complaint("pi*pi"), "two numbers with pi"));
  BOOST_TEST(contains(complaint("1/pi"), "division by a number with pi"));
  BOOST_TEST(contains(complaint("pi^2"), "two numbers with pi"));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(grammar)

BOOST_AUTO_TEST_CASE(operators_bind_as_in_mathematics) {
  BOOST_TEST((valueOf("8-4-2") == Exact{2, 0}));
  BOOST_TEST((valueOf("8/4/2") == Exact{1, 0}));
  BOOST_TEST((valueOf("2+3*4^2") == Exact{50, 0}));
  BOOST_TEST((valueOf("-2^2") == Exact{-4, 0}));
  BOOST_TEST((valueOf("(-2)^2") == Exact{4, 0}));
  BOOST_TEST((valueOf("2^-2") == Exact{Rational(1, 4), 0}));
  BOOST_TEST((valueOf("2*-3") == Exact{-6, 0}));
  BOOST_TEST((valueOf("+2 - -3") == Exact{5, 0}));
  BOOST_TEST((valueOf("m*l^2/12", {{"m", {6, 0}}, {"l", {Rational(1, 2), 0}}}) ==
              Exact{Rational(1, 8), 0}));
}

BOOST_DATA_TEST_CASE(exact_values_agree_with_plain_doubles, data::xrange(300u), seed) {
  std::mt19937 random(seed);
  const Expression e = Expression::parse(sentence(&random, 3));
  const ParameterValues values{{"x", {Rational(7, 4), 0}}, {"y", {Rational(3, 8), 0}}};
  double exact = 0;
  try {
    exact = exactValue(e, values).toDouble();
  } catch (const InputError& error) {
    BOOST_TEST(contains(error.what(), "division by zero"));
    return;
  }
  const double rounded = evaluateIn<double>(e, Doubles{});
  // doubles lose digits where large terms cancel; measured worst 9e-16 over these seeds
  BOOST_TEST(std::abs(exact - rounded) <= 1e-14 * std::max(1.0, std::abs(exact)), e.text());
}

BOOST_DATA_TEST_CASE(canonical_text_is_read_as_the_same_text_and_value, data::xrange(300u), seed) {
  std::mt19937 random(seed);
  const Expression e = Expression::parse(sentence(&random, 4));
  const Expression again = Expression::parse(e.text());
  BOOST_TEST(again.text() == e.text());
  BOOST_TEST((again.kind() == e.kind()));
  const ParameterValues values{{"x", {Rational(7, 4), 0}}, {"y", {Rational(3, 8), 0}}};
  try {
    BOOST_TEST((exactValue(again, values) == exactValue(e, values)), e.text());
  } catch (const InputError& error) {
    BOOST_TEST(contains(error.what(), "division by zero"));
  }
}

BOOST_AUTO_TEST_CASE(canonical_text_has_no_needless_parentheses_and_keeps_spellings) {
  const auto canonical = [](const char* text) { return Expression::parse(text).text(); };
  BOOST_TEST(canonical("(m1*(l1)^2)/12") == "m1*l1^2/12");
  BOOST_TEST(canonical("a-(b-c)") == "a - (b - c)");
  BOOST_TEST(canonical("(a-b)-c") == "a - b - c");
  BOOST_TEST(canonical("a/(b*c)") == "a/(b*c)");
  BOOST_TEST(canonical("-(a*b)") == "-(a*b)");
  BOOST_TEST(canonical("-(a)*b") == "-a*b");
  BOOST_TEST(canonical("(-a)^2") == "(-a)^2");
  BOOST_TEST(canonical("-(a^2)") == "-a^2");
  BOOST_TEST(canonical("-(-a)") == "-(-a)");
  BOOST_TEST(canonical("(a^2)^-3") == "(a^2)^-3");
  BOOST_TEST(canonical("1.50e-3+.5") == "1.50e-3 + .5");
  BOOST_TEST(canonical("-0.0") == "0.0");
}

BOOST_AUTO_TEST_CASE(numbers_made_in_a_program_are_written_as_they_would_be_read) {
  for (const Rational& r : {Rational(0), Rational(7), Rational(-7), Rational(1, 8), Rational(-1, 3),
                            Rational(22, 7), Rational(1, Integer(1) << 60), Rational(-5, 2)}) {
    const Expression e(r), again = Expression::parse(e.text());
    BOOST_TEST((exactValue(e, {}).rational == r));
    BOOST_TEST((exactValue(again, {}).rational == r));
    BOOST_TEST((again.kind() == e.kind()));
    BOOST_TEST(again.text() == e.text());
  }
  BOOST_TEST(Expression(Rational(1, 8)).text() == "0.125");
  BOOST_TEST(Expression(Rational(1, 1000)).text() == "0.001");
  BOOST_TEST(Expression(Rational(-1, 3)).text() == "-(1/3)");
}

BOOST_AUTO_TEST_CASE(only_a_literal_zero_is_a_literal_zero) {
  BOOST_TEST(Expression().isLiteralZero());
  BOOST_TEST(Expression::parse("0.00").isLiteralZero());
  BOOST_TEST(Expression::parse("-0.0").isLiteralZero());
  BOOST_TEST(!Expression::parse("1-1").isLiteralZero());
  BOOST_TEST(!Expression::parse("x").isLiteralZero());
}

BOOST_AUTO_TEST_CASE(parameters_are_the_names_that_occur) {
  const std::set<std::string> expected{"l_1", "m"};
  BOOST_TEST(Expression::parse("m*l_1^2/12 + pi - m").parameters() == expected);
  BOOST_TEST(Expression::parse("pi + 1").parameters().empty());
}

BOOST_AUTO_TEST_CASE(a_parameter_name_is_an_identifier_that_is_not_reserved) {
  for (const char* name : {"x", "_x", "l1", "Pi", "e1"}) BOOST_TEST(isParameterName(name));
  for (const char* name : {"", "1x", "a-b", "pi", "inf", "nan", "l 1"})
    BOOST_TEST(!isParameterName(name));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(functions)

// Niven's theorem: these, and no other sines of rational multiples of pi, are rational.
BOOST_AUTO_TEST_CASE(functions_are_exact_where_they_can_be) {
  const std::pair<const char*, Exact> exact[] = {{"cos(pi/3)", {Rational(1, 2), 0}},
                                                 {"sin(pi/6)", {Rational(1, 2), 0}},
                                                 {"sin(-5*pi/6)", {Rational(-1, 2), 0}},
                                                 {"cos(2*pi/3)", {Rational(-1, 2), 0}},
                                                 {"sin(3*pi/2)", {-1, 0}},
                                                 {"cos(101*pi)", {-1, 0}},
                                                 {"sin(pi)", {0, 0}},
                                                 {"cos(0)", {1, 0}},
                                                 {"sqrt(9/4)", {Rational(3, 2), 0}},
                                                 {"sqrt(0)", {0, 0}},
                                                 {"sqrt(0.0001)", {Rational(1, 100), 0}},
                                                 {"asin(1/2)", {0, Rational(1, 6)}},
                                                 {"asin(-1)", {0, Rational(-1, 2)}},
                                                 {"asin(0)", {0, 0}},
                                                 {"cos(asin(1/2) + pi/6)", {Rational(1, 2), 0}}};
  for (const auto& [text, value] : exact) {
    BOOST_TEST((valueOf(text) == value), text);
    BOOST_TEST(!hasRoundedFunction(Expression::parse(text)), text);
  }
  BOOST_TEST(Expression::parse("sin(pi)").isLiteralZero());
}

// All 60 digits, by mpmath with 90.
BOOST_AUTO_TEST_CASE(other_values_are_the_nearest_decimal_of_60_digits) {
  const std::pair<const char*, const char*> digits[] = {
      {"cos(pi/10)", "0.951056516295153572116439333379382143405698634125750222447306"},
      {"sin(1)", "0.841470984807896506652502321630298999622563060798371065672752"},
      {"asin(0.3)", "0.304692654015397507972002961227529166954560031706776387392978"},
      {"sqrt(2)", "1.41421356237309504880168872420969807856967187537694807317668"},
      {"cos(3*pi/4)", "-0.707106781186547524400844362104849039284835937688474036588340"},
      {"sin(1e-30)", "1.00000000000000000000000000000000000000000000000000000000000e-30"},
      {"sin(1e30)", "-0.0901169019121380580303864289529873302743963329930434498854607"},
      {"sqrt(pi)", "1.77245385090551602729816748334114518279754945612238712821381"},
      {"asin(-0.9999)", "-1.55665407331738374163508146582209533637418163345855748086614"},
      {"cos(1 + pi/3)", "-0.458584096457077951669200994727528432879755450339700197762399"},
      {"sin(22)", "-0.00885130929040387592169025681577233246328920395133256644233084"},
      {"sqrt(1e-101)", "3.16227766016837933199889354443271853371955513932521682685750e-51"},
  };
  for (const auto& [text, decimal] : digits) {
    BOOST_TEST((valueOf(text) == valueOf(decimal)), text);
    BOOST_TEST(hasRoundedFunction(Expression::parse(text)), text);
  }
}

// By Boost's functions with 100 digits.
BOOST_DATA_TEST_CASE(no_digit_of_any_argument_is_wrong, data::xrange(200u), seed) {
  using Real = boost::multiprecision::cpp_bin_float_100;
  std::mt19937 random(seed);
  const long n = static_cast<long>(random() % 20000) - 10000,
             d = 1 + static_cast<long>(random() % 9999);
  const Real x = Real(n) / d;
  const std::string quotient = "(" + std::to_string(n) + "/" + std::to_string(d) + ")";
  const auto require = [&](const std::string& text, const Real& value) {
    const Expression e = Expression::parse(text);
    if (!hasRoundedFunction(e)) return;
    const Real found = exactValue(e, {}).rational.convert_to<Real>();
    // half a unit of the last digit, of a number that begins with 1; 1e-90 for Boost
    const Real most = abs(value) * Real("5.000001e-60");
    BOOST_TEST((abs(Real(found - value)) <= most), text);
  };
  require("sin" + quotient, sin(x));
  require("cos" + quotient, cos(x));
  require("cos(" + quotient + "*pi)", cos(Real(x * boost::math::constants::pi<Real>())));
  if (n >= 0) require("sqrt" + quotient, sqrt(x));
  if (std::abs(n) <= d) require("asin" + quotient, asin(x));
}

BOOST_AUTO_TEST_CASE(a_function_keeps_its_spelling) {
  for (const char* text : {"cos(pi/10)", "-2*sqrt(2)", "m*sin(3*pi/4)^2", "cos(pi/3)"}) {
    const Expression e = Expression::parse(text), again = Expression::parse(e.text());
    BOOST_TEST(e.text() == text);
    BOOST_TEST((exactValue(again, {{"m", {2, 0}}}) == exactValue(e, {{"m", {2, 0}}})));
  }
}

// An error is half a unit of the 60th digit at most, and follows sums, products and parameters.
BOOST_AUTO_TEST_CASE(what_cancels_is_refused_and_what_does_not_knows_its_error) {
  const Rational unit = Rational(1) / powerOfTen(60);
  const auto errorOf = [&](const char* text) {
    const ParameterValues values{{"c", valueOf("cos(1)")}, {"m", {2, 0}}};
    return errorOfFunctions(Expression::parse(text), values, {{"c", unit}}, {"file.toml", 7});
  };
  BOOST_TEST((errorOf("m*0.3 + pi") == 0));
  BOOST_TEST((errorOf("cos(pi/3)") == 0));
  BOOST_TEST((errorOf("cos(1)") > 0));
  BOOST_TEST((errorOf("cos(1)") <= 5 * unit));
  BOOST_TEST((errorOf("10*cos(1)") == 10 * errorOf("cos(1)")));
  BOOST_TEST((errorOf("1/cos(1)") > errorOf("cos(1)")));
  BOOST_TEST((errorOf("m*c") == 2 * unit));
  for (const char* text :
       {"sqrt(2)^2 - 2", "cos(1)^2 + sin(1)^2 - 1", "c - cos(1)", "1/(sqrt(2)^2 - 2)"}) {
    try {
      errorOf(text);
      BOOST_ERROR(text);
    } catch (const InputError& error) {
      BOOST_TEST(contains(error.what(), "these cancel here"), error.what());
      BOOST_TEST(contains(error.what(), "file.toml:7"), error.what());
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

struct Bad {
  std::string text, message;
};
std::ostream& operator<<(std::ostream& out, const Bad& bad) {
  return out << bad.text.substr(0, 40);
}

const Bad kBad[] = {
    {"", "empty"},
    {"  ", "empty"},
    {"m*(l", "unbalanced parenthesis: \"(\" at column 3 is never closed"},
    {"m)", "unbalanced parenthesis: \")\" at column 2 closes nothing"},
    {"1 2", "column 3: found \"2\", allowed: an operator"},
    {"(1 2)", "column 4: found \"2\", allowed: an operator"},
    {"1 +", "column 4: found its end, allowed: a number"},
    {"--1", "column 2: found \"-\""},
    {"2**3", "column 2: \"**\", allowed: ^ for powers, as in x^2"},
    {"2 * *3", "column 5: found \"*\", allowed: a number"},
    {"2^0.5", "an integer exponent"},
    {"2^x", "an integer exponent"},
    {"2^2^2", "column 4: found \"^\""},
    {"2^65", "exponent too large, allowed: integers from -64 to 64"},
    {"2^-99999999999999999999", "exponent too large"},
    {"1e999999999", "number 1e999999999 is too large or too small to be finite"},
    {"1e401", "too large"},
    {"1e400", "not finite"},
    {"1e308*10", "not finite"},
    {"1e", "digits of a decimal exponent"},
    {".", "found its end, allowed: a digit"},
    {"inf", "not a finite number"},
    {"2*nan", "not a finite number"},
    {"exp(1)", "\"exp\" of numbers, allowed: sin, cos, asin, sqrt (exp: in motions alone)"},
    {"tan(1)", "no function \"tan\" of numbers, allowed: sin, cos, asin, sqrt"},
    {"cos(m)", "\"cos(m)\" is a function of parameter \"m\", which --set may change"},
    {"asin(m)",
     "allowed: functions of numbers and pi, here or as one more parameter (c = \"asin(1/3)\")"},
    {"sqrt(cos(1))", "a function of a number that is rounded itself"},
    {"sqrt(-2)", "\"sqrt(-2)\": the square root of a negative number"},
    {"asin(1.01)", "the arcsine of a number beyond -1 to 1"},
    {"asin(pi/4)", "the arcsine of a number with pi in it"},
    {"cos(1", "is never closed"},
    {"cos()", "column 5: found \")\""},
    {"1/0", "division by zero"},
    {"1/(2 - 2)", "division by zero"},
    {"0^-1", "division by zero"},
    {"m", "parameter \"m\" is not defined, allowed: pi (there are no parameters)"},
    {"0,5", "column 2: found \",\""},
    {"((((9^64)^64)^64)^64)^64", "bits on the way"},
    {std::string(201, '(') + "1" + std::string(201, ')'), "more than 200 parentheses"},
    {std::string(1000000, '('), "more than 200 parentheses"},
    {std::string(1001, '1'), "more than 1000 digits"},
};

BOOST_DATA_TEST_CASE(what_is_not_a_number_is_refused_with_place_text_and_reason, data::make(kBad),
                     bad) {
  const std::string message = complaint(bad.text);
  BOOST_TEST(contains(message, "file.toml:7: expression \"" + bad.text.substr(0, 80)), message);
  BOOST_TEST(contains(message, bad.message), message);
  BOOST_TEST(message.size() < 400u);
}

BOOST_AUTO_TEST_CASE(long_sums_are_refused_before_they_fill_the_stack) {
  std::string text = "1";
  for (int i = 0; i < 1000; ++i) text += "+1";
  BOOST_TEST((valueOf(text) == Exact{1001, 0}));
  BOOST_TEST(contains(complaint(text + "+1"), "more than 1000 operations"));
}

BOOST_AUTO_TEST_CASE(two_hundred_parentheses_are_read) {
  BOOST_TEST((valueOf(std::string(200, '(') + "1" + std::string(200, ')')) == Exact{1, 0}));
}

BOOST_AUTO_TEST_CASE(an_unknown_parameter_is_answered_with_the_known_ones) {
  BOOST_TEST(contains(complaint("m*k", {{"l", {1, 0}}, {"m", {1, 0}}}),
                      "parameter \"k\" is not defined, allowed: l, m, pi"));
}

BOOST_AUTO_TEST_SUITE_END()
