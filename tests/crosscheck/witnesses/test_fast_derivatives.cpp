// SPDX-License-Identifier: GPL-3.0-or-later
// The fast derivatives are those of tau and qdd: over a prime field against the Lagrangian's
// program and forward dynamics on dual numbers, and the textbook's derivatives; identities; in
// double within bounds of rounding and against the certified truth.
#include "crosscheck/witnesses/fast_derivatives.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>

#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/exact_state.hpp"
#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/fast/derivatives.hpp"
#include "recursive/newton_euler.hpp"
#include "scene/families.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using recursive::MatrixX;
using recursive::RowsX;
using F = PrimeField;
using Moving = Dual<F>;

namespace {

std::vector<scene::Scene> scenes() {
  std::vector<scene::Scene> all;
  for (const auto& file : scene::bundledScenes()) {
    all.push_back(scene::readScene(file));
    if (all.back().mechanism.hasCoupledRates()) all.pop_back();  // no plan takes them
  }
  for (int index = 0; index < 60; ++index) all.push_back(randomTreeScene(20, index, 9));
  return all;
}

/// One random point modulo a random prime; qdd is drawn, and tau belongs to it.
class Point {
 public:
  Point(const scene::Scene& scene, std::uint64_t index)
      : mechanism_(scene.mechanism),
        modulus_(drawPrime(scene.name, 20, index)),
        source_(scene.name, 20, index),
        numbers_(mechanism_, source_, Parameters::kAsWritten),
        state(indeterminateState(mechanism_, source_)),
        model(recursive::buildModel(mechanism_, numbers_)),
        along_(state.tau) {
    recursive::Workspace<F> ws(model);
    recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, state.tau);
  }

  /// Rates of tau along a random direction of q, qd and qdd, as Lagrange's equations have them.
  std::vector<std::vector<F>> lagrange() const {
    const symbolic::Equations e = symbolic::derive(mechanism_);
    symbolic::Equations copy = e;
    const symbolic::Program program =
        symbolic::compile(copy.graph, symbolic::inverseDynamics(copy));
    const DualNumbers<FieldNumbers> number(numbers_);
    symbolic::ProgramRun<Moving> run(program, number);
    return alongAll(false, [&](const scene::State<Moving>& at) { return run(at); });
  }
  /// Of qdd along one of q, qd and tau, by articulated bodies.
  std::vector<std::vector<F>> articulated() const {
    const recursive::Model<Moving> moving_model = lifted<Moving>(model);
    recursive::Workspace<Moving> ws(moving_model);
    return alongAll(true, [&](const scene::State<Moving>& at) {
      std::vector<Moving> out = at.tau;
      recursive::forwardDynamics(moving_model, at.x, at.qd, at.tau, ws, out);
      return out;
    });
  }
  /// A matrix along that direction.
  std::vector<F> along(const RowsX<F>& matrix) const {
    std::vector<F> out;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      F sum(0);
      for (Eigen::Index j = 0; j < matrix.cols(); ++j)
        sum += matrix(i, j) * along_[static_cast<std::size_t>(j)];
      out.push_back(sum);
    }
    return out;
  }
  std::vector<std::vector<F>> along(const FastDerivatives<F>::Matrices& m) const {
    return {along(m.by_q), along(m.by_qd), along(m.by_last)};
  }

 private:
  template <typename Answer>
  std::vector<std::vector<F>> alongAll(bool of_accelerations, const Answer& answer) const {
    std::vector<std::vector<F>> out;
    Direction<F> directions[3];
    directions[0].q = directions[1].qd = along_;
    (of_accelerations ? directions[2].tau : directions[2].qdd) = along_;
    for (const Direction<F>& direction : directions) {
      out.emplace_back();
      for (const Moving& value : answer(moving(model, state, direction)))
        out.back().push_back(value.derivative);
    }
    return out;
  }

  scene::Mechanism mechanism_;
  PrimeField::Modulus modulus_;
  FieldSource source_;
  FieldNumbers numbers_;

 public:
  scene::State<F> state;
  recursive::Model<F> model;

 private:
  std::vector<F> along_;
};

/// Where M is singular nothing is to be compared.
std::optional<FastDerivatives<F>::Matrices> accelerations(FastDerivatives<F>& fast,
                                                          const scene::State<F>& state) {
  try {
    return fast.ofAccelerations(state);
  } catch (const DivisionByZero&) {
    return std::nullopt;
  }
}

