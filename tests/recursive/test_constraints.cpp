// SPDX-License-Identifier: GPL-3.0-or-later
// Loop closures: the sweeps against Lagrange's equations with multipliers, without rounding, and
// the solver against hand-made and published numbers.
#include "recursive/constraints.hpp"

#include <cmath>
#include <random>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "recursive/constrained_solver.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"
#include "symbolic/closures.hpp"
#include "symbolic/equations.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

using scene::ClosureKind;
using FieldMatrix = recursive::MatrixX<PrimeField>;
using FieldVector = recursive::VectorX<PrimeField>;

/// A rational frame on a link, turned about all three axes.
scene::Attachment randomFrame(int link, std::mt19937& random) {
  const auto number = [&random] {
    return scene::Number(scene::Rational(static_cast<int>(random() % 41) - 20, 7));
  };
  return {link, {number(), number(), number()}, {number(), number(), number()}};
}

/// The number of moving joints between a link and the ground.
int depth(const scene::Mechanism& mechanism, int link) {
  int joints = 0;
  for (; link >= 0; link = mechanism.links[link].parent)
    joints += scene::degreesOfFreedom(mechanism.links[link].joint.kind) > 0 ? 1 : 0;
  return joints;
}

/// A random tree with a moving link at least so deep, its closures left to the caller.
scene::Scene randomTree(unsigned seed, int least_depth) {
  for (std::uint64_t index = 0;; ++index) {
    scene::Scene scene = randomTreeScene(seed, index, 9);
    for (const int link : scene.mechanism.movingLinks())
      if (depth(scene.mechanism, link) >= least_depth) return scene;
  }
}

void addClosure(scene::Scene* scene, ClosureKind kind, int a, int b, std::mt19937& random) {
  scene::Closure closure;
  closure.name = std::to_string(scene->mechanism.closures.size() + 1);
  closure.kind = kind;
  closure.a = randomFrame(a, random);
  closure.b = randomFrame(b, random);
  closure.length = scene::Rational(5, 3);
  scene->mechanism.closures.push_back(closure);
}

/// One closure of each kind, between any two links that move on each other, one side on the ground
/// now and then.
scene::Scene randomLoops(unsigned seed) {
  scene::Scene scene = randomTree(seed, 3);
  std::mt19937 random(seed);
  const std::vector<int> moving = scene.mechanism.movingLinks();
  for (const ClosureKind kind :
       {ClosureKind::kDistance, ClosureKind::kPlanarPoint, ClosureKind::kPoint, ClosureKind::kHinge,
        ClosureKind::kWeld, ClosureKind::kSkate, ClosureKind::kRolling}) {
    const int a = random() % 3 == 0 ? 0 : moving[random() % moving.size()];
    int b = a;
    while (b == a) b = moving[random() % moving.size()];
    addClosure(&scene, kind, a, b, random);
  }
  return scene;
}

void requireAgree(const std::vector<CheckResult>& checks) {
  BOOST_TEST(checks.size() == 3u);
  for (const CheckResult& check : checks)
    BOOST_TEST_CONTEXT(check.quantity << ": " << check.reason) {
      BOOST_TEST((check.verdict == Verdict::kAgree));
      BOOST_TEST_REQUIRE(check.exact.has_value());
      BOOST_TEST(check.exact->residual_zero);
      BOOST_TEST(check.exact->error_probability <= 1e-30);
    }
}

/// Gauss-Jordan elimination of [A | b]; unknowns without a pivot become zero.
/// @return whether the equations do not contradict each other
bool eliminate(FieldMatrix A, FieldVector b, FieldVector* x) {
  std::vector<Eigen::Index> pivot_of_row;
  Eigen::Index row = 0;
  for (Eigen::Index column = 0; column < A.cols() && row < A.rows(); ++column) {
    Eigen::Index best = row;
    while (best < A.rows() && A(best, column).isZero()) ++best;
    if (best == A.rows()) continue;
    A.row(row).swap(A.row(best));
    std::swap(b(row), b(best));
    const PrimeField inverse = A(row, column).inverse();
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      if (i == row || A(i, column).isZero()) continue;
      const PrimeField factor = A(i, column) * inverse;
      for (Eigen::Index j = 0; j < A.cols(); ++j) A(i, j) -= factor * A(row, j);
      b(i) -= factor * b(row);
    }
    pivot_of_row.push_back(column);
    ++row;
  }
  for (Eigen::Index i = row; i < A.rows(); ++i)
    if (!b(i).isZero()) return false;
  *x = FieldVector::Constant(A.cols(), PrimeField(0));
  for (Eigen::Index i = 0; i < row; ++i) (*x)(pivot_of_row[i]) = b(i) / A(i, pivot_of_row[i]);
  return true;
}

