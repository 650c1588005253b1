// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of inverse and forward dynamics: by hand, and against the Lagrangian's program and
// forward dynamics on dual numbers, over the rationals.
#include "recursive/derivatives.hpp"

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
using fixtures::mismatch;
using fixtures::Q;
using fixtures::withJoint;
using fixtures::wrist;
using fixtures::Wrist;

namespace {

constexpr int kSeeds = 4;
using Part = std::vector<Q> Direction<Q>::*;

/// Column by column, what `answer` makes of the state moved by one unit of a part.
template <typename Answer>
MatrixX<Q> byDuals(const Wrist& w, Part part, const Answer& answer) {
  const int n = w.model.dof();
  MatrixX<Q> out(n, n);
  for (int k = 0; k < n; ++k) {
    Direction<Q> unit;
    (unit.*part).assign(static_cast<std::size_t>(n), Q(0));
    (unit.*part)[static_cast<std::size_t>(k)] = Q(1);
    const std::vector<Dual<Q>> moved = answer(crosscheck::moving(w.model, w.state, unit));
    for (int i = 0; i < n; ++i) out(i, k) = moved[static_cast<std::size_t>(i)].derivative;
  }
  return out;
}

/// Both kinds of derivatives at the state, as the sweeps give them.
struct Swept {
  explicit Swept(const Wrist& w) : room(w.model), of_tau(w.model), of_qdd(w.model) {
    InverseDynamicsDerivatives<Q> factored(w.model);
    inverseDynamicsDerivatives(w.model, w.state.x, w.state.qd, w.state.qdd, room, of_tau);
    forwardDynamicsDerivatives(w.model, w.state.x, w.state.qd, w.state.qdd, room, factored, of_qdd);
  }
  DerivativesWorkspace<Q> room;
  InverseDynamicsDerivatives<Q> of_tau;
  ForwardDynamicsDerivatives<Q> of_qdd;
};

/// tau by Lagrange's equations, qdd by articulated bodies: no formula of the tested sweeps.
void requireDerivatives(Wrist w) {
  const Swept swept(w);
  const symbolic::Program program = w.program();
  const crosscheck::DualNumbers<fixtures::RationalNumbers> number(w.number);
  symbolic::ProgramRun<Dual<Q>> lagrange(program, number);
  const auto tau = [&](const scene::State<Dual<Q>>& at) { return lagrange(at); };
  BOOST_TEST(mismatch(swept.of_tau.dtau_dq, byDuals(w, &Direction<Q>::q, tau)) == "");
  BOOST_TEST(mismatch(swept.of_tau.dtau_dqd, byDuals(w, &Direction<Q>::qd, tau)) == "");
  BOOST_TEST(mismatch(swept.of_tau.M, byDuals(w, &Direction<Q>::qdd, tau)) == "");

  w.state.tau = w.lagrange();
  const auto model = crosscheck::lifted<Dual<Q>>(w.model);
  Workspace<Dual<Q>> ws(model);
  const auto qdd = [&](const scene::State<Dual<Q>>& at) {
    std::vector<Dual<Q>> out = at.tau;
    forwardDynamics(model, at.x, at.qd, at.tau, ws, out);
    return out;
  };
  BOOST_TEST(mismatch(swept.of_qdd.dqdd_dq, byDuals(w, &Direction<Q>::q, qdd)) == "");
  BOOST_TEST(mismatch(swept.of_qdd.dqdd_dqd, byDuals(w, &Direction<Q>::qd, qdd)) == "");
  BOOST_TEST(mismatch(swept.of_qdd.dqdd_dtau, byDuals(w, &Direction<Q>::tau, qdd)) == "");
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand, of springPendulum(): tau = 12 qdd + 30 sin q + 7 q + 0.5 qd
BOOST_AUTO_TEST_CASE(a_pendulum) {
  const Model<double> model = fixtures::springPendulum();
  DerivativesWorkspace<double> room(model);
  InverseDynamicsDerivatives<double> of_tau(model);
  ForwardDynamicsDerivatives<double> of_qdd(model);
  const std::vector<JointPosition<double>> x = {scene::jointPosition(0.6)};
  inverseDynamicsDerivatives<double>(model, x, {2}, {1.5}, room, of_tau);
  const double stiffness = 30 * std::cos(0.6) + 7;
  BOOST_TEST(std::abs(of_tau.dtau_dq(0, 0) - stiffness) < 1e-14 * stiffness);
  BOOST_TEST(of_tau.dtau_dqd(0, 0) == 0.5);
  BOOST_TEST(std::abs(of_tau.M(0, 0) - 12) < 1e-14);
  forwardDynamicsDerivatives<double>(model, x, {2}, {1.5}, room, of_tau, of_qdd);
  BOOST_TEST(std::abs(of_qdd.dqdd_dq(0, 0) + stiffness / 12) < 1e-14);
  BOOST_TEST(std::abs(of_qdd.dqdd_dqd(0, 0) + 0.5 / 12) < 1e-15);
  BOOST_TEST(std::abs(of_qdd.dqdd_dtau(0, 0) - 1.0 / 12) < 1e-15);
}

// By hand: a body that floats, 2 kg about its centre of mass, not turned, feels its weight along
// its own axes: turned by eps about x, -g e_z m has 2 g eps along y. Its rates are its own:
// f = m (v' + w x v), so d f/dv = m [w]x and d f/dw = -m [v]x.
BOOST_AUTO_TEST_CASE(a_floating_body) {
  const scene::Scene scene = scene::readSceneToml(
      "gravity = [0, 0, -5]\n[[link]]\nname = \"base\"\n[[link]]\nname = \"body\"\nparent = "
      "\"base\"\nmass = 2\ninertia = { xx = 1, yy = 2, zz = 2.5 }\n[link.joint]\nkind = "
      "\"floating\"\n",
      "body.toml");
  const auto model = buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  DerivativesWorkspace<double> room(model);
  InverseDynamicsDerivatives<double> of(model);
  std::vector<JointPosition<double>> x(7, JointPosition<double>{0, 1, 0});
  x[3].q = 1;
  const std::vector<double> qd = {1, 2, 3, 0.5, -1, 0.25};
  inverseDynamicsDerivatives(model, x, qd, std::vector<double>(6, 0.0), room, of);
  MatrixX<double> by_q = MatrixX<double>::Zero(6, 6);
  by_q(1, 3) = 10;   // about x: the weight's reaction 10 e_z has 10 along y
  by_q(0, 4) = -10;  // about y: -10 along x
  BOOST_TEST(mismatch(of.dtau_dq, by_q) == "");
  const Vector3<double> v(1, 2, 3), w(0.5, -1, 0.25);
  BOOST_TEST(mismatch(of.dtau_dqd.topLeftCorner(3, 3), 2 * skew(w)) == "");
  BOOST_TEST(mismatch(of.dtau_dqd.topRightCorner(3, 3), -2 * skew(v)) == "");
  // w x I w by hand: (0.5 w_y w_z, -1.5 w_z w_x, w_x w_y)
  Matrix3<double> turning;
  turning << 0, 0.5 * w(2), 0.5 * w(1), -1.5 * w(2), 0, -1.5 * w(0), w(1), w(0), 0;
  BOOST_TEST(mismatch(of.dtau_dqd.bottomRightCorner(3, 3), turning) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(undoes_lagrange)

BOOST_DATA_TEST_CASE(turns_and_slides, data::xrange(kSeeds), seed) {
  const Wrist turns(wrist(seed, 5), seed);
  BOOST_TEST(turns.model.plain_joints);
  requireDerivatives(turns);
}

BOOST_DATA_TEST_CASE(screws, data::xrange(kSeeds), seed) {
  const Wrist screws(wrist(seed, 5, true), seed);
  BOOST_TEST(!screws.model.plain_joints);
  requireDerivatives(screws);
}

BOOST_DATA_TEST_CASE(followers, data::xrange(2 * kSeeds), seed) {
  const Wrist coupled(wrist(seed, 6, seed % 2 == 1, 2), seed);
  BOOST_TEST(coupled.model.coupled);
  requireDerivatives(coupled);
}

BOOST_DATA_TEST_CASE(joints_of_several_axes, data::xrange(kSeeds) * data::make({false, true}), seed,
                     floats) {
  const Wrist tree(withJoint(wrist(seed, 4), floats ? JointKind::kFloating : JointKind::kSpherical),
                   seed);
  BOOST_TEST(tree.model.dof() == (floats ? 9 : 6));
  requireDerivatives(tree);
}

// What is left out of tau is left out of its derivatives.
BOOST_DATA_TEST_CASE(terms, data::xrange(4), left_out) {
  Wrist w(wrist(5, 4), 5);
  Terms terms;
  (left_out == 0   ? terms.gravity
   : left_out == 1 ? terms.springs
   : left_out == 2 ? terms.loads
                   : terms.friction) = false;
  DerivativesWorkspace<Q> room(w.model);
  InverseDynamicsDerivatives<Q> of_tau(w.model);
  inverseDynamicsDerivatives(w.model, w.state.x, w.state.qd, w.state.qdd, room, of_tau, terms);
  const auto model = crosscheck::lifted<Dual<Q>>(w.model);
  Workspace<Dual<Q>> ws(model);
  const auto tau = [&](const scene::State<Dual<Q>>& at) {
    std::vector<Dual<Q>> out = at.tau;
    inverseDynamics(model, at.x, at.qd, at.qdd, ws, out, terms);
    return out;
  };
  BOOST_TEST(mismatch(of_tau.dtau_dq, byDuals(w, &Direction<Q>::q, tau)) == "");
  BOOST_TEST(mismatch(of_tau.dtau_dqd, byDuals(w, &Direction<Q>::qd, tau)) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(sizes) {
  const scene::Mechanism mechanism = scene::findScene("double pendulum").mechanism;
  const auto model = buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  DerivativesWorkspace<double> room(model);
  InverseDynamicsDerivatives<double> of(model), small(model);
  small.M.resize(1, 1);
  ForwardDynamicsDerivatives<double> of_qdd(model);
  const std::vector<JointPosition<double>> x(2, scene::jointPosition(0.3)), one(1, x[0]);
  const std::vector<double> two = {1, 2}, three = {1, 2, 3};
  const auto says = [](const std::string& text) {
    return [text](const std::invalid_argument& error) { return error.what() == text; };
  };
  BOOST_CHECK_EXCEPTION(inverseDynamicsDerivatives(model, one, two, two, room, of),
                        std::invalid_argument,
                        says("inverseDynamicsDerivatives: x: expected 2 joint values, got 1"));
  BOOST_CHECK_EXCEPTION(inverseDynamicsDerivatives(model, x, three, two, room, of),
                        std::invalid_argument,
                        says("inverseDynamicsDerivatives: qd: expected 2 joint values, got 3"));
  BOOST_CHECK_EXCEPTION(inverseDynamicsDerivatives(model, x, two, three, room, of),
                        std::invalid_argument,
                        says("inverseDynamicsDerivatives: qdd: expected 2 joint values, got 3"));
  BOOST_CHECK_EXCEPTION(
      inverseDynamicsDerivatives(model, x, two, two, room, small), std::invalid_argument,
      says("inverseDynamicsDerivatives: rows of out: expected 2 joint values, got 1"));
  BOOST_CHECK_EXCEPTION(
      solveForAccelerations(model, room, small, of_qdd), std::invalid_argument,
      says("solveForAccelerations: rows of of_tau: expected 2 joint values, got 1"));
}

BOOST_AUTO_TEST_SUITE_END()
