// SPDX-License-Identifier: GPL-3.0-or-later
// Balls enclose: what they must contain comes from exact rationals and from Boost's decimal floats.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <boost/multiprecision/cpp_dec_float.hpp>

#include "crosscheck/scalars/ball.hpp"

using namespace dynwitness;
using crosscheck::Ball;
using crosscheck::BallNumbers;
using crosscheck::BallPrecision;
using scene::Rational;
using Decimal = boost::multiprecision::cpp_dec_float_100;
namespace data = boost::unit_test::data;

namespace {

Rational power(const Rational& base, int n) {
  Rational out = 1;
  for (int i = 0; i < n; ++i) out *= base;
  return out;
}

/// A scene without parameters: numbers are what they spell.
BallNumbers numbers() {
  return BallNumbers(scene::Mechanism{});
}
scene::Vector axis(const char* x, const char* y, const char* z) {
  return {scene::Expression::parse(x), scene::Expression::parse(y), scene::Expression::parse(z)};
}

bool isExactly(const Ball& ball, int value) {
  return ball.isExact() && ball.contains(value);
}

/// Whether the ball lies within 10^-90 of a decimal that is good to 100 digits, and is no wider.
bool isNear(const Ball& ball, const Decimal& value) {
  const BallPrecision precision(512);
  return (ball - Ball(static_cast<Rational>(value))).atMost() < 1e-90;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(integers_and_floating_point_numbers_are_exact) {
  const BallPrecision precision(8);  // too few bits for these numbers: they must not be rounded
  BOOST_TEST(isExactly(Ball(-12345), -12345));
  BOOST_TEST(Ball(0.1).isExact());
  BOOST_TEST(Ball(0.1).contains(Rational(0.1)));
  BOOST_TEST(!Ball(0.1).contains(Rational(1, 10)));
  const long double third = 1.0L / 3;
  BOOST_TEST(Ball(third).isExact());
  BOOST_TEST(Ball(third).contains(Rational(third)));
  BOOST_TEST(Ball(-std::numeric_limits<double>::denorm_min())
                 .contains(Rational(-std::numeric_limits<double>::denorm_min())));
  BOOST_TEST(!Ball(std::numeric_limits<double>::quiet_NaN()).isFinite());
  BOOST_TEST(!Ball(std::numeric_limits<double>::infinity()).isFinite());
}

BOOST_AUTO_TEST_CASE(rationals_are_enclosed_whatever_their_size) {
  const BallPrecision precision(64);
  for (const Rational& x : {Rational(1, 3), Rational(-22, 7), power(Rational(10, 3), 60),
                            -power(Rational(3, 10), 60)}) {
    BOOST_TEST(Ball(x).contains(x));
    BOOST_TEST(!Ball(x).isExact());
    BOOST_TEST(Ball(x).isSharp(60));
    BOOST_TEST(!Ball(x).contains(x * (1 + Rational(1, 1000000000))));
  }
  BOOST_TEST(isExactly(Ball(Rational(0)), 0));
  BOOST_TEST(isExactly(Ball(Rational(-7)), -7));
}

BOOST_AUTO_TEST_CASE(pi_and_roots_and_circle_points_agree_with_a_hundred_decimals) {
  const BallPrecision precision(400);
  BOOST_TEST(isNear(Ball::pi(), boost::math::constants::pi<Decimal>()));
  BOOST_TEST(isNear(sqrt(Ball(2)), sqrt(Decimal(2))));
  for (const double q : {0.7, -2.5, 3.0, 1e-8, 100.0}) {
    const scene::CosSin<Ball> point = cosSin(Ball(q));
    BOOST_TEST(isNear(point.c, cos(Decimal(q))));
    BOOST_TEST(isNear(point.s, sin(Decimal(q))));
  }
}

BOOST_AUTO_TEST_CASE(special_angles_enclose_their_exact_cosines) {
  const scene::CosSin<Ball> third = cosSin(Ball::pi() / Ball(3));
  BOOST_TEST(third.c.contains(Rational(1, 2)));
  BOOST_TEST((third.s * third.s).contains(Rational(3, 4)));
  BOOST_TEST((sqrt(Ball(2)) * sqrt(Ball(2))).contains(2));
  BOOST_TEST(isExactly(sqrt(Ball(9)), 3));
  BOOST_TEST(isExactly(abs(Ball(-3)), 3));
}

BOOST_AUTO_TEST_CASE(scene_numbers_are_enclosed_and_quarter_turns_exact) {
  const BallNumbers number = numbers();
  BOOST_TEST(number(scene::Expression::parse("0.4318")).contains(Rational(4318, 10000)));
  BOOST_TEST(isNear(number(scene::Expression::parse("1/3 - 2*pi")) * Ball(0), Decimal(0)));
  {
    const BallPrecision precision(400);
    BOOST_TEST(isNear(number(scene::Expression::parse("1/3 - 2*pi")),
                      Decimal(1) / 3 - 2 * boost::math::constants::pi<Decimal>()));
  }
  const scene::CosSin<Ball> quarter = number.angle(scene::Expression::parse("-pi/2"));
  BOOST_TEST(isExactly(quarter.c, 0));
  BOOST_TEST(isExactly(quarter.s, -1));
  BOOST_TEST(number.angle(scene::Expression::parse("pi/6")).s.contains(Rational(1, 2)));
}

BOOST_AUTO_TEST_CASE(axis_turns_take_z_to_the_axis) {
  const BallNumbers number = numbers();
  const auto image = [&](const scene::Vector& a) {  // Rz(alpha) Ry(beta) z
    const scene::AxisTurn<Ball> t = number.axisTurn(a);
    return std::array<Ball, 3>{t.alpha.c * t.beta.s, t.alpha.s * t.beta.s, t.beta.c};
  };
  const std::array<Ball, 3> oblique = image(axis("-1", "2", "2"));
  BOOST_TEST(oblique[0].contains(Rational(-1, 3)));
  BOOST_TEST(oblique[1].contains(Rational(2, 3)));
  BOOST_TEST(oblique[2].contains(Rational(2, 3)));
  const std::array<Ball, 3> planar = image(axis("0.6", "0", "-0.8"));
  BOOST_TEST(planar[0].contains(Rational(3, 5)));
  BOOST_TEST(isExactly(planar[1], 0));
  BOOST_TEST(planar[2].contains(Rational(-4, 5)));
  const std::array<Ball, 3> level = image(axis("0.3", "-0.4", "0"));
  BOOST_TEST(level[0].contains(Rational(3, 5)));
  BOOST_TEST(level[1].contains(Rational(-4, 5)));
  BOOST_TEST(isExactly(level[2], 0));
  // coordinate axes are exact, of whatever length
  for (int i = 0; i < 3; ++i) {
    for (const char* length : {"0.1", "-0.3"}) {
      scene::Vector a = axis("0", "0", "0");
      a[i] = scene::Expression::parse(length);
      const std::array<Ball, 3> along = image(a);
      for (int k = 0; k < 3; ++k)
        BOOST_TEST(isExactly(along[k], k != i ? 0 : length[0] == '-' ? -1 : 1));
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_DATA_TEST_CASE(operations_enclose_exact_rational_arithmetic, data::xrange(50), seed) {
  const BallPrecision precision(64);
  std::mt19937_64 random(static_cast<unsigned>(seed));
  const auto draw = [&] {
    const int top = static_cast<int>(random() % 1999) - 999;
    return Rational(top == 0 ? 1 : top, static_cast<int>(random() % 999) + 1);
  };
  Rational exact = draw();
  Ball ball(exact);
  for (int step = 0; step < 60; ++step) {
    const Rational r = draw();
    switch (random() % 6) {
      case 0:
        exact += r, ball += Ball(r);
        break;
      case 1:
        exact -= r, ball -= Ball(r);
        break;
      case 2:
        exact *= r, ball *= Ball(r);
        break;
      case 3:
        exact /= r, ball /= Ball(r);
        break;
      case 4:
        exact = -exact, ball = -ball;
        break;
      case 5:
        exact = exact * exact - r, ball = ball * ball - Ball(r);
        break;
    }
    BOOST_REQUIRE(ball.contains(exact));
    if (abs(exact) > 1000000 ||
        msb(denominator(exact)) > 1000) {  // before numbers grow out of hand
      exact = draw();
      ball = Ball(exact);
    }
  }
  BOOST_TEST(ball.isSharp(20));  // and not by being wide
}

BOOST_AUTO_TEST_CASE(bounds_are_rounded_outward) {
  for (const Rational& x : {Rational(1, 3), Rational(-2, 3), Rational(1, 1000003)}) {
    const Ball ball(x);
    BOOST_TEST((Rational(ball.atLeast()) <= abs(x)));
    BOOST_TEST((Rational(ball.atMost()) >= abs(x)));
    BOOST_TEST(ball.atMost() <= std::nextafter(ball.atLeast(), 1.0));
    BOOST_TEST(ball.mid() == x.convert_to<double>());
    BOOST_TEST(ball.radius() > 0);
    BOOST_TEST(ball.radius() < 1e-37);
  }
  const BallPrecision precision(2000);  // a radius that no double can hold
  BOOST_TEST(Ball(Rational(1, 3)).radius() > 0);
  BOOST_TEST(Ball(-5).atLeast() == 5);
  BOOST_TEST((Ball(1) - Ball(Rational(1, 3)) * Ball(3)).atLeast() == 0);
}

BOOST_AUTO_TEST_CASE(more_bits_narrow_a_ball_and_the_scope_ends) {
  const long outside = BallPrecision::bits();
  double last = 1;
  for (const long bits : {64, 128, 256, 512}) {
    const BallPrecision precision(bits);
    BOOST_TEST(BallPrecision::bits() == bits);
    const Ball x = cosSin(Ball(1)).c / Ball(7);
    BOOST_TEST(x.isSharp(bits - 8));
    BOOST_TEST(!x.isSharp(bits + 8));
    BOOST_TEST(x.radius() < last * 1e-15);
    last = x.radius();
  }
  BOOST_TEST(BallPrecision::bits() == outside);
}

BOOST_AUTO_TEST_CASE(circle_points_lie_on_the_circle) {
  const scene::State<double> state{
      {scene::jointPosition(2.5), scene::jointPosition(-0.25)}, {0.1, 0.2}, {0.3, 0.4}, {0.5, 0.6}};
  const scene::State<Ball> balls = crosscheck::ballState(state);
  for (std::size_t i = 0; i < 2; ++i) {
    const scene::JointPosition<Ball>& x = balls.x[i];
    BOOST_TEST(x.q.contains(Rational(state.x[i].q)));
    BOOST_TEST((x.c * x.c + x.s * x.s).contains(1));
    BOOST_TEST(std::abs(x.c.mid() - state.x[i].c) < 1e-15);
    BOOST_TEST(balls.qd[i].contains(Rational(state.qd[i])));
    BOOST_TEST(balls.qdd[i].contains(Rational(state.qdd[i])));
    BOOST_TEST(balls.tau[i].contains(Rational(state.tau[i])));
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(division_by_a_ball_with_zero_in_it_is_not_finite) {
  const Ball zero_within = Ball(1) - Ball(Rational(1, 3)) * Ball(3);
  BOOST_TEST(zero_within.containsZero());
  BOOST_TEST(!zero_within.isZero());
  BOOST_TEST(!(Ball(1) / zero_within).isFinite());
  BOOST_TEST(!(Ball(1) / Ball(0)).isFinite());
  BOOST_TEST(!(Ball(1) / zero_within).isSharp(1));
  BOOST_TEST(!sqrt(Ball(-1)).isFinite());
}

BOOST_AUTO_TEST_CASE(an_axis_of_no_length_is_refused) {
  BOOST_CHECK_EXCEPTION(numbers().axisTurn(axis("0", "0", "0")), std::invalid_argument,
                        [](const std::exception& e) {
                          return std::string(e.what()).find("non-zero vector") != std::string::npos;
                        });
}

BOOST_AUTO_TEST_SUITE_END()