/// qdd from Lagrange's equations with multipliers, as one linear system in (qdd, lambda).
FieldVector byMultipliers(const scene::Mechanism& mechanism, const FieldNumbers& number,
                          const scene::State<PrimeField>& state) {
  symbolic::Options options;
  options.fold_parameters = true;
  symbolic::Equations e = symbolic::derive(mechanism, options);
  const symbolic::ClosureEquations closures = symbolic::closureEquations(mechanism, options, e);
  const int n = e.dof(), m = static_cast<int>(closures.phi.size());
  std::vector<symbolic::Node> outputs = symbolic::massCoriolisGravity(e);
  outputs.insert(outputs.end(), e.Q.begin(), e.Q.end());
  for (const auto& row : closures.J) outputs.insert(outputs.end(), row.begin(), row.end());
  outputs.insert(outputs.end(), closures.gamma.begin(), closures.gamma.end());
  const symbolic::Program program = symbolic::compile(e.graph, outputs);
  const std::vector<PrimeField> value = symbolic::ProgramRun<PrimeField>(program, number)(state);
  const PrimeField *M = value.data(), *c = M + n * n, *g = c + n, *Q = g + n, *J = Q + n,
                   *gamma = J + m * n;
  FieldMatrix A = FieldMatrix::Constant(n + m, n + m, PrimeField(0));
  FieldVector b(n + m), x;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) A(i, j) = M[i * n + j];
    b(i) = state.tau[i] + Q[i] - c[i] - g[i];
  }
  for (int k = 0; k < m; ++k) {
    for (int j = 0; j < n; ++j) {
      A(n + k, j) = J[k * n + j];
      A(j, n + k) = -J[k * n + j];
    }
    b(n + k) = -gamma[k];
  }
  BOOST_TEST_REQUIRE(eliminate(A, b, &x));
  return x.head(n);
}

/// qdd from the sweeps: lambda first, from (J M^-1 J') lambda = -gamma - J qdd_free.
FieldVector bySweeps(const scene::Mechanism& mechanism, const FieldNumbers& number,
                     const scene::State<PrimeField>& state) {
  const auto model = recursive::buildModel(mechanism, number);
  recursive::Workspace<PrimeField> ws(model);
  auto constraints = recursive::buildConstraints(mechanism, number, model);
  recursive::constraintEquations(model, state.x, state.qd, ws, constraints);
  const int n = model.dof(), m = constraints.rows();
  FieldMatrix M(n, n);
  recursive::massMatrix(model, state.x, ws, M);
  recursive::factorize(M);
  std::vector<PrimeField> bias(n), zero(n, PrimeField(0));
  recursive::inverseDynamics(model, state.x, state.qd, zero, ws, bias);
  FieldVector qdd(n);
  for (int i = 0; i < n; ++i) qdd(i) = state.tau[i] - bias[i];
  recursive::solve(M, qdd);
  FieldMatrix M_inverse_J(n, m);
  for (int k = 0; k < m; ++k) {
    FieldVector column = constraints.J.row(k).transpose();
    recursive::solve(M, column);
    M_inverse_J.col(k) = column;
  }
  FieldVector lambda;
  const FieldMatrix S = constraints.J * M_inverse_J;
  const FieldVector missing = constraints.gamma + constraints.J * qdd;
  BOOST_TEST_REQUIRE(eliminate(S, FieldVector(missing * PrimeField(-1)), &lambda));
  return qdd + M_inverse_J * lambda;
}

double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

