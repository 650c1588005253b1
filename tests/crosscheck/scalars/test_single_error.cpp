// SPDX-License-Identifier: GPL-3.0-or-later
// The bound of a float bounds: operations and sweeps against exact rationals, bundled scenes
// against balls, and the numbers are those of a sweep on plain floats.
#include "crosscheck/scalars/single_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/chart/methods.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/single_precision.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Q;

namespace {

constexpr double kUnit = std::numeric_limits<float>::epsilon() / 2.0;

bool encloses(const SingleError& x, const Q& exact) {
  if (!std::isfinite(x.bound())) return true;  // nothing is claimed
  return abs(Q(static_cast<double>(x.value())) - exact) <= Q(x.bound());
}

/// Rounds what RationalNumbers gives, so that sweeps on float and on rationals see one mechanism.
class RoundedRationals {
 public:
  using Scalar = SingleError;
  explicit RoundedRationals(const scene::Mechanism& mechanism) : exact_(mechanism) {}

  static SingleError rounded(const Q& exact) {  // Q::toDouble() is within an ulp
    const double x = exact.toDouble();
    return {static_cast<float>(x),
            RunningError(x, std::numeric_limits<double>::epsilon() * std::abs(x))};
  }
  static scene::CosSin<SingleError> rounded(const scene::CosSin<Q>& p) {
    return {rounded(p.c), rounded(p.s)};
  }
  static std::vector<SingleError> rounded(const std::vector<Q>& v) {
    std::vector<SingleError> out;
    for (const Q& x : v) out.push_back(rounded(x));
    return out;
  }
  SingleError operator()(const scene::Number& number) const { return rounded(exact_(number)); }
  scene::CosSin<SingleError> angle(const scene::Number& a) const {
    return rounded(exact_.angle(a));
  }
  scene::AxisTurn<SingleError> axisTurn(const scene::Vector& axis) const {
    const scene::AxisTurn<Q> turn = exact_.axisTurn(axis);
    return {rounded(turn.alpha), rounded(turn.beta)};
  }

 private:
  fixtures::RationalNumbers exact_;
};

scene::State<SingleError> rounded(const scene::State<Q>& state) {
  scene::State<SingleError> out;
  for (const auto& p : state.x)
    out.x.push_back({RoundedRationals::rounded(p.q), RoundedRationals::rounded(p.c),
                     RoundedRationals::rounded(p.s)});
  out.qd = RoundedRationals::rounded(state.qd);
  out.qdd = RoundedRationals::rounded(state.qdd);
  out.tau = RoundedRationals::rounded(state.tau);
  return out;
}

/// What bounds are beside the errors that they are of.
struct Excess {
  int wrong = 0, unbounded = 0;
  std::vector<double> of;

  void see(double value, double bound, double error) {
    if (!std::isfinite(bound)) {
      ++unbounded;
      return;
    }
    if (error > bound) ++wrong;
    if (error > 0 && value != 0) of.push_back(bound / error);
  }
  double median() {
    std::nth_element(of.begin(), of.begin() + of.size() / 2, of.end());
    return of[of.size() / 2];
  }
};

template <typename Algorithm>
void sweepsAreEnclosed(Quantity quantity, int seed, Excess* excess) {
  constexpr int n = 5;
  const scene::Mechanism m = fixtures::randomTree(n, seed).mechanism;
  const scene::State<Q> state = fixtures::randomState(n, seed);
  Setup<Q> truth(m, fixtures::RationalNumbers(m));
  Setup<SingleError> setup(m, RoundedRationals(m));
  const MatrixX<Q> exact = Algorithm::answer(truth, quantity, state);
  const MatrixX<SingleError> found = Algorithm::answer(setup, quantity, rounded(state));
  for (Eigen::Index k = 0; k < exact.size(); ++k) {
    const SingleError& x = found.data()[k];
    BOOST_TEST(encloses(x, exact.data()[k]), name(quantity) << " " << k << ": " << x.value()
                                                            << " +- " << x.bound() << ", right "
                                                            << exact.data()[k].toDouble());
    excess->see(x.value(), x.bound(),
                abs(Q(static_cast<double>(x.value())) - exact.data()[k]).toDouble());
  }
}

}  // namespace