/// Which of the six differ from the textbook's, entry by entry; "" where none does.
std::string differing(Point& point, FastDerivatives<F>& fast) {
  recursive::DerivativesWorkspace<F> room(point.model);
  recursive::InverseDynamicsDerivatives<F> of_tau(point.model);
  recursive::ForwardDynamicsDerivatives<F> of_qdd(point.model);
  const scene::State<F>& s = point.state;
  recursive::inverseDynamicsDerivatives(point.model, s.x, s.qd, s.qdd, room, of_tau);
  const auto forces = fast.ofForces(s);
  std::string out;
  const auto compare = [&](const char* name, const auto& left, const auto& right) {
    if (MatrixX<F>(left) != MatrixX<F>(right)) out += (out.empty() ? "" : " ") + std::string(name);
  };
  compare("dtau/dq", forces.by_q, of_tau.dtau_dq);
  compare("dtau/dqd", forces.by_qd, of_tau.dtau_dqd);
  compare("M", forces.by_last, of_tau.M);
  const auto of = accelerations(fast, s);
  if (!of) return out;
  recursive::solveForAccelerations(point.model, room, of_tau, of_qdd);
  compare("dqdd/dq", of->by_q, of_qdd.dqdd_dq);
  compare("dqdd/dqd", of->by_qd, of_qdd.dqdd_dqd);
  compare("dqdd/dtau", of->by_last, of_qdd.dqdd_dtau);
  return out;
}

std::string differing(const scene::Scene& scene) {
  Point point(scene, 0);
  FastDerivatives<F> fast(point.model);
  return differing(point, fast);
}

}  // namespace

BOOST_AUTO_TEST_SUITE(over_a_prime_field)

BOOST_AUTO_TEST_CASE(they_are_the_textbooks) {
  std::set<recursive::fast::Step> steps;
  int branches = 0, world_loads = 0, spins = 0, several = 0;
  for (const scene::Scene& scene : scenes()) {
    Point point(scene, 1);
    FastDerivatives<F> fast(point.model);
    BOOST_TEST(differing(point, fast) == "", scene.name);
    for (const auto& link : fast.plan.links) {
      steps.insert(link.step);
      spins += !link.spin.isZero();
      several += link.axes > 1;
    }
    branches += fast.plan.branches;
    world_loads += static_cast<int>(fast.plan.world_loads.size());
  }
  BOOST_TEST(steps.size() == 7u);  // every kind of step was taken
  for (const int count : {branches, world_loads, spins, several}) BOOST_TEST(count > 0);
  scene::Scene chain;
  BOOST_REQUIRE(scene::findFamily("chain_64", &chain));
  BOOST_TEST(differing(chain) == "");
}

// The Lagrangian shares no formula with any sweep, dual numbers none with sweeps for derivatives.
BOOST_AUTO_TEST_CASE(they_are_the_lagrangians_and_dual_numbers) {
  int singular = 0;
  for (const scene::Scene& scene : scenes()) {
    Point point(scene, 2);
    FastDerivatives<F> fast(point.model);
    BOOST_TEST((point.along(fast.ofForces(point.state)) == point.lagrange()), scene.name);
    if (const auto of = accelerations(fast, point.state))
      BOOST_TEST((point.along(*of) == point.articulated()), scene.name);
    else
      ++singular;
  }
  BOOST_TEST(singular < 10);
}

BOOST_AUTO_TEST_CASE(they_obey_identities) {
  for (const scene::Scene& scene : scenes()) {
    Point point(scene, 3);
    FastDerivatives<F> fast(point.model);
    const auto of_tau = fast.ofForces(point.state);
    const MatrixX<F> M = of_tau.by_last;
    BOOST_TEST((M == M.transpose()), scene.name);
    const auto of_qdd = accelerations(fast, point.state);
    if (!of_qdd) continue;
    const MatrixX<F> inverse = of_qdd->by_last;
    BOOST_TEST((inverse == inverse.transpose()), scene.name);
    BOOST_TEST((MatrixX<F>(M * inverse) == MatrixX<F>(MatrixX<F>::Identity(M.rows(), M.cols()))),
               scene.name);
    BOOST_TEST((MatrixX<F>(M * of_qdd->by_q) == MatrixX<F>(-of_tau.by_q)), scene.name);
    BOOST_TEST((MatrixX<F>(M * of_qdd->by_qd) == MatrixX<F>(-of_tau.by_qd)), scene.name);
  }
}

