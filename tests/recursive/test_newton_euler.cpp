// SPDX-License-Identifier: GPL-3.0-or-later
#include "recursive/newton_euler.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/dual.hpp"
#include "recursive/build_model.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using crosscheck::Dual;
using fixtures::mismatch;
using fixtures::Q;
using fixtures::V3;

namespace {

constexpr int kSeeds = 10, kMoving = 6;

std::vector<Q> tauOf(const scene::Mechanism& mechanism, const scene::State<Q>& state,
                     const std::vector<Q>& qd, const std::vector<Q>& qdd, Terms terms) {
  const Model<Q> model = buildModel(mechanism, fixtures::RationalNumbers(mechanism));
  Workspace<Q> ws(model);
  std::vector<Q> tau(static_cast<std::size_t>(model.dof()));
  inverseDynamics(model, state.x, qd, qdd, ws, tau, terms);
  return tau;
}

/// A link of a chain in the x-z plane: joint about y at the parent's (0, 0, -length), a point mass
/// at this link's (0, 0, -r). Angle zero hangs down.
scene::Link pendulumLink(int parent, const Q& offset, const Q& r, const Q& mass) {
  scene::Link link;
  link.name = "link_" + std::to_string(parent + 1);
  link.parent = parent;
  link.joint.name = link.name;
  link.joint.kind = JointKind::kRevolute;
  link.joint.axis = {scene::Number(0), scene::Number(1), scene::Number(0)};
  link.joint.placement.xyz = {scene::Number(0), scene::Number(0), fixtures::numberOf(-offset)};
  link.inertia.mass = fixtures::numberOf(mass);
  link.inertia.com = {scene::Number(0), scene::Number(0), fixtures::numberOf(-r)};
  return link;
}

scene::Mechanism pendulums(const std::vector<scene::Link>& links) {
  scene::Mechanism m;
  m.has_gravity = true;
  m.gravity = {scene::Number(0), scene::Number(0), fixtures::numberOf(Q(-981) / 100)};
  m.links.emplace_back();
  m.links[0].name = "base";
  for (const scene::Link& link : links) m.links.push_back(link);
  return m;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand: m l^2 qdd + m g l sin q = tau.
BOOST_DATA_TEST_CASE(a_simple_pendulum_obeys_its_textbook_equation, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  const Q l = sample.positive(), m = sample.positive(), g = Q(981) / 100;
  const scene::Mechanism pendulum = pendulums({pendulumLink(0, 0, l, m)});
  const scene::State<Q> state = fixtures::randomState(1, seed);
  const std::vector<Q> tau = tauOf(pendulum, state, state.qd, state.qdd, Terms::all());
  BOOST_TEST(tau[0] == m * l * l * state.qdd[0] + m * g * l * state.x[0].s);
}

// By hand, q2 relative to link 1 (Lagrange, any textbook), with point masses at both tips:
//   tau2 = m2 l2^2 (a1 + a2) + m2 l1 l2 (cos q2 a1 + sin q2 w1^2) + m2 g l2 sin(q1 + q2)
//   tau1 = tau2 + (m1 + m2) l1^2 a1 + m2 l1 l2 (cos q2 (a1 + a2) - sin q2 (w1 + w2)^2)
//          + (m1 + m2) g l1 sin q1
BOOST_DATA_TEST_CASE(a_double_pendulum_obeys_its_textbook_equations, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  const Q l1 = sample.positive(), l2 = sample.positive(), m1 = sample.positive(),
          m2 = sample.positive(), g = Q(981) / 100;
  const scene::Mechanism two = pendulums({pendulumLink(0, 0, l1, m1), pendulumLink(1, l1, l2, m2)});
  const scene::State<Q> state = fixtures::randomState(2, seed);
  const Q w1 = state.qd[0], w2 = state.qd[1], a1 = state.qdd[0], a2 = state.qdd[1];
  const Q s1 = state.x[0].s, c1 = state.x[0].c, s2 = state.x[1].s, c2 = state.x[1].c;
  const Q s12 = s1 * c2 + c1 * s2, w12 = w1 + w2;
  const Q tau2 =
      m2 * l2 * l2 * (a1 + a2) + m2 * l1 * l2 * (c2 * a1 + s2 * w1 * w1) + m2 * g * l2 * s12;
  const Q tau1 = tau2 + (m1 + m2) * l1 * l1 * a1 +
                 m2 * l1 * l2 * (c2 * (a1 + a2) - s2 * w12 * w12) + (m1 + m2) * g * l1 * s1;
  const std::vector<Q> tau = tauOf(two, state, state.qd, state.qdd, Terms::all());
  BOOST_TEST(mismatch(tau, std::vector<Q>{tau1, tau2}) == "");
}

// By hand: n slides along z, stacked, each of 1 kg; sum over everything outboard. All numbers are
// integers below 2^53, so double arithmetic is exact too.
BOOST_AUTO_TEST_CASE(a_chain_of_100000_slides_carries_what_is_above_each) {
  constexpr int n = 100000;
  scene::Mechanism m = pendulums({});
  m.gravity[2] = scene::Number(-10);
  for (int i = 0; i < n; ++i) {
    scene::Link link = pendulumLink(i, 0, 0, 1);
    link.joint.kind = JointKind::kPrismatic;
    link.joint.axis = {scene::Number(0), scene::Number(0), scene::Number(1)};
    m.links.push_back(link);
  }
  const Model<double> model = buildModel(m, scene::RealNumbers<double>(m));
  BOOST_REQUIRE(model.dof() == n);
  Workspace<double> ws(model);
  const std::vector<JointPosition<double>> x(n, JointPosition<double>{0.5, 1, 0});
  const std::vector<double> qd(n, 3.0), qdd(n, 1.0);
  std::vector<double> tau(n, 0.0);
  inverseDynamics(model, x, qd, qdd, ws, tau);
  // link k accelerates with k + 1 and weighs 10: tau_i = sum over k = i .. n-1 of (k + 11)
  int wrong = 0;
  double expected = 0;
  for (int i = n - 1; i >= 0; --i) {
    expected += i + 11;
    if (tau[static_cast<std::size_t>(i)] != expected) ++wrong;
  }
  BOOST_TEST(wrong == 0);
  BOOST_TEST(expected == 0.5 * n * (n - 1) + 11.0 * n);
}

// By hand: n straight links of length 1 with 1 kg at the tips, no gravity, all turning with the
// first joint: mass k is at distance k + 1, so tau_i = sum over k >= i of (k + 1 - i) (k + 1)
// qdd_0.
BOOST_AUTO_TEST_CASE(a_straight_chain_of_100000_hinges_passes_moments_inward) {
  constexpr int n = 100000;
  scene::Mechanism m = pendulums({});
  m.has_gravity = false;
  for (int i = 0; i < n; ++i) m.links.push_back(pendulumLink(i, i == 0 ? 0 : 1, 1, 1));
  const Model<double> model = buildModel(m, scene::RealNumbers<double>(m));
  Workspace<double> ws(model);
  const std::vector<JointPosition<double>> x(n, JointPosition<double>{0, 1, 0});
  std::vector<double> qd(n, 0.0), qdd(n, 0.0), tau(n, 0.0);
  qdd[0] = 1;
  qd[0] = 2;  // centrifugal force acts along the chain and turns nothing
  inverseDynamics(model, x, qd, qdd, ws, tau);
  int wrong = 0;
  double moment = 0, force = 0;  // carried inward from the tip
  for (int i = n - 1; i >= 0; --i) {
    force += i + 1;
    moment += force;  // everything outboard gained one metre of arm, and the own mass has one
    if (tau[static_cast<std::size_t>(i)] != moment) ++wrong;
  }
  BOOST_TEST(wrong == 0);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// d'Alembert's principle on mass points in the world, no bodies and no spatial vectors:
//   tau_j = sum m (a - gravity)' dr/dq_j - virtual work of the loads + rotor + spring.
// Points come from fixtures::linkPoses; dr/dq and a = d2r/dt2 by (nested) dual numbers.
BOOST_DATA_TEST_CASE(inverse_dynamics_is_the_virtual_work_of_mass_points, data::xrange(kSeeds),
                     seed) {
  const fixtures::Tree tree = fixtures::randomTree(kMoving, seed);
  const scene::Mechanism& m = tree.mechanism;
  const fixtures::RationalNumbers number(m);
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const V3<Q> gravity = fixtures::rationalVector(m, m.gravity);

  using D = Dual<Q>;
  using DD = Dual<D>;
  std::vector<JointPosition<DD>> x_t;  // the motion q(t) to second order
  for (int i = 0; i < kMoving; ++i) {
    const auto k = static_cast<std::size_t>(i);
    x_t.push_back(crosscheck::moving(crosscheck::moving(state.x[k], state.qd[k]),
                                     D(state.qd[k], state.qdd[k])));
  }
  const auto poses_t = fixtures::linkPoses(m, x_t);

  std::vector<Q> expected;
  const std::vector<int> moving = m.movingLinks();
  for (int j = 0; j < kMoving; ++j) {
    const auto dof = static_cast<std::size_t>(j);
    std::vector<JointPosition<D>> x_j;  // joint j alone moves, with unit velocity
    for (int i = 0; i < kMoving; ++i)
      x_j.push_back(crosscheck::moving(state.x[static_cast<std::size_t>(i)], Q(i == j ? 1 : 0)));
    const auto poses_j = fixtures::linkPoses(m, x_j);

    const scene::Joint& joint = m.links[static_cast<std::size_t>(moving[dof])].joint;
    Q work = number(joint.gear_ratio) * number(joint.gear_ratio) * number(joint.rotor_inertia) *
                 state.qdd[dof] +
             number(joint.stiffness) * (state.x[dof].q - number(joint.rest));
    for (std::size_t i = 0; i < m.links.size(); ++i)
      for (const fixtures::Point& point : tree.clouds[i]) {
        const V3<DD> r_t = fixtures::placeOf(poses_t[i], point.at);
        const V3<D> r_j = fixtures::placeOf(poses_j[i], point.at);
        for (int k = 0; k < 3; ++k)
          work += point.mass * (r_t(k).derivative.derivative - gravity(k)) * r_j(k).derivative;
      }
    for (const scene::Wrench& wrench : m.wrenches) {
      const auto& pose = poses_j[static_cast<std::size_t>(wrench.link)];
      const V3<D> at = fixtures::placeOf(pose, fixtures::rationalVector(m, wrench.at));
      V3<Q> force = fixtures::rationalVector(m, wrench.force);
      V3<Q> moment = fixtures::rationalVector(m, wrench.moment);
      fixtures::M3<Q> R, dR;
      for (int k = 0; k < 9; ++k) {
        R(k) = pose.R(k).value;
        dR(k) = pose.R(k).derivative;
      }
      if (wrench.axes == scene::Wrench::Axes::kLink) {
        force = (R * force).eval();
        moment = (R * moment).eval();
      }
      const fixtures::M3<Q> w_hat = dR * R.transpose();  // angular velocity of unit qd_j
      const V3<Q> w(w_hat(2, 1), w_hat(0, 2), w_hat(1, 0));
      work -= moment.dot(w);
      for (int k = 0; k < 3; ++k) work -= force(k) * at(k).derivative;
    }
    expected.push_back(work);
  }
  BOOST_TEST(mismatch(tauOf(m, state, state.qd, state.qdd, Terms::all()), expected) == "");
}

BOOST_DATA_TEST_CASE(terms_add_up_to_the_whole, data::xrange(kSeeds), seed) {
  const scene::Mechanism m = fixtures::randomTree(kMoving, seed).mechanism;
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const std::vector<Q> zeros(kMoving, Q(0));
  const auto sum = tauOf(m, state, state.qd, state.qdd, Terms::all());
  const auto inertial = tauOf(m, state, zeros, state.qdd, Terms::none());
  const auto velocity = tauOf(m, state, state.qd, zeros, Terms::none());
  const auto gravity = tauOf(m, state, zeros, zeros, {true, false, false});
  const auto springs = tauOf(m, state, zeros, zeros, {false, true, false});
  const auto loads = tauOf(m, state, zeros, zeros, {false, false, true});
  std::vector<Q> added;
  for (std::size_t i = 0; i < kMoving; ++i) {
    added.push_back(inertial[i] + velocity[i] + gravity[i] + springs[i] + loads[i]);
    BOOST_TEST(inertial[i] != 0);  // generic: no term hides behind a zero
    BOOST_TEST(springs[i] != 0);
  }
  BOOST_TEST(mismatch(sum, added) == "");
}

// c is a quadratic form: twice the speed, four times the force; turned around, the same.
BOOST_DATA_TEST_CASE(velocity_products_are_quadratic, data::xrange(kSeeds), seed) {
  const scene::Mechanism m = fixtures::randomTree(kMoving, seed).mechanism;
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const std::vector<Q> zeros(kMoving, Q(0));
  std::vector<Q> tripled, expected = tauOf(m, state, state.qd, zeros, Terms::none());
  for (const Q& rate : state.qd) tripled.push_back(Q(-3) * rate);
  for (Q& c : expected) c *= Q(9);
  BOOST_TEST(mismatch(tauOf(m, state, tripled, zeros, Terms::none()), expected) == "");
}

BOOST_AUTO_TEST_SUITE_END()