std::vector<double> startOf(const scene::Scene& scene, const std::vector<scene::Number>& numbers) {
  const scene::RealNumbers<double> number(scene.mechanism);
  std::vector<double> out;
  for (const scene::Number& n : numbers) out.push_back(number(n));
  return out;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(same_mathematics)

BOOST_DATA_TEST_CASE(bundled_closures_are_the_same_by_lagrange_and_by_the_sweeps,
                     data::make({"pendulum_on_slides", "four_bars_2", "andrews_squeezer",
                                 "bricard"}),
                     name) {
  requireAgree(checkClosuresExactly(scene::findScene(std::string(name)), {}));
}

// one closure of each kind; revolute and prismatic joints about and along any axis
BOOST_DATA_TEST_CASE(random_closures_are_the_same_by_lagrange_and_by_the_sweeps, data::xrange(6u),
                     seed) {
  requireAgree(checkClosuresExactly(randomLoops(seed), {}));
}

// phi = 0 does not hold at random points, and need not: the equations are J qdd = -gamma
BOOST_DATA_TEST_CASE(accelerations_are_those_of_lagranges_equations_with_multipliers,
                     data::xrange(10u), seed) {
  scene::Scene scene = randomTree(seed, 4);
  std::mt19937 random(seed);
  int deepest = 0;
  for (const int link : scene.mechanism.movingLinks())
    if (depth(scene.mechanism, link) > depth(scene.mechanism, deepest)) deepest = link;
  const ClosureKind kinds[] = {ClosureKind::kDistance, ClosureKind::kPlanarPoint,
                               ClosureKind::kPoint, ClosureKind::kSkate, ClosureKind::kRolling};
  // either side on the ground: as frame A it does not turn, as frame B everything turns under it
  const bool ground_is_a = seed % 2 == 0;
  addClosure(&scene, kinds[seed % 5], ground_is_a ? 0 : deepest, ground_is_a ? deepest : 0, random);
  const PrimeField::Modulus modulus(drawPrime("constraints", seed, 0));
  const FieldSource source("constraints", seed, 0);
  const FieldNumbers number(scene.mechanism, source, Parameters::kAsWritten);
  const auto state = indeterminateState(scene.mechanism, source);
  const FieldVector left = byMultipliers(scene.mechanism, number, state);
  const FieldVector right = bySweeps(scene.mechanism, number, state);
  for (Eigen::Index i = 0; i < left.size(); ++i)
    BOOST_TEST(left(i).residue() == right(i).residue());
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(known_answers)

// IVP Test Set, problem andrews (data/reference/motion/andrews_squeezer.json has the source):
// initial accelerations of beta and theta, and the first two multipliers, which are the force of K3
// on K2 in world axes; ours are in the axes of K2, at angle beta + theta. The accuracy 5e-6 is
// stated there.
BOOST_AUTO_TEST_CASE(andrews_initial_accelerations_and_multipliers_are_the_published_ones) {
  const scene::Scene scene = scene::findScene("andrews_squeezer");
  const std::vector<double> q = startOf(scene, scene.start_q);
  const ConstrainedState state = constrainedAccelerations(scene, q, startOf(scene, scene.start_qd));
  BOOST_TEST(state.rank == 6);
  const auto near = [](double value, double printed) {
    return std::abs(value - printed) <= 5e-6 * std::abs(printed);
  };
  BOOST_TEST(near(state.qdd[0], 14222.443919954114));
  BOOST_TEST(near(state.qdd[1], -10666.832939965585));
  const double c = std::cos(q[0] + q[1]), s = std::sin(q[0] + q[1]);
  BOOST_TEST(near(c * state.lambda[0] - s * state.lambda[1], 98.56687039624109));
  BOOST_TEST(near(s * state.lambda[0] + c * state.lambda[1], -6.122688344255662));
  for (const bool determined : state.determined) BOOST_TEST(determined);
}

/** Largest |qdd by the sweeps - qdd by Simbody|, over the largest |qdd|, at states along the
    simulated motion (A02 starts without any acceleration). Simbody solves with its own J M^-1 J' by
    QTZ at its own tolerance. */
struct Along {
  const char* scene;
  double duration;
  double limit;
};
std::ostream& operator<<(std::ostream& out, const Along& along) {
  return out << along.scene;
}

// Rounding alone parts the two. Measured: up to 5e-15, but 1e-12 for A05, where the length of 0.5 m
// of a spring of 8e5 N/m is known to eps, which is 9e-11 N on 3 kg: 3e-11 m/s^2 of up to 40. A
// wrong term in J, gamma or a spring's force is worth 1e-3 and more.
const Along kAlong[] = {{"pendulum_on_slides", 5, 1e-12},
                        {"four_bars_2", 5, 1e-12},
                        {"andrews_squeezer", 0.03, 1e-12},
                        {"bricard", 5, 1e-12},
                        {"flyball_governor", 0.5, 1e-11}};

BOOST_DATA_TEST_CASE(accelerations_are_those_of_simbodys_constraints_along_the_motion,
                     data::make(kAlong), sample) {
  const scene::Scene scene = scene::findScene(sample.scene);
  SimulateOptions options;
  options.duration = sample.duration;
  options.outputs = 20;
  double worst = 0, largest = 0;
  for (const Simulation::Point& point : simulate(scene, options).points) {
    scene::State<double> state;
    for (const double q : point.q) state.x.push_back(scene::jointPosition(q));
    state.qd = point.qd;
    state.tau.assign(point.q.size(), 0.0);
    const Eigen::VectorXd theirs = simbodyClosedAccelerations(scene, state);
    const std::vector<double> ours = constrainedAccelerations(scene, point.q, point.qd).qdd;
    largest = std::max(largest, theirs.cwiseAbs().maxCoeff());
    for (std::size_t i = 0; i < ours.size(); ++i)
      worst = std::max(worst, std::abs(ours[i] - theirs(i)));
  }
  BOOST_TEST_MESSAGE(sample.scene << ": " << worst / largest);
  BOOST_TEST(worst <= sample.limit * largest);
}

// Every closure twice: the same motion, and no multiplier can be told any more. The limit: two
// solutions of one system, each with an error of cond(M) eps; cond(M) of this pose, measured, is
// 4e3.
BOOST_AUTO_TEST_CASE(a_closure_that_stands_twice_changes_no_acceleration) {
  scene::Scene scene = scene::findScene("andrews_squeezer");
  const std::vector<double> q = startOf(scene, scene.start_q);
  const std::vector<double> qd = {3.0, -1.0, 0.5, 0.2, 0.1, -0.4, 0.3};
  const ConstrainedState once = constrainedAccelerations(scene, q, qd);
  scene.mechanism.closures.push_back(scene.mechanism.closures[1]);
  const ConstrainedState twice = constrainedAccelerations(scene, q, qd);
  BOOST_TEST(once.rank == 6);
  BOOST_TEST(twice.rank == 6);
  double largest = 0;
  for (const double v : once.qdd) largest = std::max(largest, std::abs(v));
  BOOST_TEST(largestDifference(once.qdd, twice.qdd) <= 1e4 * 2.3e-16 * largest);
  // the copied closure's multipliers may be shared out; the other two closures keep theirs
  const bool expected[] = {true, true, false, false, true, true, false, false};
  for (std::size_t i = 0; i < twice.determined.size(); ++i)
    BOOST_TEST(twice.determined[i] == expected[i]);
}

// One freedom where counting finds none (benchmark A04): of the five equations one follows from the
// rest.
BOOST_AUTO_TEST_CASE(bricards_loop_has_rank_four_and_says_which_multipliers_it_cannot_tell) {
  const scene::Scene scene = scene::findScene("bricard");
  const ConstrainedState state =
      constrainedAccelerations(scene, std::vector<double>(5, 0.0), std::vector<double>(5, 0.0));
  BOOST_TEST(state.rank == 4);
  int undetermined = 0;
  for (const bool determined : state.determined) undetermined += determined ? 0 : 1;
  BOOST_TEST(undetermined >= 2);  // a dependence takes two rows at least
}

// By hand: a point mass of 2 kg on two crossed slides, held to the line x = y: it may move along
// (1, 1), and a force (6, 0) accelerates it by 6 / 2 / 2 in x and in y; lambda holds (-3, 3).
BOOST_AUTO_TEST_CASE(the_solver_agrees_with_a_bead_on_a_line_by_hand) {
  recursive::MatrixX<double> M = 2 * Eigen::Matrix2d::Identity(), J(1, 2);
  J << 1, -1;
  recursive::ConstrainedSolver<double> solver;
  solver.factorize(M, J);
  const auto result = solver.solve(Eigen::Vector2d(6, 0), Eigen::VectorXd::Zero(1));
  BOOST_TEST(std::abs(result.qdd(0) - 1.5) < 1e-15);
  BOOST_TEST(std::abs(result.qdd(1) - 1.5) < 1e-15);
  BOOST_TEST(std::abs(result.lambda(0) + 3) < 1e-14);
  // two equations that contradict each other: x - y accelerates by 0 and by 1
  J.resize(2, 2);
  J << 1, -1, 1, -1;
  solver.factorize(M, J);
  BOOST_TEST(solver.rank() == 1);
  BOOST_TEST(solver.solve(Eigen::Vector2d(6, 0), Eigen::Vector2d(0, 1)).contradiction == 1.0,
             boost::test_tools::tolerance(1e-14));
}

BOOST_AUTO_TEST_SUITE_END()
BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(wrong_sizes_and_singular_inertia_are_refused) {
  const scene::Scene scene = scene::findScene("bricard");
  BOOST_CHECK_THROW(constrainedAccelerations(scene, {0.0}, {0.0}), std::invalid_argument);
  recursive::ConstrainedSolver<double> solver;
  const recursive::MatrixX<double> zero = Eigen::Matrix2d::Zero(), J = Eigen::Matrix2d::Identity();
  BOOST_CHECK_THROW(solver.factorize(zero, J), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
