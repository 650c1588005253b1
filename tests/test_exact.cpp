// SPDX-License-Identifier: GPL-3.0-or-later
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE exact
#include "crosscheck/exact.hpp"

#include <cmath>
#include <ctime>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/identities.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

DegreeBound x() { return DegreeBound::indeterminate(1); }

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) names.push_back(file.stem().string());
  return names;
}

void requireAllZero(const std::vector<CheckResult>& checks) {
  BOOST_TEST(checks.size() == 11u + kIdentityCount);
  for (const CheckResult& check : checks) {
    BOOST_TEST_CONTEXT(check.check << " " << check.quantity << " " << check.left << " "
                                   << check.right << " " << check.reason) {
      BOOST_TEST((check.verdict == Verdict::kAgree));
      BOOST_TEST_REQUIRE(check.exact.has_value());
      BOOST_TEST(check.exact->residual_zero);
      BOOST_TEST(check.exact->points >= 1);
      BOOST_TEST(check.exact->discarded == 0);
      BOOST_TEST(check.exact->error_probability <= 1e-30);
      BOOST_TEST(check.states == check.exact->points);
    }
  }
}

/// The degree in u of values at u = 0, 1, 2, ...: the last difference that is not zero.
int degreeOf(std::vector<PrimeField> values) {
  int degree = 0;
  for (int order = 0; values.size() > 1; ++order) {
    if (values[0] != PrimeField(0)) degree = order;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) values[i] = values[i + 1] - values[i];
    values.pop_back();
  }
  BOOST_REQUIRE((values[0] == PrimeField(0)));  // otherwise there were too few values
  return degree;
}

/** State number u on a curve on which elements have degree 1 in u, and c and s degree 2: then what is
    a polynomial has its weighted degree in u. */
scene::State<PrimeField> onCurve(const scene::Mechanism& mechanism, int u) {
  const auto value = [u](const scene::State<PrimeField>& start, const auto& member) {
    return member(start) + PrimeField(u);
  };
  const scene::State<PrimeField> start =
      indeterminateState(mechanism, FieldSource("curve", 1, 0));
  const scene::State<PrimeField> slope = indeterminateState(mechanism, FieldSource("curve", 1, 1));
  (void)value;
  const auto linear = [u](PrimeField a, PrimeField b) { return a + PrimeField(u) * b; };
  scene::State<PrimeField> state = start;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    state.x[i].q = linear(start.x[i].q, slope.x[i].q);
    state.x[i].c = linear(start.x[i].c, slope.x[i].c) * linear(start.x[i].s, slope.x[i].c);
    state.x[i].s = linear(start.x[i].s, slope.x[i].s) * linear(start.x[i].c, slope.x[i].s);
    state.qd[i] = linear(start.qd[i], slope.qd[i]);
    state.qdd[i] = linear(start.qdd[i], slope.qdd[i]);
  }
  return state;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(degree_bound)

BOOST_AUTO_TEST_CASE(a_product_of_k_inputs_has_degree_k) {
  const DegreeBound::Divisors divisors;
  DegreeBound product = 1;
  for (int k = 1; k <= 20; ++k) {
    product *= x();
    BOOST_TEST(product.degree() == k);
    BOOST_TEST(product.bits() == 0);
  }
  BOOST_TEST(divisors.totalDegree() == 0);
}

BOOST_AUTO_TEST_CASE(sums_take_the_larger_degree_and_zero_is_no_polynomial_of_any) {
  const DegreeBound::Divisors divisors;
  BOOST_TEST((x() * x() + x()).degree() == 2);
  BOOST_TEST((x() * DegreeBound(0) + x()).degree() == 1);
  BOOST_TEST((x() * DegreeBound(0)).isZero());
  BOOST_TEST((x() - x()).degree() == 1);  // another x: not zero
  BOOST_CHECK_THROW(x() / DegreeBound(0), DivisionByZero);
}

BOOST_AUTO_TEST_CASE(sums_of_coefficients_are_bounded) {
  const DegreeBound::Divisors divisors;
  const DegreeBound f = (x() + x()) * (x() + DegreeBound(1000));  // coefficients 1 1, 1 1000
  BOOST_TEST(f.bits() >= std::log2(2.0 * 1001));
  BOOST_TEST(f.bits() <= std::log2(2.0 * 1001) + 2);
  // 0.25 = 1/4: the common denominator of decimals is a power of 2 and 5
  const DegreeBound quarter = DegreeBound::constant(scene::Rational(1, 4));
  const DegreeBound sum = quarter + DegreeBound::constant(scene::Rational(3, 10));  // 11/20
  BOOST_TEST(sum.bits() >= std::log2(11.0));
  BOOST_TEST(sum.bits() <= std::log2(11.0) + 2);
}

BOOST_AUTO_TEST_CASE(fractions_with_the_same_divisor_share_it) {
  const DegreeBound::Divisors divisors;
  const DegreeBound d = x() * x() * x();
  DegreeBound sum = 0;
  for (int k = 0; k < 100; ++k) sum += x() / d;  // (x1 + ... + x100) / d
  BOOST_TEST(sum.degree() == 1);
  BOOST_TEST((sum - x()).degree() == 4);         // over d: (x1 + ...) - x d
  BOOST_TEST((sum * d).degree() == 1);           // and d cancels
  BOOST_TEST((sum * d - x()).degree() == 1);
  BOOST_TEST(divisors.totalDegree() == 3);
}

BOOST_AUTO_TEST_CASE(nested_fractions_multiply_out) {
  const DegreeBound::Divisors divisors;
  const DegreeBound a = x() / x();       // x1 / x2
  const DegreeBound b = a / (a + x());   // (x1 / x2) / ((x1 + x3 x2) / x2) = x1 / (x1 + x2 x3)
  BOOST_TEST(b.degree() == 1);
  BOOST_TEST((b - x()).degree() == 3);
  BOOST_TEST(divisors.totalDegree() == 1 + 2);
}

BOOST_DATA_TEST_CASE(it_bounds_the_degree_that_interpolation_measures,
                     data::make({"simple_pendulum", "double_pendulum", "cart_pole", "planar_3r",
                                 "modern_robotics_3link", "scara", "puma_560"}) *
                         data::make({0, 1, 2, 3, 4})) {
  const scene::Scene scene = scene::findScene(sample);
  const int choice = arity;
  (void)choice;
}

BOOST_AUTO_TEST_SUITE_END()
