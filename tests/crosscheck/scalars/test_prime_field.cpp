// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/prime_field.hpp"

#include <set>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <flint/ulong_extras.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/dual.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using scene::Integer;
using scene::Number;
using scene::Rational;

namespace {

constexpr std::uint64_t kPrime = 9223372036854775783u;  // the largest below 2^63; 3 mod 4

PrimeField element(int seed, const std::string& name) {
  return FieldSource("test", seed, 0).element(name);
}

/// x^n by squaring.
PrimeField power(PrimeField x, std::uint64_t n) {
  PrimeField result = 1;
  for (; n > 0; n >>= 1, x *= x)
    if ((n & 1) != 0) result *= x;
  return result;
}

FieldNumbers numbers(const scene::Mechanism& mechanism = {},
                     Parameters parameters = Parameters::kAsWritten) {
  return FieldNumbers(mechanism, FieldSource("test", 1, 0), parameters);
}
scene::CosSin<PrimeField> angle(const char* text) {
  return numbers().angle(Number::parse(text));
}

bool same(const scene::CosSin<PrimeField>& a, const scene::CosSin<PrimeField>& b) {
  return a.c == b.c && a.s == b.s;
}

/// The direction that an axis turns z to.
std::array<PrimeField, 3> direction(const std::array<const char*, 3>& axis) {
  const auto turn =
      numbers().axisTurn({Number::parse(axis[0]), Number::parse(axis[1]), Number::parse(axis[2])});
  BOOST_TEST((turn.alpha.c * turn.alpha.c + turn.alpha.s * turn.alpha.s == PrimeField(1)));
  BOOST_TEST((turn.beta.c * turn.beta.c + turn.beta.s * turn.beta.s == PrimeField(1)));
  return {turn.beta.s * turn.alpha.c, turn.beta.s * turn.alpha.s, turn.beta.c};
}

}  // namespace

BOOST_AUTO_TEST_SUITE(arithmetic)

BOOST_DATA_TEST_CASE(the_axioms_of_a_field_hold, data::xrange(50), seed) {
  const PrimeField::Modulus modulus(kPrime);
  const PrimeField a = element(seed, "a"), b = element(seed, "b"), c = element(seed, "c");
  BOOST_TEST((a + b == b + a));
  BOOST_TEST((a * b == b * a));
  BOOST_TEST(((a + b) + c == a + (b + c)));
  BOOST_TEST(((a * b) * c == a * (b * c)));
  BOOST_TEST((a * (b + c) == a * b + a * c));
  BOOST_TEST((a + -a == PrimeField(0)));
  BOOST_TEST((a - b == a + -b));
  BOOST_TEST((a * a.inverse() == PrimeField(1)));
  BOOST_TEST((a / b * b == a));
  BOOST_TEST((a != a + PrimeField(1)));
}

BOOST_DATA_TEST_CASE(powers_obey_fermats_little_theorem, data::xrange(20), seed) {
  const PrimeField::Modulus modulus(kPrime);
  const PrimeField a = element(seed, "a");
  BOOST_TEST((power(a, kPrime - 1) == PrimeField(1)));
  BOOST_TEST((power(a, kPrime - 2) == a.inverse()));
}

BOOST_DATA_TEST_CASE(products_are_those_of_big_integers, data::xrange(50), seed) {
  const PrimeField::Modulus modulus(kPrime);
  const PrimeField a = element(seed, "a"), b = element(seed, "b");
  BOOST_TEST(Integer(Integer(a.residue()) * b.residue() % kPrime) == (a * b).residue());
  BOOST_TEST(Integer((Integer(a.residue()) + b.residue()) % kPrime) == (a + b).residue());
}

BOOST_AUTO_TEST_CASE(integers_and_rationals_become_their_classes) {
  const PrimeField::Modulus modulus(kPrime);
  BOOST_TEST(PrimeField(5).residue() == 5u);
  BOOST_TEST(PrimeField(-5).residue() == kPrime - 5);
  BOOST_TEST((PrimeField(std::numeric_limits<int>::min()) + PrimeField(1) ==
              -PrimeField(std::numeric_limits<int>::max())));
  BOOST_TEST((PrimeField::fromRational(Rational(-1, 3)) * PrimeField(3) == PrimeField(-1)));
  BOOST_TEST(PrimeField::fromRational(Rational(Integer(kPrime) + 7)).residue() == 7u);
  BOOST_TEST(PrimeField::fromRational(Rational(-Integer(kPrime) - 7)).residue() == kPrime - 7);
  // by another road: n d^(p-2) in big integers
  const Integer n("-123456789012345678901234567890"), d("98765432109876543210987654321");
  const Integer inverse = powm(d, Integer(kPrime - 2), Integer(kPrime));
  Integer expected = n * inverse % kPrime;
  if (expected < 0) expected += kPrime;
  BOOST_TEST(expected == PrimeField::fromRational(Rational(n, d)).residue());
}

