// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps under constraints against one dense system in all unknowns, made from Lagrange's
// equations, over a prime field: hybrid dynamics, closed loops eliminated where they close, soft
// and redundant constraints, tasks, and Gauss' principle.
#include "recursive/closed_dynamics.hpp"

#include <random>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "recursive/least_constraint.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using F = PrimeField;
using Matrix = recursive::MatrixX<F>;
using Vector = recursive::VectorX<F>;

scene::Number rational(std::mt19937& random) {
  return scene::Number(scene::Rational(static_cast<int>(random() % 41) - 20, 7));
}
scene::Vector vector(std::mt19937& random) {
  return {rational(random), rational(random), rational(random)};
}

/// A random tree with at least so many degrees of freedom.
scene::Scene randomTree(unsigned seed, int least) {
  for (std::uint64_t index = 0;; ++index) {
    scene::Scene scene = randomTreeScene(seed, index, 8);
    if (scene.mechanism.dof() >= least) return scene;
  }
}

void addConstraint(scene::Scene* scene, std::mt19937& random, bool soft) {
  scene::AccelerationConstraint held;
  const std::vector<int> moving = scene->mechanism.movingLinks();
  held.name = std::to_string(scene->mechanism.acceleration_constraints.size() + 1);
  held.link = moving[moving.size() - 1 - random() % ((moving.size() + 1) / 2)];  // the outer half
  held.at = vector(random);
  held.direction = vector(random);
  held.rotation = vector(random);
  if (random() % 2 == 0) held.axes = scene::AccelerationConstraint::Axes::kLink;
  held.value = rational(random);
  if (soft) held.compliance = scene::Number(scene::Rational(3, 5));
  scene->mechanism.acceleration_constraints.push_back(held);
}

/// Drives every third joint whose rates are the derivatives of its positions; at least one stays
/// free.
void drive(scene::Scene* scene) {
  int count = 0;
  for (scene::Link& link : scene->mechanism.links) {
    const int n = scene::degreesOfFreedom(link.joint.kind);
    if (n == 0 || !scene::ratesArePositionDerivatives(link.joint.kind)) continue;
    if (count++ % 3 == 1) link.joint.motion.assign(n, scene::Expression::parseOfTime("t^2/2 - t"));
  }
}

/// @param some  whether some may have no answer (equations that depend on each other)
void requireAgree(const std::vector<CheckResult>& checks, std::size_t count, bool some = false) {
  BOOST_TEST(checks.size() == count);
  for (const CheckResult& check : checks)
    BOOST_TEST_CONTEXT(check.name() << ", " << check.quantity << ": " << check.reason) {
      if (some && check.verdict == Verdict::kNotAnswerable) continue;
      BOOST_TEST((check.verdict == Verdict::kAgree));
      BOOST_TEST_REQUIRE(check.exact.has_value());
      BOOST_TEST(check.exact->residual_zero);
    }
}

/// A scene's model over the field at one random state.
struct Point {
  Point(const scene::Scene& scene, unsigned seed)
      : modulus(drawPrime("closed dynamics", seed, 0)),
        source("closed dynamics", seed, 0),
        number(scene.mechanism, source, Parameters::kAsWritten),
        state(indeterminateState(scene.mechanism, source)),
        model(recursive::buildModel(scene.mechanism, number)),
        ws(model) {}
  PrimeField::Modulus modulus;
  FieldSource source;
  FieldNumbers number;
  scene::State<F> state;
  recursive::Model<F> model;
  recursive::Workspace<F> ws;
};

template <typename A, typename B>
void requireSame(const A& a, const B& b) {
  BOOST_TEST_REQUIRE(static_cast<std::size_t>(a.size()) == static_cast<std::size_t>(b.size()));
  for (int i = 0; i < static_cast<int>(a.size()); ++i) BOOST_TEST((a[i] == b[i]), "entry " << i);
}

}  // namespace

BOOST_AUTO_TEST_SUITE(sweeps_are_the_dense_system)

