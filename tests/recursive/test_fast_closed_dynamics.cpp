// SPDX-License-Identifier: GPL-3.0-or-later
// Closed loops by M as the fast sweeps have it, against the sweeps that eliminate loops.
#include "recursive/fast/closed_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "recursive/closed_dynamics.hpp"
#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;

namespace {

struct Closed {
  explicit Closed(const std::string& name)
      : scene(scene::findScene(name)),
        number(scene.mechanism),
        model(recursive::buildModel(scene.mechanism, number)),
        constraints(recursive::buildConstraints(scene.mechanism, number, model)),
        springs(recursive::buildPointSprings(scene.mechanism, number, model)),
        fast(model, constraints, springs),
        ws(model),
        q(model.positions),
        qd(model.dof()),
        tau(model.dof()),
        qdd(model.dof()) {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = number(scene.start_q[i]);
  }

  /// By the other road; tau with the springs in it is left in `pulled`.
  recursive::ClosedMotionResult<double> eliminated() {
    x.clear();
    for (const double at : q) x.push_back(scene::jointPosition(at));
    recursive::constraintEquations(model, x, qd, ws, constraints);
    pulled = tau;
    recursive::addSpringForces(model, springs, constraints.X_W, ws, pulled);
    return recursive::closedForwardDynamics(model, x, qd, pulled, constraints, ws);
  }

  scene::Scene scene;
  scene::RealNumbers<double> number;
  recursive::Model<double> model;
  recursive::Constraints<double> constraints;
  std::vector<recursive::PointSpring<double>> springs;
  recursive::fast::ClosedDynamics fast;
  recursive::Workspace<double> ws;
  std::vector<scene::JointPosition<double>> x;
  std::vector<double> q, qd, tau, qdd, pulled;
};

/// Difference of the largest entry.
template <typename A, typename B>
double apart(const A& a, const B& b, int n) {
  double difference = 0, largest = 0;
  for (int i = 0; i < n; ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(a[i]));
  }
  return difference / largest;
}

// Measured: up to 7e-13, on humanoid_left_foot.
constexpr double kRoundOff = 1e-10;

// of independent equations: any state will do, on the closures or off
const char* const kIndependent[] = {
    "andrews_squeezer", "humanoid_both_feet", "humanoid_left_foot", "humanoid_right_foot",
    "loop_on_arm",      "pendulum_on_slides", "rolling_coin"};

}  // namespace

BOOST_DATA_TEST_CASE(both_roads_give_the_same_accelerations_and_multipliers,
                     data::make(kIndependent), name) {
  Closed closed(name);
  std::mt19937 random(7);
  const auto draw = [&random] { return std::uniform_real_distribution<>(-1, 1)(random); };
  const std::vector<double> start = closed.q;
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    for (std::size_t i = 0; i < start.size(); ++i) closed.q[i] = start[i] + 0.1 * draw();
    for (double& rate : closed.qd) rate = draw();
    for (double& force : closed.tau) force = draw();
    const auto expected = closed.eliminated();
    BOOST_REQUIRE(expected.rank == closed.constraints.rows());
    closed.fast.forwardDynamics(closed.q.data(), closed.qd.data(), closed.tau.data(),
                                closed.qdd.data());
    BOOST_TEST(closed.fast.rank() == expected.rank);
    const double of_qdd = apart(expected.qdd, closed.qdd, closed.model.dof()),
                 of_lambda = apart(expected.lambda, closed.fast.multipliers(), expected.rank);
    BOOST_TEST(of_qdd <= kRoundOff);
    BOOST_TEST(of_lambda <= kRoundOff);
    worst = std::max({worst, of_qdd, of_lambda});
  }
  BOOST_TEST_MESSAGE(name << ": " << worst);
}

// one of five equations follows from the others, on the closures, where the start is
BOOST_AUTO_TEST_CASE(equations_that_follow_from_others_are_found) {
  Closed closed("bricard");
  const auto expected = closed.eliminated();
  closed.fast.forwardDynamics(closed.q.data(), closed.qd.data(), closed.tau.data(),
                              closed.qdd.data());
  BOOST_TEST(expected.rank < closed.constraints.rows());
  BOOST_TEST(closed.fast.rank() == expected.rank);
  BOOST_TEST(apart(expected.qdd, closed.qdd, closed.model.dof()) <= kRoundOff);
}

BOOST_AUTO_TEST_CASE(a_mass_matrix_that_is_not_positive_is_refused) {
  Closed closed("loop_on_arm");
  for (recursive::LinkModel<double>& link : closed.model.links) {
    link.M = recursive::RigidInertia<double>::zero();
    link.rotor = 0;
  }
  recursive::fast::ClosedDynamics massless(closed.model, closed.constraints);
  BOOST_CHECK_THROW(massless.forwardDynamics(closed.q.data(), closed.qd.data(), closed.tau.data(),
                                             closed.qdd.data()),
                    std::domain_error);
}
