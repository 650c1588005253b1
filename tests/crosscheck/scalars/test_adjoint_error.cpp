// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds by what each rounding does to the result: proven, and not carried away by turns.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

using MatrixXA = MatrixX<AdjointError>;

double boundOf(const AdjointTape& tape, const AdjointError& x) {
  return tape.bounds(MatrixXA::Constant(1, 1, x))(0, 0);
}

/// |computed - exact| from above, the same expression being evaluated in balls.
template <typename Expression>
double errorOf(const Expression& expression, const std::vector<double>& x) {
  const BallPrecision precision(256);
  const std::vector<Ball> balls(x.begin(), x.end());
  return (Ball(expression(x)) - expression(balls)).atMost();
}

/// The bound of an expression of exact doubles.
template <typename Expression>
double boundOf(const Expression& expression, const std::vector<double>& x) {
  AdjointTape tape;
  const AdjointTape::Recording recording(tape);
  const std::vector<AdjointError> inputs(x.begin(), x.end());
  return boundOf(tape, expression(inputs));
}

/// Turns a vector k times by the same angle, and back as often, in the plane.
const auto turned = [](const auto& x) {
  auto a = x[0], b = x[1];
  for (int k = 0; k < 40; ++k) {
    const auto next = x[2] * a - x[3] * b;
    b = x[3] * a + x[2] * b;
    a = next;
  }
  return a;
};

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(one_rounding_is_half_an_ulp_of_the_result) {
  const auto product = [](const auto& x) { return x[0] * x[1]; };
  const std::vector<double> x = {1.1, 1.3};
  const double half_ulp = RunningError::kUnitRoundoff * 1.1 * 1.3;
  BOOST_TEST(boundOf(product, x) >= half_ulp);
  BOOST_TEST(boundOf(product, x) <= half_ulp * (1 + 1e-10));
}

BOOST_AUTO_TEST_CASE(what_is_taken_off_again_does_not_count) {
  // (a b + c) - a b loses the rounding of the sums, and that of a b not at all: it has derivative
  // 0. Running error bounds count it twice.
  const auto expression = [](const auto& x) {
    const auto p = x[0] * x[1];
    return (p + x[2]) - p;
  };
  const std::vector<double> x = {1.1, 1.3, 1e-3};
  const double sums = RunningError::kUnitRoundoff * (1.1 * 1.3 + 1e-3 + 1e-3);
  BOOST_TEST(boundOf(expression, x) <= sums * (1 + 1e-6));
  BOOST_TEST(errorOf(expression, x) <= boundOf(expression, x));
}

BOOST_AUTO_TEST_CASE(exact_numbers_have_no_bound) {
  AdjointTape tape;
  const AdjointTape::Recording recording(tape);
  const AdjointError a = 3, b = 4.5;
  BOOST_TEST(boundOf(tape, a * 2 + b * 0) == 0.0);
  BOOST_TEST(tape.size() == 0u);
}

BOOST_AUTO_TEST_CASE(turning_a_vector_forty_times_adds_roundings_and_multiplies_nothing) {
  // cos and sin of 0.8: |c| + |s| = 1.41, to the power 40: 1e6
  const std::vector<double> x = {1.0, 0.0, std::cos(0.8), std::sin(0.8)};
  const std::vector<RunningError> running(x.begin(), x.end());
  BOOST_TEST(turned(running).bound() > 1e5 * RunningError::kUnitRoundoff);
  // 40 turns: each leaves at most 3 roundings of numbers below 1.42 in either entry
  BOOST_TEST(boundOf(turned, x) < 40 * 2 * 3 * 1.42 * RunningError::kUnitRoundoff);
  BOOST_TEST(errorOf(turned, x) <= boundOf(turned, x));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_AUTO_TEST_CASE(the_bound_encloses_the_error_of_every_operation) {
  const auto expression = [](const auto& x) {
    using std::sqrt;
    return sqrt(x[0] * x[0] + x[1]) / (x[2] - x[1] * x[0]) + (-x[0] - x[2]) * x[1];
  };
  RandomStream random("adjoint", 1, 0);
  double closest = 0;
  for (int k = 0; k < 2000; ++k) {
    const std::vector<double> x = {random.uniform(-2, 2), random.uniform(0.1, 3),
                                   random.uniform(7, 9)};
    const double error = errorOf(expression, x), bound = boundOf(expression, x);
    BOOST_TEST(error <= bound);
    closest = std::max(closest, error / bound);
  }
  BOOST_TEST(closest > 0.3);  // measured 0.7: the bound is no exaggeration
}

BOOST_AUTO_TEST_CASE(an_uncertain_divisor_brings_its_second_order_along) {
  AdjointTape tape;
  const AdjointTape::Recording recording(tape);
  // 1 / x for x in [0.9, 1.1] computed at 1: off by up to 1/0.9 - 1
  const AdjointError quotient = AdjointError(1) / AdjointError(RunningError(1.0, 0.1));
  BOOST_TEST(boundOf(tape, quotient) >= 1 / 0.9 - 1);
  BOOST_TEST(boundOf(tape, quotient) <= (1 / 0.9 - 1) * 1.001);
}

// Measured at 64 links: 4e2 ulp in place of 2e11, 5 ulp being seen.
BOOST_DATA_TEST_CASE(inverse_dynamics_of_a_chain_lies_within_bounds_that_grow_as_roundings_do,
                     data::make({4, 16, 64}), links) {
  const scene::Scene scene = scene::findScene("chain_" + std::to_string(links));
  AdjointTape tape;
  const AdjointTape::Recording recording(tape);
  Setup<AdjointError> sharp(scene.mechanism, AdjointErrorNumbers(scene.mechanism));
  Setup<RunningError> running(scene.mechanism, RunningErrorNumbers(scene.mechanism));
  const std::size_t start = tape.size();
  for (int k = 0; k < 3; ++k) {
    const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, k);
    tape.rewind(start);
    const Eigen::MatrixXd bound = tape.bounds(
        NewtonEuler::answer(sharp, Quantity::kTau, adjointState(runningErrorState(state))));
    const MatrixX<RunningError> tau =
        NewtonEuler::answer(running, Quantity::kTau, runningErrorState(state));
    const BallPrecision precision(512);
    Setup<Ball> exact(scene.mechanism, BallNumbers(scene.mechanism));
    const MatrixX<Ball> truth = NewtonEuler::answer(exact, Quantity::kTau, ballState(state));
    double largest = 0;
    for (int i = 0; i < links; ++i) {
      BOOST_TEST((Ball(tau(i, 0).value()) - truth(i, 0)).atMost() <= bound(i, 0));
      BOOST_TEST(bound(i, 0) <= tau(i, 0).bound());
      largest = std::max(largest, std::abs(tau(i, 0).value()));
    }
    BOOST_TEST(bound.maxCoeff() <= 20 * links * 2 * RunningError::kUnitRoundoff * largest);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(a_divisor_that_may_be_zero_leaves_no_bound) {
  AdjointTape tape;
  const AdjointTape::Recording recording(tape);
  const AdjointError quotient = AdjointError(1) / AdjointError(RunningError(1e-3, 1e-2));
  BOOST_TEST(!std::isfinite(boundOf(tape, quotient)));
}

BOOST_AUTO_TEST_SUITE_END()
