// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/dual.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using dynwitness::crosscheck::Dual;
using dynwitness::crosscheck::moving;
using dynwitness::fixtures::Q;
using dynwitness::fixtures::Sampler;
using D = Dual<Q>;

namespace {

constexpr int kSeeds = 10;

/// A rational function with every operation in it.
template <typename T>
T function(const T& x) {
  T y = x * x - T(3);
  y += T(1) / x;
  y -= x / (x * x + T(2));
  y *= -x + T(5);
  y /= x + T(20);
  return y;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand: d(x^n) = n x^(n-1), d(1/x) = -1/x^2, d(a/b) = (a' b - a b')/b^2.
BOOST_DATA_TEST_CASE(derivatives_are_those_of_calculus, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Q a = sample.rational(), da = sample.rational(), b = sample.rational(),
          db = sample.rational();
  const D x(a, da), y(b, db);
  BOOST_TEST((x + y).derivative == da + db);
  BOOST_TEST((x - y).derivative == da - db);
  BOOST_TEST((x * y).derivative == da * b + a * db);
  BOOST_TEST((x / y).derivative == (da * b - a * db) / (b * b));
  BOOST_TEST((-x).derivative == -da);
  BOOST_TEST((x * x * x).derivative == Q(3) * a * a * da);
  BOOST_TEST((D(1) / x).derivative == -da / (a * a));
  BOOST_TEST((x + y).value == a + b);
  BOOST_TEST((x - y).value == a - b);
  BOOST_TEST((x * y).value == a * b);
  BOOST_TEST((x / y).value == a / b);
  BOOST_TEST((-x).value == -a);
}

BOOST_AUTO_TEST_CASE(constants_do_not_move) {
  BOOST_TEST(D(7).derivative == 0);
  BOOST_TEST(D(Q(7)).derivative == 0);
  BOOST_TEST((D() == D(0)));
  BOOST_TEST((D(1) != D(Q(1), Q(1))));  // equal values, different motion
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// Exactly f(x + h) = f(x) + h f'(x) + O(h^2): the divided difference approaches the derivative at
// the rate of h, so its error halves (to 10 %) when a small h does.
BOOST_DATA_TEST_CASE(the_derivative_is_the_limit_of_divided_differences, data::xrange(kSeeds),
                     seed) {
  Sampler sample(seed);
  const Q x = sample.rational(), h = Q(1) / 1000000;
  const D y = function(D(x, Q(1)));
  BOOST_TEST(y.value == function(x));
  const Q coarse = (function(x + h) - function(x)) / h - y.derivative;
  const Q fine = (function(x + h / 2) - function(x)) / (h / 2) - y.derivative;
  BOOST_TEST(coarse != 0);
  BOOST_TEST(abs(coarse - Q(2) * fine) <= abs(coarse) / 10);
}

// Second derivatives by nesting; by hand (x^4)'' = 12 x^2, (1/x)'' = 2/x^3.
BOOST_DATA_TEST_CASE(duals_of_duals_differentiate_twice, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Q a = sample.rational();
  const Dual<D> x(D(a, Q(1)), D(Q(1), Q(0)));
  BOOST_TEST((x * x * x * x).derivative.derivative == Q(12) * a * a);
  BOOST_TEST((Dual<D>(1) / x).derivative.derivative == Q(2) / (a * a * a));
}

// A double reaches duals of duals whole: not by way of an int.
BOOST_AUTO_TEST_CASE(constants_keep_their_fractions) {
  using DD = Dual<Dual<double>>;
  BOOST_TEST(DD(0.75).value.value == 0.75);
  BOOST_TEST(DD(2).value.value == 2.0);
}

// The point stays on the circle, and turns at the rate qd: c c' + s s' = 0 and c s' - s c' = qd.
BOOST_DATA_TEST_CASE(a_moving_joint_stays_on_the_circle, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const auto point = sample.circle();
  const Q q = sample.rational(), qd = sample.rational();
  const auto x = moving(dynwitness::scene::JointPosition<Q>{q, point.c, point.s}, qd);
  BOOST_TEST((x.c * x.c + x.s * x.s == D(1)));
  BOOST_TEST(x.c.value * x.s.derivative - x.s.value * x.c.derivative == qd);
  BOOST_TEST(x.q.value == q);
  BOOST_TEST(x.q.derivative == qd);
}

BOOST_AUTO_TEST_SUITE_END()