BOOST_DATA_TEST_CASE(of_bundled_loops,
                     data::make({"pendulum_on_slides", "four_bars_2", "chaplygin_sleigh",
                                 "rolling_coin", "bicycle"}),
                     name) {
  requireAgree(checkConstrainedExactly(scene::findScene(std::string(name)), {}), 3);
}
BOOST_AUTO_TEST_CASE(of_a_closed_mechanism_with_springs_between_points) {
  requireAgree(checkConstrainedExactly(scene::findScene("andrews_squeezer"), {}), 4);
}
// the plane closure among them, and springs
BOOST_AUTO_TEST_CASE(of_a_driven_and_closed_mechanism) {
  requireAgree(checkConstrainedExactly(scene::findScene("car_axis"), {}), 9);
}
BOOST_DATA_TEST_CASE(of_bundled_driven_scenes,
                     data::make({"kapitza_pendulum", "bead_on_hoop", "two_handed"}), name) {
  requireAgree(checkConstrainedExactly(scene::findScene(std::string(name)), {}), 5);
}

// a constrained base, by Gauss' problem too
BOOST_AUTO_TEST_CASE(of_a_floating_robot_whose_base_is_held) {
  requireAgree(checkConstrainedExactly(scene::findScene("satellite_held"), {}), 7);
}

// two links of two branches, or of one; each kind of closure with at most so many equations
BOOST_DATA_TEST_CASE(of_random_loops, data::xrange(8u), seed) {
  scene::Scene scene = randomTree(seed, 6);
  std::mt19937 random(seed);
  const std::vector<int> moving = scene.mechanism.movingLinks();
  const scene::ClosureKind kinds[] = {scene::ClosureKind::kDistance, scene::ClosureKind::kPlane,
                                      scene::ClosureKind::kPlanarPoint};
  for (const unsigned k : {0u, 1u}) {
    scene::Closure closure;
    closure.name = std::to_string(k);
    closure.kind = kinds[(seed + k) % 3];
    closure.b = {moving.back(), vector(random), vector(random)};
    closure.a = {k == 0 ? moving[moving.size() / 2 - 1] : 0, vector(random), vector(random)};
    closure.length = scene::Rational(5, 3);
    scene.mechanism.closures.push_back(closure);
  }
  requireAgree(checkConstrainedExactly(scene, {}), 3, true);
}

BOOST_DATA_TEST_CASE(of_random_driven_and_constrained_trees, data::xrange(8u), seed) {
  scene::Scene scene = randomTree(seed, 6);
  std::mt19937 random(seed);
  addConstraint(&scene, random, false);
  addConstraint(&scene, random, seed % 2 == 0);
  drive(&scene);
  requireAgree(checkConstrainedExactly(scene, {}), 5, true);
}

