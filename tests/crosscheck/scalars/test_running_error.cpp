// SPDX-License-Identifier: GPL-3.0-or-later
// A bound that bounds: every number is compared with the same expression in exact rationals.
#include "crosscheck/scalars/running_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/newton_euler.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using crosscheck::RunningError;
using crosscheck::RunningErrorNumbers;
using fixtures::Q;
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>,
                                           boost::multiprecision::et_off>;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double u = RunningError::kUnitRoundoff;

/// The same number three times: with its bound, in plain double, and exactly.
struct Triple {
  RunningError bounded;
  double plain;
  Q exact;
  int depth;
};

bool encloses(const RunningError& x, const Q& exact) {
  if (!std::isfinite(x.bound())) return true;  // nothing is claimed
  return std::isfinite(x.value()) && abs(Q(x.value()) - exact) <= Q(x.bound());
}
bool encloses(const RunningError& x, const Wide& exact) {
  return abs(Wide(x.value()) - exact) <= Wide(x.bound());
}

/// A double with 2^-range <= |x| < 2^range, and full of digits.
double randomDouble(fixtures::Sampler& sample, int range) {
  const double x = sample.uniform(1, 2) * (sample.pick(2) == 0 ? 1 : -1);
  return std::ldexp(x, sample.pick(2 * range) - range);
}

Triple randomLeaf(fixtures::Sampler& sample, int range) {
  const double x = randomDouble(sample, range);
  if (sample.pick(2) == 0) return {x, x, Q(x), 0};  // exact input
  // input known to a bound: the exact number is anywhere within it
  const double bound = std::ldexp(std::abs(x), -20 - sample.pick(40));
  return {{x, bound}, x, Q(x) + Q(bound) * Q(sample.pick(201) - 100) / Q(100), 0};
}

Triple combined(const Triple& a, const Triple& b, int operation) {
  const int depth = std::max(a.depth, b.depth) + 1;
  switch (operation) {
    case 0:
      return {a.bounded + b.bounded, a.plain + b.plain, a.exact + b.exact, depth};
    case 1:
      return {a.bounded - b.bounded, a.plain - b.plain, a.exact - b.exact, depth};
    case 2:
      return {a.bounded * b.bounded, a.plain * b.plain, a.exact * b.exact, depth};
    default:
      return {a.bounded / b.bounded, a.plain / b.plain, a.exact / b.exact, depth};
  }
}

/// Random expressions over a pool of numbers that grows; nearly equal operands come up on purpose.
struct Campaign {
  int checked = 0, wrong = 0, unbounded = 0, differs_from_double = 0;
  std::vector<double> excess;  ///< bound / true error

  void run(std::uint64_t seed, int range) {
    fixtures::Sampler sample(seed);
    std::vector<Triple> pool;
    for (int i = 0; i < 6; ++i) pool.push_back(randomLeaf(sample, range));
    for (int step = 0; step < 60; ++step) {
      const Triple a = pool[static_cast<std::size_t>(sample.pick(static_cast<int>(pool.size())))];
      Triple b = pool[static_cast<std::size_t>(sample.pick(static_cast<int>(pool.size())))];
      if (sample.pick(4) == 0) {  // a again with its last bits changed: cancellation
        const double near = a.bounded.value() * (1 + sample.pick(64) * 2 * u);
        b = {near, near, Q(near), 0};
      }
      const int operation = sample.pick(4);
      if (a.depth > 4 || b.depth > 4 || (operation == 3 && b.exact == 0)) continue;
      const Triple out = combined(a, b, operation);
      ++checked;
      if (!encloses(out.bounded, out.exact)) ++wrong;
      if (out.bounded.value() != out.plain && !std::isnan(out.plain)) ++differs_from_double;
      if (!std::isfinite(out.bounded.bound()) || !std::isfinite(out.plain)) {
        ++unbounded;
        continue;
      }
      const double error = abs(Q(out.plain) - out.exact).toDouble();
      if (error > 0) excess.push_back(out.bounded.bound() / error);
      pool.push_back(out);
    }
  }
};

/// Rounds what RationalNumbers gives, so that sweeps on double and on rationals see one mechanism.
class RoundedRationals {
 public:
  using Scalar = RunningError;
  explicit RoundedRationals(const scene::Mechanism& mechanism) : exact_(mechanism) {}

  static RunningError rounded(const Q& exact) {
    const double value = exact.toDouble();
    return {value, Q(value) == exact ? 0 : 2 * u * std::abs(value)};
  }
  static scene::CosSin<RunningError> rounded(const scene::CosSin<Q>& p) {
    return {rounded(p.c), rounded(p.s)};
  }
  RunningError operator()(const scene::Number& number) const { return rounded(exact_(number)); }
  scene::CosSin<RunningError> angle(const scene::Number& a) const {
    return rounded(exact_.angle(a));
  }
  scene::AxisTurn<RunningError> axisTurn(const scene::Vector& axis) const {
    const scene::AxisTurn<Q> turn = exact_.axisTurn(axis);
    return {rounded(turn.alpha), rounded(turn.beta)};
  }