// What a plan gets wrong is seen in the quantities that know it.
BOOST_AUTO_TEST_CASE(a_planted_error_is_seen) {
  const auto with = [](const char* name, const auto& change) {
    Point point(scene::findScene(name), 4);
    recursive::fast::Plan<F> plan(point.model);
    change(plan);
    FastDerivatives<F> fast(plan);
    return differing(point, fast);
  };
  const std::string all = "dtau/dq dtau/dqd M dqdd/dq dqdd/dqd dqdd/dtau";
  BOOST_TEST(with("puma_560", [](auto&) {}) == "");
  BOOST_TEST(with("puma_560", [](auto& plan) { plan.links[1].s = -plan.links[1].s; }) == all);
  BOOST_TEST(with("puma_560", [](auto& plan) { plan.links[2].is_apart = false; }) == all);
  BOOST_TEST(with("puma_560", [](auto& plan) { plan.links[3].I.xy += F(1); }) == all);
  BOOST_TEST(with("puma_560", [](auto& plan) { plan.links[5].rotor += F(1); }) ==
             "M dqdd/dq dqdd/dqd dqdd/dtau");
  BOOST_TEST(with("puma_560", [](auto& plan) { plan.links[2].viscous += F(1); }) ==
             "dtau/dqd dqdd/dqd");
  BOOST_TEST(with("puma_560", [](auto& plan) { plan.links[2].stiffness += F(1); }) ==
             "dtau/dq dqdd/dq");
  BOOST_TEST(with("puma_560", [](auto& plan) { plan.gravity.x += F(1); }) == "dtau/dq dqdd/dq");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(in_double)

namespace {

struct Answers {
  explicit Answers(int n) : of_tau(3 * n * n), of_qdd(of_tau) {}
  std::vector<double> of_tau, of_qdd;  ///< three matrices each
};

Answers fastAnswers(const recursive::Model<double>& model, const scene::State<double>& s,
                    std::vector<double>* qdd) {
  recursive::fast::Derivatives fast(model);
  const int n = model.dof(), nn = n * n;
  Answers out(n);
  std::vector<double> q;
  for (const auto& x : s.x) q.push_back(x.q);
  double *a = out.of_tau.data(), *b = out.of_qdd.data();
  fast.inverseDynamics(q.data(), s.qd.data(), s.qdd.data(), a, a + nn, a + 2 * nn);
  fast.forwardDynamics(q.data(), s.qd.data(), s.tau.data(), b, b + nn, b + 2 * nn);
  qdd->assign(fast.qdd(), fast.qdd() + n);
  return out;
}

double largest(const RowsX<Ball>& matrix) {
  double out = 0;
  for (Eigen::Index k = 0; k < matrix.size(); ++k) out = std::max(out, matrix.data()[k].atMost());
  return out;
}
double largest(const std::vector<double>& v) {
  double out = 0;
  for (const double x : v) out = std::max(out, std::abs(x));
  return out;
}

/// Largest error of a matrix beside that scale, in units of 2^-52.
double worst(const double* answer, const RowsX<Ball>& truth, double scale) {
  double error = 0;
  for (Eigen::Index k = 0; k < truth.size(); ++k)
    error = std::max(error, (truth.data()[k] - Ball(answer[k])).atMost());
  return error == 0 ? 0 : error / scale / std::numeric_limits<double>::epsilon();
}

}  // namespace

// The truth is the same sweep's in balls of 256 bits, which the cases above hold to the Lagrangian.
// Seen at worst: 22 units of dtau/dq, 9.3 of dtau/dqd, 8.3 of M.
BOOST_AUTO_TEST_CASE(they_keep_their_digits) {
  const BallPrecision precision(256);
  double seen[3] = {};
  for (const scene::Scene& scene : scenes()) {
    const auto model =
        recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
    const int n = model.dof();
    FastDerivatives<Ball> in_balls(
        recursive::buildModel(scene.mechanism, BallNumbers(scene.mechanism)));
    for (std::uint64_t k = 0; k < 3; ++k) {
      const scene::State<double> s = drawState(scene.mechanism, scene.name, 20, k);
      std::vector<double> qdd;
      const Answers answers = fastAnswers(model, s, &qdd);
      const auto truth = in_balls.ofForces(ballState(s));
      const double* const a = answers.of_tau.data();
      const RowsX<Ball>* const matrices[] = {&truth.by_q, &truth.by_qd, &truth.by_last};
      // where all velocity products cancel, d tau/dqd beside what they are made of
      const double M = largest(truth.by_last);
      const double scales[] = {largest(truth.by_q),
                               std::max(largest(truth.by_qd), M * largest(s.qd)), M};
      for (int m = 0; m < 3; ++m) {
        const double units = worst(a + m * n * n, *matrices[m], scales[m]);
        BOOST_TEST(units < 64, scene.name << " " << m << ": " << units);
        seen[m] = std::max(seen[m], units);
      }
    }
  }
  BOOST_TEST_MESSAGE("worst errors [2^-52 of the largest entry]: " << seen[0] << " " << seen[1]
                                                                   << " " << seen[2]);
}

// A bound of the very computation, carried along.
BOOST_AUTO_TEST_CASE(they_are_within_bounds_of_their_rounding) {
  double tightest = std::numeric_limits<double>::infinity();
  const BallPrecision precision(256);
  for (const scene::Scene& scene : scenes()) {
    const auto model =
        recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
    FastDerivatives<RunningError> bounded(
        recursive::buildModel(scene.mechanism, RunningErrorNumbers(scene.mechanism)));
    FastDerivatives<Ball> in_balls(
        recursive::buildModel(scene.mechanism, BallNumbers(scene.mechanism)));
    const scene::State<double> s = drawState(scene.mechanism, scene.name, 21, 0);
    const auto limits = bounded.ofForces(runningErrorState(s));
    const auto truth = in_balls.ofForces(ballState(s));
    std::vector<double> qdd;
    const Answers answers = fastAnswers(model, s, &qdd);
    const Eigen::Index size = truth.by_q.size();
    const RowsX<Ball>* const T[] = {&truth.by_q, &truth.by_qd, &truth.by_last};
    const RowsX<RunningError>* const L[] = {&limits.by_q, &limits.by_qd, &limits.by_last};
    for (int m = 0; m < 3; ++m)
      for (Eigen::Index k = 0; k < size; ++k) {
        const double error = (T[m]->data()[k] - Ball(answers.of_tau[m * size + k])).atMost();
        const double limit = L[m]->data()[k].bound();
        // cosines of the class are within 2^-52 of theirs, those of the state within half of that
        BOOST_TEST(error <= 2 * limit, scene.name << " " << m << " " << k);
        if (error > 0 && limit > 0) tightest = std::min(tightest, 2 * limit / error);
      }
  }
  BOOST_TEST_MESSAGE("limit over error, at least: " << tightest);
}

// Vectors of four, of two and plain numbers: the same bits.
BOOST_AUTO_TEST_CASE(they_are_the_same_bits_whatever_the_processor) {
  namespace fast = recursive::fast;
  for (const scene::Scene& scene : scenes()) {
    const auto model =
        recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
    const fast::Plan<double> plan(model);
    const scene::State<double> s = drawState(scene.mechanism, scene.name, 22, 0);
    const std::size_t nn = static_cast<std::size_t>(plan.dof) * plan.dof;
    const auto answer = [&](const auto& body) {
      fast::AccelerationDerivativesWorkspace<double> ws(plan);
      std::vector<double> out(3 * nn);
      body(plan, s.x.data(), s.qd.data(), s.qdd.data(), ws,
           fast::AccelerationDerivatives<double>{out.data(), out.data() + nn, out.data() + 2 * nn});
      return out;
    };
    const auto chosen = answer(fast::forwardDynamicsDerivatives<double>);
    const auto two = answer(fast::detail::accelerationDerivativesBody<fast::TwoPairs, double>);
    const auto one = answer(fast::detail::accelerationDerivativesBody<fast::Lanes<double>, double>);
    BOOST_TEST((std::memcmp(chosen.data(), two.data(), 3 * nn * sizeof(double)) == 0), scene.name);
    BOOST_TEST((std::memcmp(chosen.data(), one.data(), 3 * nn * sizeof(double)) == 0), scene.name);
  }
}

// Of qdd: the derivatives at that qdd, which the class finds by itself. Seen: they differ by
// 6.5e-15 of the largest entry, where M's inverse costs a digit or two.
BOOST_AUTO_TEST_CASE(those_of_qdd_are_at_the_qdd_of_tau) {
  const scene::Scene scene = scene::findScene("franka_panda");
  const auto model =
      recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  scene::State<double> s = drawState(scene.mechanism, scene.name, 23, 0);
  std::vector<double> qdd;
  const Answers answers = fastAnswers(model, s, &qdd);
  s.qdd = qdd;
  recursive::DerivativesWorkspace<double> room(model);
  recursive::InverseDynamicsDerivatives<double> of_tau(model);
  recursive::ForwardDynamicsDerivatives<double> of_qdd(model);
  recursive::forwardDynamicsDerivatives(model, s.x, s.qd, s.qdd, room, of_tau, of_qdd);
  const std::size_t nn = static_cast<std::size_t>(of_qdd.dqdd_dq.size());
  const double scale = of_qdd.dqdd_dq.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < nn; ++k)
    BOOST_TEST(std::abs(answers.of_qdd[k] - of_qdd.dqdd_dq.data()[k]) < 1e-13 * scale);
}

BOOST_AUTO_TEST_SUITE_END()