// Bricard's redundant circle too, whose motion no system decides: any multipliers will do. And a
// fault of one side is seen: each in one number of what acts on links.
BOOST_AUTO_TEST_CASE(reactions_of_whole_mechanisms) {
  const auto verdictOf = [](const scene::Scene& scene, const scene::Mechanism* derived) {
    for (const CheckResult& check : checkConstrainedExactly(scene, {}, derived))
      if (check.quantity == "reactions") return check.verdict;
    BOOST_FAIL("reactions: not asked");
    return Verdict::kNotAnswerable;
  };
  for (const char* name : {"bricard", "car_axis", "two_handed", "flyball_governor"}) {
    const scene::Scene scene = scene::findScene(name);
    BOOST_TEST((verdictOf(scene, nullptr) == Verdict::kAgree), name);
    const auto differs = [&](const scene::Mechanism& wrong) {
      BOOST_TEST((verdictOf(scene, &wrong) == Verdict::kDisagree), name);
    };
    const scene::Number elsewhere(7);
    if (!scene.mechanism.closures.empty()) {
      scene::Mechanism wrong = scene.mechanism;
      wrong.closures[0].b.xyz[1] = elsewhere;
      differs(wrong);
    }
    if (!scene.mechanism.springs.empty()) {
      scene::Mechanism wrong = scene.mechanism;
      wrong.springs[0].b.xyz[1] = elsewhere;
      differs(wrong);
    }
    if (!scene.mechanism.acceleration_constraints.empty()) {
      scene::Mechanism wrong = scene.mechanism;
      wrong.acceleration_constraints[0].at[1] = elsewhere;
      differs(wrong);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(loops_are_eliminated_where_they_close)

// a second four-bar on the bar of the first: two groups, one of them at a moving link
BOOST_AUTO_TEST_CASE(a_loop_between_branches_ends_at_their_common_ancestor) {
  const scene::Scene scene = scene::findScene("loop_on_arm");
  Point p(scene, 1);
  auto closures = recursive::buildConstraints(scene.mechanism, p.number, p.model);
  recursive::constraintEquations(p.model, p.state.x, p.state.qd, p.ws, closures);
  const auto local =
      recursive::closedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, closures, p.ws);
  const auto at_base = recursive::closedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau,
                                                        closures, p.ws, true);
  BOOST_TEST_REQUIRE(local.groups.size() == 1u);
  BOOST_TEST(local.groups[0].ancestor == 0);
  BOOST_TEST(at_base.groups[0].ancestor == -1);
  requireSame(local.qdd, at_base.qdd);
  requireSame(local.lambda, at_base.lambda);
  requireAgree(checkConstrainedExactly(scene, {}), 3);
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(redundant_and_soft)

// every constraint once more: the same motion, and no force is determined any longer
BOOST_DATA_TEST_CASE(a_constraint_that_stands_twice_changes_no_acceleration, data::xrange(4u),
                     seed) {
  scene::Scene scene = randomTree(seed, 6);
  std::mt19937 random(seed);
  addConstraint(&scene, random, false);
  addConstraint(&scene, random, false);
  Point p(scene, seed);
  const auto once = recursive::accelerationConstraints(scene.mechanism, p.number, p.model,
                                                       p.state.x, p.state.qd, p.ws);
  std::vector<F> qdd = p.state.qdd, again = qdd;
  recursive::ConstraintWorkspace<F> cws(p.model, 2), three(p.model, 3);
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, once, p.ws,
                                        cws, qdd);
  if (cws.of_N.rank() < 2) return;  // drew two that depend on each other
  auto twice = once;
  twice.push_back(once[1]);
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, twice, p.ws,
                                        three, again);
  BOOST_TEST(three.of_N.rank() == 2);
  requireSame(qdd, again);
  BOOST_TEST((three.nu(0) == cws.nu(0)));
  const char expected[] = {1, 0, 0};
  for (int k = 0; k < 3; ++k) BOOST_TEST(int(three.of_N.determined()[k]) == int(expected[k]));
  for (int k = 0; k < 3; ++k) BOOST_TEST((three.missing(k) == F(0)));
  // one that contradicts is told by how much
  twice[2].b(0) += F(5);
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, twice, p.ws,
                                        three, again);
  BOOST_TEST((three.missing(2) == F(5)));
}

// The same in double: the rank is told from rounding.
BOOST_AUTO_TEST_CASE(rank_is_told_in_double_precision_too) {
  const scene::Scene scene = scene::findScene("two_handed");
  const scene::RealNumbers<double> number(scene.mechanism);
  const auto model = recursive::buildModel(scene.mechanism, number);
  recursive::Workspace<double> ws(model);
  std::vector<scene::JointPosition<double>> x;
  for (const double q : {0.1, 0.4, -1.0, 0.3, -1.2}) x.push_back(scene::jointPosition(q));
  const std::vector<double> qd = {0.3, -0.2, 0.5, 0.1, 0.7}, tau(5, 0.0);
  auto held = recursive::accelerationConstraints(scene.mechanism, number, model, x, qd, ws);
  held[2].compliance(0) = 0;
  std::vector<double> qdd(5), again(5);
  recursive::ConstraintWorkspace<double> four(model, 4), five(model, 5);
  recursive::constrainedForwardDynamics(model, x, qd, tau, held, ws, four, qdd);
  BOOST_TEST(four.of_N.rank() == 4);
  held.push_back(held[0]);  // the sum of the first two
  held[4].A += held[1].A;
  held[4].b += held[1].b;
  recursive::constrainedForwardDynamics(model, x, qd, tau, held, ws, five, again);
  BOOST_TEST(five.of_N.rank() == 4);
  const bool expected[] = {false, false, true, true, false};
  for (int k = 0; k < 5; ++k) BOOST_TEST(bool(five.of_N.determined()[k]) == expected[k]);
  // the same system solved with other pivots: cond(N) of some 1e3, measured, times eps
  for (int i = 0; i < 5; ++i) BOOST_TEST(std::abs(qdd[i] - again[i]) <= 1e3 * 2.3e-16 * 20);
}