BOOST_AUTO_TEST_CASE(division_by_zero_is_refused) {
  const PrimeField::Modulus modulus(kPrime);
  BOOST_CHECK_THROW(PrimeField(0).inverse(), DivisionByZero);
  BOOST_CHECK_THROW(PrimeField(1) / (PrimeField(2) - PrimeField(2)), DivisionByZero);
  BOOST_CHECK_THROW(PrimeField::fromRational(Rational(1, Integer(kPrime) * 2)), DivisionByZero);
}

BOOST_AUTO_TEST_CASE(eigen_multiplies_matrices_of_any_size) {
  const PrimeField::Modulus modulus(kPrime);
  using Matrix = Eigen::Matrix<PrimeField, Eigen::Dynamic, Eigen::Dynamic>;
  const int n = 40;  // beyond Eigen's small products
  Matrix a(n, n), b(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      a(i, j) = element(i, std::to_string(j));
      b(i, j) = element(j, std::to_string(i + n));
    }
  const Matrix product = a * b;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      PrimeField sum = 0;
      for (int k = 0; k < n; ++k) sum += a(i, k) * b(k, j);
      BOOST_REQUIRE((product(i, j) == sum));
    }
}

BOOST_AUTO_TEST_CASE(dual_numbers_over_the_field_differentiate) {
  const PrimeField::Modulus modulus(kPrime);
  const PrimeField x = element(1, "x");
  const Dual<PrimeField> d{x, 1};
  const Dual<PrimeField> f = d * d * d / (d + Dual<PrimeField>(2));  // x^3 / (x + 2)
  const PrimeField below = x + PrimeField(2);
  BOOST_TEST((f.derivative == (PrimeField(3) * x * x * below - x * x * x) / (below * below)));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(primes)

BOOST_AUTO_TEST_CASE(only_primes_of_the_right_kind_are_moduli) {
  for (const std::uint64_t wrong :
       {std::uint64_t(0), std::uint64_t(7), kPrime - 2,
        (std::uint64_t(1) << 62) + 1,             // a multiple of 5
        std::uint64_t(18446744073709551557u)}) {  // the largest below 2^64
    const bool right = wrong >> 61 != 0 && wrong >> 63 == 0 && wrong % 4 == 3 && n_is_prime(wrong);
    BOOST_REQUIRE(!right);
    BOOST_CHECK_THROW(PrimeField::Modulus{wrong}, std::invalid_argument);
  }
  BOOST_TEST(n_is_prime(kPrime) == 1);
  BOOST_TEST(kPrime % 4 == 3u);
}

BOOST_AUTO_TEST_CASE(the_outer_modulus_comes_back) {
  const PrimeField::Modulus outer(kPrime);
  const std::uint64_t other = drawPrime("test", 1, 0);
  {
    const PrimeField::Modulus inner(other);
    BOOST_TEST(PrimeField::modulus() == other);
  }
  BOOST_TEST(PrimeField::modulus() == kPrime);
}

BOOST_AUTO_TEST_CASE(drawn_primes_are_primes_in_range_and_differ) {
  std::set<std::uint64_t> drawn;
  for (int index = 0; index < 200; ++index) {
    const std::uint64_t p = drawPrime("test", 1, index);
    BOOST_TEST(n_is_prime(p) == 1);
    BOOST_TEST(p % 4 == 3u);
    BOOST_TEST(static_cast<double>(p) >= kSmallestPrime);
    BOOST_TEST(p >> 63 == 0u);
    BOOST_TEST(p == drawPrime("test", 1, index));
    drawn.insert(p);
  }
  BOOST_TEST(drawn.size() == 200u);
}

BOOST_AUTO_TEST_CASE(as_many_primes_are_drawn_from_as_stated) {
  // the share of primes among 40 000 random numbers = 3 mod 4 between 2^62 and 2^63, times their
  // count 2^60; the share is close to 2 / log(2^62.5) = 0.0462, so its standard deviation is 2.3 %
  RandomStream random("share of primes", 1, 0);
  int primes = 0;
  for (int k = 0; k < 40000; ++k)
    primes += n_is_prime((std::uint64_t(1) << 62) | (random.next() >> 2) | 3);
  const double estimate = primes / 40000.0 * 0x1p60;
  BOOST_TEST_MESSAGE("primes to draw from, estimated: " << estimate);
  BOOST_TEST(estimate > kPrimesDrawnFrom * 0.95);
  BOOST_TEST(estimate < kPrimesDrawnFrom * 1.2);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(numbers_of_a_scene)

BOOST_AUTO_TEST_CASE(angles_are_points_of_the_circle) {
  const PrimeField::Modulus modulus(kPrime);
  for (const char* text :
       {"0.3", "-2", "pi/3", "pi/4", "0.1 + pi/3", "100", "pi/2", "1000000*pi"}) {
    const auto p = angle(text);
    BOOST_TEST((p.c * p.c + p.s * p.s == PrimeField(1)), text);
  }
}

BOOST_AUTO_TEST_CASE(quarter_turns_are_exact) {
  const PrimeField::Modulus modulus(kPrime);
  BOOST_TEST(same(angle("0"), {1, 0}));
  BOOST_TEST(same(angle("pi/2"), {0, 1}));
  BOOST_TEST(same(angle("-pi/2"), {0, -1}));
  BOOST_TEST(same(angle("7*pi"), {-1, 0}));
}

BOOST_AUTO_TEST_CASE(equal_angles_up_to_sign_and_quarter_turns_share_a_point) {
  const PrimeField::Modulus modulus(kPrime);
  for (const char* text :
       {"0.3", "-0.3", "pi/3", "pi/4", "-pi/4", "-3*pi/4", "0.2 - pi/3", "5*pi/7"}) {
    const std::string a = text;
    const auto p = angle(text);
    BOOST_TEST(same(angle(("2*(" + a + ")/2").c_str()), p), text);
    BOOST_TEST(same(angle(("-(" + a + ")").c_str()), {p.c, -p.s}), text);
    BOOST_TEST(same(angle(("0 - (" + a + ")").c_str()), {p.c, -p.s}), text);
    BOOST_TEST(same(angle((a + " + 2*pi").c_str()), p), text);
    BOOST_TEST(same(angle((a + " - 6*pi").c_str()), p), text);
  }
  // quarter turns more or less; not for pi/4, whose point does not know that its c is its s
  for (const char* text : {"0.3", "-0.3", "pi/3", "0.2 - pi/3", "5*pi/7"}) {
    const std::string a = text;
    const auto p = angle(text);
    BOOST_TEST(same(angle((a + " + pi/2").c_str()), {-p.s, p.c}), text);
    BOOST_TEST(same(angle(("pi/2 - (" + a + ")").c_str()), {p.s, p.c}), text);
  }
  BOOST_TEST(!same(angle("0.3"), angle("0.4")));
  BOOST_TEST(!same(angle("0.3"), angle("0.3 + pi/3")));
}

BOOST_AUTO_TEST_CASE(axes_that_are_rational_are_exact) {
  const PrimeField::Modulus modulus(kPrime);
  using Axis = std::array<PrimeField, 3>;
  BOOST_TEST((direction({"0", "0", "2"}) == Axis{0, 0, 1}));
  BOOST_TEST((direction({"0", "0", "-2"}) == Axis{0, 0, -1}));
  BOOST_TEST((direction({"-3", "0", "0"}) == Axis{-1, 0, 0}));
  BOOST_TEST((direction({"0", "0.5", "0"}) == Axis{0, 1, 0}));
  const PrimeField fifth = PrimeField(5).inverse();
  BOOST_TEST((direction({"3", "0", "4"}) == Axis{PrimeField(3) * fifth, 0, PrimeField(4) * fifth}));
  BOOST_TEST((direction({"0", "-pi", "0"}) == Axis{0, -1, 0}));
}

BOOST_AUTO_TEST_CASE(parallel_axes_share_their_points) {
  const PrimeField::Modulus modulus(kPrime);
  const auto a = direction({"1", "2", "3"});
  BOOST_TEST((direction({"0.5", "1", "1.5"}) == a));
  const auto opposite = direction({"-1", "-2", "-3"});
  for (int i = 0; i < 3; ++i) BOOST_TEST((opposite[i] == -a[i]));
  BOOST_TEST((direction({"1", "2", "4"}) != a));
  BOOST_CHECK_THROW(direction({"0", "0", "0"}), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(random_parameters_replace_the_given_ones_wherever_they_occur) {
  const PrimeField::Modulus modulus(kPrime);
  scene::Mechanism mechanism;
  mechanism.parameters.push_back({"m", Number::parse("2"), {}});
  const Number doubled = Number::parse("2*m"), square = Number::parse("m^2");
  const FieldNumbers given = numbers(mechanism), random = numbers(mechanism, Parameters::kRandom);
  BOOST_TEST((given(doubled) == PrimeField(4)));
  BOOST_TEST((random(doubled) != PrimeField(4)));
  BOOST_TEST((random(doubled) * random(doubled) == PrimeField(4) * random(square)));
  BOOST_TEST((random(Number::parse("7/2")) == given(Number::parse("7/2"))));
}

BOOST_AUTO_TEST_CASE(points_are_functions_of_name_seed_and_index) {
  const PrimeField::Modulus modulus(kPrime);
  const PrimeField x = FieldSource("a", 1, 2).element("q");
  BOOST_TEST((x == FieldSource("a", 1, 2).element("q")));
  BOOST_TEST((x != FieldSource("b", 1, 2).element("q")));
  BOOST_TEST((x != FieldSource("a", 2, 2).element("q")));
  BOOST_TEST((x != FieldSource("a", 1, 3).element("q")));
  BOOST_TEST((x != FieldSource("a", 1, 2).element("qd")));
}

BOOST_AUTO_TEST_SUITE_END()
