// SPDX-License-Identifier: GPL-3.0-or-later
// Second derivatives of inverse dynamics: by hand, and against the Lagrangian's program on dual
// numbers of dual numbers, over the rationals.
#include "recursive/second_derivatives.hpp"

#include <cmath>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "recursive/articulated_body.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/wrist.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using crosscheck::Direction;
using crosscheck::Dual;
using fixtures::Q;
using fixtures::wrist;
using fixtures::Wrist;
using Twice = Dual<Dual<Q>>;

namespace {

const auto kSeeds = data::make({0, 2});
using Part = std::vector<Q> Direction<Q>::*;

/// Any part of the state of dual numbers.
std::vector<Dual<Q>> Direction<Dual<Q>>::*lifted(Part part) {
  using Lifted = Direction<Dual<Q>>;
  return part == &Direction<Q>::q     ? &Lifted::q
         : part == &Direction<Q>::qd  ? &Lifted::qd
         : part == &Direction<Q>::qdd ? &Lifted::qdd
                                      : &Lifted::tau;
}

/// The state moved along j of one part, then from there along k of another.
scene::State<Twice> movedTwice(const Wrist& w, Part first, int j, Part second, int k) {
  const auto n = static_cast<std::size_t>(w.model.dof());
  Direction<Q> along_j;
  (along_j.*first).assign(n, Q(0));
  (along_j.*first)[static_cast<std::size_t>(j)] = Q(1);
  Direction<Dual<Q>> along_k;
  const auto part = lifted(second);
  (along_k.*part).assign(n, Dual<Q>(Q(0)));
  (along_k.*part)[static_cast<std::size_t>(k)] = Dual<Q>(Q(1));
  return crosscheck::moving(crosscheck::lifted<Dual<Q>>(w.model),
                            crosscheck::moving(w.model, w.state, along_j), along_k);
}

/// Entry by entry, what tau(state) makes of it; "" where all are equal.
template <typename Tau>
std::string mismatch(const Wrist& w, const Cube<Q>& cube, Part first, Part second, const Tau& tau) {
  for (int j = 0; j < cube.n(); ++j)
    for (int k = 0; k < cube.n(); ++k) {
      const std::vector<Twice> moved = tau(movedTwice(w, first, j, second, k));
      for (int i = 0; i < cube.n(); ++i)
        if (cube(i, j, k) != moved[static_cast<std::size_t>(i)].derivative.derivative)
          return "at " + std::to_string(i) + ", " + std::to_string(j) + ", " + std::to_string(k);
    }
  return "";
}

constexpr Part kQ = &Direction<Q>::q, kQd = &Direction<Q>::qd, kQdd = &Direction<Q>::qdd,
               kTau = &Direction<Q>::tau;

template <typename Tau>
void requireOfForces(const Wrist& w, const InverseDynamicsSecondDerivatives<Q>& of,
                     const Tau& tau) {
  BOOST_TEST(mismatch(w, of.d2tau_dq_dqdd, kQ, kQdd, tau) == "");
  BOOST_TEST(mismatch(w, of.d2tau_dqd_dqd, kQd, kQd, tau) == "");
  BOOST_TEST(mismatch(w, of.d2tau_dq_dqd, kQ, kQd, tau) == "");
  BOOST_TEST(mismatch(w, of.d2tau_dq_dq, kQ, kQ, tau) == "");
}

/// tau by Lagrange's equations, qdd by articulated bodies, or by theirs and M where joints follow
/// others: no formula of the tested sweep.
void requireSecondDerivatives(Wrist w) {
  SecondDerivativesWorkspace<Q> room(w.model);
  InverseDynamicsSecondDerivatives<Q> of(w.model);
  ForwardDynamicsSecondDerivatives<Q> of_qdd(w.model);
  forwardDynamicsSecondDerivatives(w.model, w.state.x, w.state.qd, w.state.qdd, room, of, of_qdd);
  const symbolic::Program program = w.program();
  const crosscheck::DualNumbers<fixtures::RationalNumbers> once(w.number);
  const crosscheck::DualNumbers<crosscheck::DualNumbers<fixtures::RationalNumbers>> number(once);
  symbolic::ProgramRun<Twice> lagrange(program, number);
  requireOfForces(w, of, [&](const scene::State<Twice>& at) { return lagrange(at); });

  w.state.tau = w.lagrange();
  const auto model = crosscheck::lifted<Twice>(w.model);
  Workspace<Twice> ws(model);
  const auto qdd = [&](const scene::State<Twice>& at) {
    std::vector<Twice> out = at.tau;
    forwardDynamics(model, at.x, at.qd, at.tau, ws, out);
    return out;
  };
  BOOST_TEST(mismatch(w, of_qdd.d2qdd_dq_dq, kQ, kQ, qdd) == "");
  BOOST_TEST(mismatch(w, of_qdd.d2qdd_dq_dqd, kQ, kQd, qdd) == "");
  BOOST_TEST(mismatch(w, of_qdd.d2qdd_dqd_dqd, kQd, kQd, qdd) == "");
  BOOST_TEST(mismatch(w, of_qdd.d2qdd_dq_dtau, kQ, kTau, qdd) == "");
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand, of springPendulum(): tau = 12 qdd + 30 sin q + 7 q + 0.5 qd, so that only the weight has
// a second derivative
BOOST_AUTO_TEST_CASE(a_pendulum) {
  const Model<double> model = fixtures::springPendulum();
  SecondDerivativesWorkspace<double> room(model);
  InverseDynamicsSecondDerivatives<double> of(model);
  ForwardDynamicsSecondDerivatives<double> of_qdd(model);
  const std::vector<JointPosition<double>> x = {scene::jointPosition(0.6)};
  forwardDynamicsSecondDerivatives<double>(model, x, {2}, {1.5}, room, of, of_qdd);
  const double weight = -30 * std::sin(0.6);
  BOOST_TEST(std::abs(of.d2tau_dq_dq(0, 0, 0) - weight) < 1e-14 * 30);
  BOOST_TEST(of.d2tau_dq_dqd(0, 0, 0) == 0);
  BOOST_TEST(of.d2tau_dqd_dqd(0, 0, 0) == 0);
  BOOST_TEST(of.d2tau_dq_dqdd(0, 0, 0) == 0);
  BOOST_TEST(std::abs(of_qdd.d2qdd_dq_dq(0, 0, 0) + weight / 12) < 1e-14);
}

// By hand: two unit point masses on massless rods of 1 m that turn in a plane, angles relative,
// c = cos q2, s = sin q2: M = [3 + 2 c, 1 + c; 1 + c, 1], so D_2 M = [-2 s, -s; -s, 0]; tau_1 has
// -2 s qd1 qd2 - s qd2^2, tau_2 has s qd1^2, each of which is differentiated by rates here.
BOOST_AUTO_TEST_CASE(two_rods) {
  const scene::Scene scene = scene::readSceneToml(
      "gravity = [0, 0, 0]\n[[link]]\nname = \"base\"\n[[link]]\nname = \"upper\"\nparent = "
      "\"base\"\nmass = 1\ncom = [1, 0, 0]\n[link.joint]\nkind = \"revolute\"\naxis = [0, 0, "
      "1]\n[[link]]\nname = \"lower\"\nparent = \"upper\"\nmass = 1\ncom = [1, 0, "
      "0]\n[link.joint]\nkind = \"revolute\"\naxis = [0, 0, 1]\nxyz = [1, 0, 0]\n",
      "rods.toml");
  const auto model = buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  SecondDerivativesWorkspace<double> room(model);
  InverseDynamicsSecondDerivatives<double> of(model);
  const double q2 = 0.7, s = std::sin(q2), c = std::cos(q2), qd1 = 0.5, qd2 = -2;
  inverseDynamicsSecondDerivatives<double>(
      model, {scene::jointPosition(0.3), scene::jointPosition(q2)}, {qd1, qd2}, {0, 0}, room, of);
  const auto near = [](double a, double b) { return std::abs(a - b) < 1e-14; };
  BOOST_TEST(near(of.d2tau_dq_dqdd(0, 1, 0), -2 * s));
  BOOST_TEST(near(of.d2tau_dq_dqdd(0, 1, 1), -s));
  BOOST_TEST(near(of.d2tau_dq_dqdd(1, 1, 0), -s));
  BOOST_TEST(near(of.d2tau_dq_dqdd(1, 1, 1), 0));
  BOOST_TEST(near(of.d2tau_dqd_dqd(0, 0, 1), -2 * s));
  BOOST_TEST(near(of.d2tau_dqd_dqd(0, 1, 1), -2 * s));
  BOOST_TEST(near(of.d2tau_dqd_dqd(1, 0, 0), 2 * s));
  BOOST_TEST(near(of.d2tau_dq_dqd(0, 1, 0), -2 * c * qd2));
  BOOST_TEST(near(of.d2tau_dq_dqd(0, 1, 1), -2 * c * (qd1 + qd2)));
  BOOST_TEST(near(of.d2tau_dq_dqd(1, 1, 0), 2 * c * qd1));
  BOOST_TEST(near(of.d2tau_dq_dq(0, 1, 1), 2 * s * qd1 * qd2 + s * qd2 * qd2));
  BOOST_TEST(near(of.d2tau_dq_dq(1, 1, 1), -s * qd1 * qd1));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(undoes_lagrange)

BOOST_DATA_TEST_CASE(turns_and_slides, kSeeds, seed) {
  const Wrist turns(wrist(seed, 4), seed);
  requireSecondDerivatives(turns);
}

BOOST_DATA_TEST_CASE(screws, kSeeds, seed) {
  requireSecondDerivatives(Wrist(wrist(seed, 4, true), seed));
}

BOOST_DATA_TEST_CASE(followers, kSeeds, seed) {
  requireSecondDerivatives(Wrist(wrist(seed, 5, seed % 2 == 1, 2), seed));
}

BOOST_DATA_TEST_CASE(joints_of_several_axes, data::make({0}) * data::make({false, true}), seed,
                     floats) {
  requireSecondDerivatives(Wrist(
      fixtures::withJoint(wrist(seed, 3), floats ? JointKind::kFloating : JointKind::kSpherical),
      seed));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(what_is_refused) {
  const scene::Mechanism mechanism = scene::findScene("double pendulum").mechanism;
  auto model = buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  SecondDerivativesWorkspace<double> room(model);
  InverseDynamicsSecondDerivatives<double> of(model), small(model);
  small.d2tau_dq_dq = Cube<double>(1);
  const std::vector<JointPosition<double>> x(2, scene::jointPosition(0.3));
  const std::vector<double> two = {1, 2};
  const auto says = [](const std::string& text) {
    return [text](const std::invalid_argument& error) { return error.what() == text; };
  };
  BOOST_CHECK_EXCEPTION(
      inverseDynamicsSecondDerivatives(model, x, two, two, room, small), std::invalid_argument,
      says("inverseDynamicsSecondDerivatives: out: expected 2 joint values, got 1"));
  ForwardDynamicsSecondDerivatives<double> short_one(model);
  short_one.d2qdd_dq_dq = Cube<double>(3);
  BOOST_CHECK_EXCEPTION(
      forwardDynamicsSecondDerivatives(model, x, two, two, room, of, short_one),
      std::invalid_argument,
      says("forwardDynamicsSecondDerivatives: out: expected 2 joint values, got 3"));
  model.rotors.push_back({0, {1, 1}, 1, -1, Vector3<double>::UnitZ()});
  BOOST_CHECK_EXCEPTION(
      inverseDynamicsSecondDerivatives(model, x, two, two, room, of), std::invalid_argument,
      says("inverseDynamicsSecondDerivatives: model: a rotor is geared to several rates, expected "
           "rotors of one rate each"));
}

BOOST_AUTO_TEST_SUITE_END()