 private:
  fixtures::RationalNumbers exact_;
};

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(operations_that_round_nothing_have_no_bound) {
  const RunningError x = 0.1;
  for (const RunningError& y :
       {x + 0.0, 0.0 + x, x - 0.0, x * 4.0, 0.25 * x, x * -1.0, x * 0.0, x / 8.0, -x, abs(-x)})
    BOOST_TEST(y.bound() == 0);
  BOOST_TEST((x * 3.0).bound() > 0);  // and one that rounds has one
}

// By hand: fl(0.1 + 0.2) is off by half an ulp of 0.3 at most, 2^-54 before rounding up.
BOOST_AUTO_TEST_CASE(one_rounding_is_bounded_by_half_an_ulp) {
  const RunningError sum = RunningError(0.1) + RunningError(0.2);
  BOOST_TEST(sum.value() == 0.1 + 0.2);
  BOOST_TEST(sum.bound() >= 0x1p-55);
  BOOST_TEST(sum.bound() <= u * 0.3 * (1 + 1e-9));
}

BOOST_AUTO_TEST_CASE(a_divisor_that_may_be_zero_gives_no_bound) {
  BOOST_TEST((RunningError(1) / RunningError(0.5, 0.5)).bound() == kInfinity);
  BOOST_TEST((RunningError(1) / RunningError(-0.5, 0.5)).bound() == kInfinity);
  BOOST_TEST((RunningError(1) / RunningError(0)).bound() == kInfinity);
  BOOST_TEST((RunningError(1) / RunningError(0.5, 0.4999)).bound() < kInfinity);
  BOOST_TEST(sqrt(RunningError(0.5, 0.5)).bound() == kInfinity);
  BOOST_TEST(sqrt(RunningError(0.5, 0.4999)).bound() < kInfinity);
}

// Halving an odd number of the smallest subnormals rounds: 3 * 2^-1074 / 2 is no double.
BOOST_AUTO_TEST_CASE(a_power_of_two_rounds_where_numbers_are_subnormal) {
  const double odd = 3 * std::numeric_limits<double>::denorm_min();
  const Q half = Q(odd) / 2;
  BOOST_TEST(encloses(RunningError(odd) * RunningError(0.5), half));
  BOOST_TEST(encloses(RunningError(0.5) * RunningError(odd), half));
  BOOST_TEST(encloses(RunningError(odd) / RunningError(2.0), half));
}

// 2 * 2^1023 is no double either: infinity is not within 0 of it.
BOOST_AUTO_TEST_CASE(an_overflow_has_no_bound) {
  const RunningError big = std::ldexp(1.5, 1023);
  for (const RunningError& x :
       {big * RunningError(2.0), RunningError(2.0) * big, big / RunningError(0.5), big + big,
        big * RunningError(3.0), big / RunningError(0.3)})
    BOOST_TEST(!std::isfinite(x.bound()));
}

// 0 +- 3 times 2^-10 +- 0, in units of the smallest double: the product may be 3 * 2^-1084, and a
// bound that underflows to 0 would deny it.
BOOST_AUTO_TEST_CASE(a_bound_does_not_underflow_to_nothing) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  const Q exact = Q(3) * Q(tiny) * Q(0x1p-10);
  BOOST_TEST(encloses(RunningError(0, 3 * tiny) * RunningError(0x1p-10), exact));
  BOOST_TEST(encloses(RunningError(0x1p-10) * RunningError(0, 3 * tiny), exact));
  BOOST_TEST(encloses(RunningError(0, 3 * tiny) / RunningError(0x1p+10), exact));
}

// cos 1e-9 = 1 - 5e-19 is returned as 1: rounded, so it has a bound. cos 0 = 1 has none.
BOOST_AUTO_TEST_CASE(the_cosine_of_a_small_angle_is_not_exactly_one) {
  const RunningError c = crosscheck::runningErrorPosition(1e-9).c;
  BOOST_TEST(c.value() == 1);
  BOOST_TEST(encloses(c, Wide(cos(Wide(1e-9)))));
  BOOST_TEST(crosscheck::runningErrorPosition(0).c.bound() == 0);
  BOOST_TEST(crosscheck::runningErrorPosition(0).s.bound() == 0);
}