// By hand: 0.1f is off 0.1 by 1.49e-9, and 0.1f + 0.2f is 0.3 rounded up, 1.19e-8 above.
BOOST_AUTO_TEST_CASE(what_one_rounding_moves_is_known_to_the_last_digit) {
  const SingleError tenth = 0.1, fifth = 0.2, sum = tenth + fifth;
  BOOST_TEST(tenth.value() == 0.1f);
  BOOST_TEST(tenth.bound() >= std::abs(0.1f - 0.1));
  BOOST_TEST(tenth.bound() <= std::abs(0.1f - 0.1) * (1 + 1e-12));
  BOOST_TEST(sum.value() == 0.1f + 0.2f);
  BOOST_TEST(encloses(sum, Q(scene::Rational(3, 10))));
  BOOST_TEST(sum.bound() < 2 * kUnit * 0.3);
  BOOST_TEST((SingleError(0.5) + SingleError(0.25)).bound() < 1e-15);  // no float has moved
  const SingleError half = SingleError(1.0 / 3) * 0.5;
  BOOST_TEST(half.bound() <= SingleError(1.0 / 3).bound() * 0.5 * (1 + 1e-7));
}

BOOST_AUTO_TEST_CASE(what_leaves_the_range_of_floats_has_the_bound_of_that) {
  const SingleError big = 3e38, tiny = 1e-38;
  BOOST_TEST(std::isinf((big + big).value()));
  BOOST_TEST(!std::isfinite((big + big).bound()));
  BOOST_TEST(!std::isfinite((SingleError(1) / (big * big)).bound()));
  const SingleError nothing = tiny * tiny;  // 1e-76 is 0 as a float
  BOOST_TEST(nothing.value() == 0);
  BOOST_TEST(nothing.bound() >= 0.99e-76);
  BOOST_TEST(!std::isfinite((SingleError(1) / nothing).bound()));  // 1e76, and not 1/0
}

// Random expressions over a pool that grows; nearly equal operands come up on purpose.
// Measured: the bound is 2.1 times the error in the median.
BOOST_AUTO_TEST_CASE(the_bound_encloses_the_exact_value_of_random_expressions) {
  struct Pair {
    SingleError x;
    Q exact;
  };
  int checked = 0;
  Excess excess;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    fixtures::Sampler sample(seed);
    std::vector<Pair> pool;
    for (int k = 0; k < 6; ++k) {
      const double x = std::ldexp(sample.uniform(1, 2), sample.pick(8) - 4);
      pool.push_back({SingleError(x), Q(x)});
    }
    for (int step = 0; step < 30; ++step) {
      const Pair a = pool[static_cast<std::size_t>(sample.pick(static_cast<int>(pool.size())))];
      Pair b = pool[static_cast<std::size_t>(sample.pick(6))];
      if (sample.pick(4) == 0) {
        const double near = a.x.value() * (1 + sample.pick(64) * kUnit);
        b = {SingleError(near), Q(near)};
      }
      Pair out;
      switch (sample.pick(4)) {
        case 0:
          out = {a.x + b.x, a.exact + b.exact};
          break;
        case 1:
          out = {a.x - b.x, a.exact - b.exact};
          break;
        case 2:
          out = {a.x * b.x, a.exact * b.exact};
          break;
        default:
          if (b.exact == 0) continue;
          out = {a.x / b.x, a.exact / b.exact};
      }
      ++checked;
      BOOST_TEST(encloses(out.x, out.exact));
      if (!std::isfinite(out.x.bound())) continue;
      excess.see(out.x.value(), out.x.bound(),
                 abs(Q(static_cast<double>(out.x.value())) - out.exact).toDouble());
      if (pool.size() < 20) pool.push_back(out);
    }
  }
  BOOST_TEST(checked > 2500);
  BOOST_TEST_MESSAGE("bound over error, median " << excess.median());
  BOOST_TEST(excess.median() < 4);
}