// (N + C) nu = missing: with C = c D the answer is a rational function of c that at c = 0 is the
// hard one
BOOST_AUTO_TEST_CASE(compliance_gives_way_and_zero_compliance_does_not) {
  const scene::Scene scene = scene::findScene("two_handed");
  Point p(scene, 3);
  auto held = recursive::accelerationConstraints(scene.mechanism, p.number, p.model, p.state.x,
                                                 p.state.qd, p.ws);
  const int m = static_cast<int>(held.size());
  std::vector<F> hard = p.state.qdd, soft = hard, qdd = hard;
  recursive::ConstraintWorkspace<F> cws(p.model, m);
  for (auto& one : held) one.compliance.resize(0);
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, held, p.ws,
                                        cws, hard);
  const Vector nu = cws.nu;
  const Matrix N = cws.N;
  for (auto& one : held) one.compliance = Vector::Constant(1, F(0));
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, held, p.ws,
                                        cws, soft);
  requireSame(hard, soft);
  for (auto& one : held) one.compliance(0) = F(7);
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, held, p.ws,
                                        cws, soft);
  requireSame(Vector(N * cws.nu + cws.nu * F(7)), Vector(N * nu));
  // and redundant ones are determined when they are soft
  held.push_back(held[0]);
  recursive::ConstraintWorkspace<F> more(p.model, m + 1);
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, held, p.ws,
                                        more, qdd);
  BOOST_TEST(more.of_N.rank() == m + 1);
  BOOST_TEST((more.nu(0) == more.nu(m)));  // shared out evenly
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(least_constraint)

// A floating robot whose base is held by k constraints: inward sweeps make it one body of six
// accelerations, Gauss' problem of which is solved alone; against constraints on link 0 in the
// sweeps, and both forces.
BOOST_DATA_TEST_CASE(of_the_base_is_that_of_the_whole_robot,
                     data::make({"satellite_arm", "humanoid_floating"}), name) {
  const scene::Scene scene = scene::findScene(std::string(name));
  Point p(scene, 5);
  std::mt19937 random(5);
  recursive::LinkConstraint<F> held;
  held.link = 0;
  held.A = Eigen::Matrix<F, 6, Eigen::Dynamic>(6, 2);
  held.b.resize(2);
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < 6; ++i) held.A(i, k) = F(static_cast<int>(random() % 1000));
    held.b(k) = F(static_cast<int>(random() % 1000));
  }
  std::vector<F> by_sweeps = p.state.qdd, by_base = by_sweeps;
  recursive::ConstraintWorkspace<F> cws(p.model, 2);
  recursive::constrainedForwardDynamics(p.model, p.state.x, p.state.qd, p.state.tau, {held}, p.ws,
                                        cws, by_sweeps);
  Vector force;
  recursive::baseConstrainedDynamics(p.model, p.state.x, p.state.qd, p.state.tau, held, p.ws,
                                     by_base, &force);
  requireSame(by_sweeps, by_base);
  requireSame(cws.nu, force);
}

// Over the rationals, where "less" means something: any other acceleration that obeys A' a = b
// costs more, by half the square of its distance in M's norm.
BOOST_AUTO_TEST_CASE(every_other_acceleration_costs_more) {
  using Q = fixtures::Q;
  recursive::MatrixX<Q> M(3, 3), A(3, 1);
  M << Q(4), Q(1), Q(0), Q(1), Q(3), Q(1), Q(0), Q(1), Q(2);
  A << Q(1), Q(2), Q(-1);
  recursive::VectorX<Q> F_(3), b(1);
  F_ << Q(1), Q(-2), Q(3);
  b << Q(5) / Q(2);
  const auto best = recursive::leastConstraint<Q>(M, F_, A, b);
  BOOST_TEST((A.transpose() * best.a)(0) == b(0));
  const auto cost = [&](const recursive::VectorX<Q>& a) {
    return Q((a.transpose() * M * a)(0) / 2 + F_.dot(a));
  };
  std::mt19937 random(1);
  for (int k = 0; k < 20; ++k) {
    recursive::VectorX<Q> d(3);  // A' d = 0
    d << Q(static_cast<int>(random() % 9) - 4), Q(static_cast<int>(random() % 9) - 4), Q(0);
    d(2) = d(0) + 2 * d(1);
    const Q more = cost(best.a + d) - cost(best.a);
    BOOST_TEST(more == Q((d.transpose() * M * d)(0) / 2));
    if (!d.isZero(0)) BOOST_TEST(more > 0);
  }
}

BOOST_AUTO_TEST_SUITE_END()