// Of a scene's numbers: 1/8 is a double and 1/10 is none.
BOOST_AUTO_TEST_CASE(a_scene_s_numbers_carry_the_distance_to_the_double) {
  const scene::Mechanism none;
  const RunningErrorNumbers number(none);
  BOOST_TEST(number(scene::Number::parse("0.125")).bound() == 0);
  const RunningError tenth = number(scene::Number::parse("0.1"));
  BOOST_TEST(tenth.value() == 0.1);
  BOOST_TEST(encloses(tenth, Q(1) / 10));
  BOOST_TEST(tenth.bound() > 0);
  for (const char* right : {"0", "pi/2", "-pi/2", "pi", "7*pi/2"}) {
    const auto point = number.angle(scene::Number::parse(right));
    BOOST_TEST(point.c.bound() + point.s.bound() == 0);
    BOOST_TEST(std::abs(point.c.value()) + std::abs(point.s.value()) == 1);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// Ranges: numbers of the size of ours; and so small that products underflow to subnormals.
BOOST_DATA_TEST_CASE(the_bound_encloses_the_exact_value_of_random_expressions,
                     data::xrange(40) * data::make({3, 30, 700}), seed, range) {
  Campaign campaign;
  campaign.run(static_cast<std::uint64_t>(seed), range);
  BOOST_TEST(campaign.checked > 10);
  BOOST_TEST(campaign.wrong == 0);
  BOOST_TEST(campaign.differs_from_double == 0);
}

// Not absurdly large. Measured over these 200 seeds: 99.3 % of the operations have a finite bound
// (the rest divide by what may be zero), which is 3.1 times the true error in the median and 25
// times at 90 %.
BOOST_AUTO_TEST_CASE(the_bound_stays_near_the_error) {
  Campaign campaign;
  for (std::uint64_t seed = 0; seed < 200; ++seed) campaign.run(seed, 3);
  std::sort(campaign.excess.begin(), campaign.excess.end());
  const double median = campaign.excess[campaign.excess.size() / 2];
  BOOST_TEST_MESSAGE("operations " << campaign.checked << ", without bound " << campaign.unbounded
                                   << ", median bound/error " << median << ", at 90 % "
                                   << campaign.excess[campaign.excess.size() * 9 / 10]);
  BOOST_TEST(campaign.excess.front() >= 1 - 1e-9);  // (error itself is rounded here)
  BOOST_TEST(median < 6);
  BOOST_TEST(campaign.unbounded < campaign.checked / 50);
}

// The textbook's a-priori bound (Higham, section 3.1): |fl(x'y) - x'y| <= gamma_n |x|'|y|,
// gamma_n = n u / (1 - n u). The running bound sees the actual sizes and must not exceed it.
BOOST_DATA_TEST_CASE(an_inner_product_is_bounded_no_worse_than_in_the_textbook, data::xrange(20),
                     seed) {
  constexpr int n = 100;
  fixtures::Sampler sample(seed);
  RunningError sum = 0;
  Q exact = 0, sizes = 0;
  for (int i = 0; i < n; ++i) {
    const double x = randomDouble(sample, 10), y = randomDouble(sample, 10);
    sum += RunningError(x) * RunningError(y);
    exact += Q(x) * Q(y);
    sizes += abs(Q(x) * Q(y));
  }
  BOOST_TEST(encloses(sum, exact));
  const double gamma = n * u / (1 - n * u);
  BOOST_TEST(Q(sum.bound()) <= Q(gamma) * sizes * (Q(1) + Q(1000 * u)));
}

// Square roots: (r - bound)^2 <= x <= (r + bound)^2, in rationals.
BOOST_DATA_TEST_CASE(the_bound_encloses_square_roots, data::xrange(50), seed) {
  fixtures::Sampler sample(seed);
  const Triple x = randomLeaf(sample, 40);
  const RunningError root = sqrt(abs(x.bounded));
  const Q below = Q(root.value()) - Q(root.bound()), above = Q(root.value()) + Q(root.bound());
  BOOST_TEST(root.value() == std::sqrt(std::abs(x.plain)));
  BOOST_TEST(below * below <= abs(x.exact));
  BOOST_TEST(above * above >= abs(x.exact));
}

// cos and sin against 100 digits; large angles, and doubles beside multiples of pi/2 where the
// cosine is nearly all cancellation.
BOOST_DATA_TEST_CASE(the_bound_encloses_cosine_and_sine, data::xrange(50), seed) {
  fixtures::Sampler sample(seed);
  std::vector<double> angles = {randomDouble(sample, 10), randomDouble(sample, 3), seed * M_PI_2,
                                std::nextafter(seed * M_PI_2, 1e9)};
  for (const double q : angles) {
    const auto x = crosscheck::runningErrorPosition(q);
    BOOST_TEST(x.q.value() == q);
    BOOST_TEST(x.q.bound() == 0);
    BOOST_TEST(encloses(x.c, Wide(cos(Wide(q)))));
    BOOST_TEST(encloses(x.s, Wide(sin(Wide(q)))));
    BOOST_TEST(x.c.bound() <= 2 * u);  // never more than an ulp of 1
  }
}

// Fixed angles and axes of a scene against 100 digits.
BOOST_DATA_TEST_CASE(the_bound_encloses_a_scene_s_angles_and_axes, data::xrange(20), seed) {
  fixtures::Sampler sample(seed);
  const scene::Mechanism none;
  const RunningErrorNumbers number(none);
  const std::string spelled = "pi*" + std::to_string(1 + sample.pick(40)) + "/" +
                              std::to_string(3 + 2 * sample.pick(20)) + " + 0." +
                              std::to_string(1 + sample.pick(997));
  const scene::Exact exact = scene::exactValue(scene::Number::parse(spelled), {});
  const Wide angle = scene::fromExact<Wide>(exact);
  const auto point = number.angle(scene::Number::parse(spelled));
  BOOST_TEST(encloses(point.c, Wide(cos(angle))));
  BOOST_TEST(encloses(point.s, Wide(sin(angle))));

  const bool flat = seed % 3 == 0, in_plane = seed % 3 == 1;
  const Q x = sample.rational() / 3, y = in_plane ? Q(0) : sample.rational() / 7,
          z = flat ? Q(0) : sample.rational() / 11;
  const auto turn =
      number.axisTurn({fixtures::numberOf(x), fixtures::numberOf(y), fixtures::numberOf(z)});
  const auto wide = [](const Q& q) {
    return Wide(numerator(q.rational())) / Wide(denominator(q.rational()));
  };
  const Wide rho = sqrt(wide(x * x + y * y)), length = sqrt(wide(x * x + y * y + z * z));
  BOOST_TEST(encloses(turn.alpha.c, Wide(wide(x) / rho)));
  BOOST_TEST(encloses(turn.alpha.s, Wide(wide(y) / rho)));
  BOOST_TEST(encloses(turn.beta.c, Wide(wide(z) / length)));
  BOOST_TEST(encloses(turn.beta.s, Wide(rho / length)));
}

// What the limits of the crosscheck rest on: the bounds of whole sweeps, against the sweeps on
// rationals.
BOOST_DATA_TEST_CASE(the_bounds_of_the_sweeps_enclose_the_truth, data::xrange(10), seed) {
  constexpr int n = 6;
  const scene::Mechanism m = fixtures::randomTree(n, seed).mechanism;
  const scene::State<Q> state = fixtures::randomState(n, seed);
  const auto truth = recursive::buildModel(m, fixtures::RationalNumbers(m));
  const auto model = recursive::buildModel(m, RoundedRationals(m));
  recursive::Workspace<Q> truth_ws(truth);
  recursive::Workspace<RunningError> ws(model);

  const auto rounded = [](const std::vector<Q>& v) {
    std::vector<RunningError> out;
    for (const Q& x : v) out.push_back(RoundedRationals::rounded(x));
    return out;
  };
  std::vector<scene::JointPosition<RunningError>> x;
  for (const auto& p : state.x)
    x.push_back({RoundedRationals::rounded(p.q), RoundedRationals::rounded(p.c),
                 RoundedRationals::rounded(p.s)});

  std::vector<Q> tau(n), qdd(n);
  std::vector<RunningError> tau_bounded(n), qdd_bounded(n);
  recursive::inverseDynamics(truth, state.x, state.qd, state.qdd, truth_ws, tau);
  recursive::inverseDynamics(model, x, rounded(state.qd), rounded(state.qdd), ws, tau_bounded);
  recursive::forwardDynamics(truth, state.x, state.qd, state.tau, truth_ws, qdd);
  recursive::forwardDynamics(model, x, rounded(state.qd), rounded(state.tau), ws, qdd_bounded);
  recursive::MatrixX<Q> M(n, n);
  recursive::MatrixX<RunningError> M_bounded(n, n);
  recursive::massMatrix(truth, state.x, truth_ws, M);
  recursive::massMatrix(model, x, ws, M_bounded);
  double largest_bound = 0;  // of tau, relative
  for (std::size_t i = 0; i < n; ++i) {
    BOOST_TEST(encloses(tau_bounded[i], tau[i]));
    BOOST_TEST(encloses(qdd_bounded[i], qdd[i]));
    BOOST_TEST(std::isfinite(qdd_bounded[i].bound()));
    largest_bound =
        std::max(largest_bound, tau_bounded[i].bound() / std::abs(tau_bounded[i].value()));
    for (std::size_t j = 0; j < n; ++j) {
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
      BOOST_TEST(encloses(M_bounded(a, b), M(a, b)));
    }
  }
  // useful as a limit: ten digits of tau and more (measured on these seeds: 7e-12 at most)
  BOOST_TEST_MESSAGE("relative bound of tau: " << largest_bound);
  BOOST_TEST(largest_bound < 1e-10);
}

BOOST_AUTO_TEST_SUITE_END()