// Random trees and states, as rationals and as floats of these. Measured: in the median the bound
// is 27 times the error of tau, 10 of M, 88 of qdd, and all of 200 qdd have one.
BOOST_AUTO_TEST_CASE(the_bounds_of_the_sweeps_enclose_the_exact_rationals) {
  Excess tau, M, qdd;
  for (int seed = 0; seed < 20; ++seed) {
    sweepsAreEnclosed<NewtonEuler>(Quantity::kTau, seed, &tau);
    sweepsAreEnclosed<CompositeBody>(Quantity::kM, seed, &M);
    sweepsAreEnclosed<CompositeBody>(Quantity::kQdd, seed, &qdd);
    sweepsAreEnclosed<ArticulatedBody>(Quantity::kQdd, seed, &qdd);
  }
  BOOST_TEST_MESSAGE("bound over error, median: tau "
                     << tau.median() << ", M " << M.median() << ", qdd " << qdd.median() << "; of "
                     << qdd.of.size() << " qdd without a bound " << qdd.unbounded);
  BOOST_TEST(qdd.unbounded == 0);
  BOOST_TEST(tau.median() < 54);
  BOOST_TEST(M.median() < 20);
  BOOST_TEST(qdd.median() < 180);
}

// The scenes' own numbers and states, whose cosines are those of the C library; the truth by balls.
// In gripper, joints follow others: their positions are rounded from what leader and multiplier
// give.
BOOST_DATA_TEST_CASE(bundled_scenes_in_float_are_what_floats_compute_and_within_their_bounds,
                     data::make({"double_pendulum", "cart_pole", "puma_560", "franka_panda",
                                 "heavy_top", "gripper"}),
                     scene_name) {
  const scene::Scene scene = scene::findScene(scene_name);
  const scene::Mechanism& m = scene.mechanism;
  Truth truth(m);
  const struct {
    const char* witness;
    Quantity quantity;
    Sweep sweep;
  } kinds[] = {{"newton_euler", Quantity::kTau, Sweep::kNewtonEuler},
               {"composite_body", Quantity::kM, Sweep::kCompositeBody},
               {"composite_body", Quantity::kQdd, Sweep::kCompositeBodySolved},
               {"articulated_body", Quantity::kQdd, Sweep::kArticulatedBody}};
  for (const auto& kind : kinds) {
    const SingleSweep sweep = sweepInSinglePrecision(kind.witness, m);
    BOOST_REQUIRE(sweep);
    Excess excess;
    for (int k = 0; k < 10; ++k) {
      const scene::State<double> state = drawState(m, scene.name, 1, k);
      const BallPrecision precision(256);
      const Answer said = sweep(kind.quantity, state);
      const auto plain = sweepInFloat(kind.sweep, m, {state});
      plain->run(0);
      const MatrixX<Ball> in_float = plain->answer();
      const Certified right = truth(kind.quantity, state);
      BOOST_REQUIRE(right.exists());
      for (Eigen::Index i = 0; i < said.value.size(); ++i) {
        const double x = said.value.data()[i], bound = said.bound.data()[i];
        BOOST_TEST(in_float.data()[i].mid() == x);
        const double error = abs(Ball(x) - right.value.data()[i]).mid();
        BOOST_TEST(error <= bound * (1 + 1e-12), name(kind.quantity)
                                                     << " " << i << ": " << x << " +- " << bound
                                                     << ", off by " << error);
        excess.see(x, bound, error);
      }
    }
    BOOST_TEST_MESSAGE(scene.name << " " << kind.witness << " " << name(kind.quantity)
                                  << ": bound over error, median "
                                  << (excess.of.empty() ? 0 : excess.median()) << ", unbounded "
                                  << excess.unbounded);
  }
}

BOOST_AUTO_TEST_CASE(others_than_sweeps_have_none) {
  BOOST_TEST(!sweepInSinglePrecision("lagrange", scene::findScene("cart_pole").mechanism));
}
