// SPDX-License-Identifier: GPL-3.0-or-later
// Every sweep that takes the articulated-body step, on wrists with all that acts on joints and
// links (gyroscopic rotors, springs, friction, loads), against the Lagrangian over the rationals.
#include "recursive/articulated_step.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "recursive/articulated_body.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "recursive/operational_space.hpp"
#include "tests/fixtures/wrist.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using fixtures::mismatch;
using fixtures::Q;
using fixtures::wrist;
using fixtures::Wrist;

namespace {

constexpr int kSeeds = 4;

void requireBothWays(Wrist wrist) {
  const std::vector<Q> lagrange = wrist.lagrange();
  std::vector<Q> tau = lagrange, qdd = tau;
  inverseDynamics(wrist.model, wrist.state.x, wrist.state.qd, wrist.state.qdd, wrist.ws, tau);
  BOOST_TEST(mismatch(tau, lagrange) == "");
  forwardDynamics(wrist.model, wrist.state.x, wrist.state.qd, lagrange, wrist.ws, qdd);
  BOOST_TEST(mismatch(qdd, wrist.state.qdd) == "");
}

/// A wrist with two loops: a rod between two links and a point on a plane.
scene::Mechanism closedWrist(int seed) {
  fixtures::Sampler sample(seed);
  scene::Mechanism m = wrist(seed, 6, seed % 2 == 1);
  std::vector<int> moving;
  for (int i = 1; i < static_cast<int>(m.links.size()); ++i)
    if (m.links[i].joint.kind != JointKind::kFixed) moving.push_back(i);
  for (const int a : {2, 3}) {
    scene::Closure closure;
    closure.kind = a == 2 ? scene::ClosureKind::kDistance : scene::ClosureKind::kPlane;
    closure.name = std::to_string(a);
    closure.a = {moving[a], fixtures::vectorOf(sample.vector()), {}};
    closure.b = {moving[a + 2], fixtures::vectorOf(sample.vector()), {}};
    closure.length = scene::Rational(5, 3);
    m.closures.push_back(closure);
  }
  return m;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(undoes_lagrange)

BOOST_DATA_TEST_CASE(forward_dynamics_of_turns_and_slides, data::xrange(kSeeds), seed) {
  const Wrist turns(wrist(seed, 5), seed);
  BOOST_TEST(turns.model.plain_joints);
  requireBothWays(turns);
}

BOOST_DATA_TEST_CASE(forward_dynamics_with_screws, data::xrange(kSeeds), seed) {
  const Wrist screws(wrist(seed, 5, true), seed);
  BOOST_TEST(!screws.model.plain_joints);
  requireBothWays(screws);
}

BOOST_DATA_TEST_CASE(forward_dynamics_with_followers, data::xrange(2 * kSeeds), seed) {
  const Wrist coupled(wrist(seed, 6, seed % 2 == 1, 2), seed);
  BOOST_TEST(coupled.model.coupled);
  BOOST_TEST(coupled.model.dof() == 4);
  requireBothWays(coupled);
}

// some qdd given, the others' tau: each comes back; with constraints whose forces are known
BOOST_DATA_TEST_CASE(hybrid_dynamics, data::xrange(kSeeds) * data::make({false, true}), seed,
                     constrained) {
  Wrist w(wrist(seed, 6, seed % 2 == 1), seed);
  fixtures::Sampler sample(seed);
  std::vector<Q> expected = w.lagrange();
  std::vector<LinkConstraint<Q>> held;
  VectorX<Q> nu(constrained ? 2 : 0);
  if (constrained) {
    LinkConstraint<Q> one;
    one.link = static_cast<int>(w.model.links.size()) - 1;
    one.A.resize(6, 2);
    one.b.resize(2);
    for (int k = 0; k < 2; ++k) {
      one.A.col(k) << sample.vector(), sample.vector();
      nu(k) = sample.rational();
    }
    // A' a at the state's qdd, without gravity's share
    std::vector<Q> same = expected;
    inverseDynamics(w.model, w.state.x, w.state.qd, w.state.qdd, w.ws, same);
    Matrix3<Q> R = Matrix3<Q>::Identity();
    for (int i = one.link; i >= 0; i = w.model.links[i].parent) R = R * w.ws.X_up[i].R;
    Motion<Q> a = w.ws.a[one.link];
    a.linear += R * w.model.gravity;
    one.b = one.A.transpose() * a.vector();
    held.push_back(one);
    MatrixX<Q> J(2, w.model.dof());
    taskJacobian(w.model, held, w.ws, J);
    for (int i = 0; i < w.model.dof(); ++i)
      for (int k = 0; k < 2; ++k) expected[i] -= J(k, i) * nu(k);
  }
  const std::vector<char> driven = {0, 1, 0, 0, 1, 0};
  std::vector<Q> qdd(6, Q(0)), tau(6, Q(0));
  for (int i = 0; i < 6; ++i)
    (driven[i] ? qdd[i] : tau[i]) = driven[i] ? w.state.qdd[i] : expected[i];
  ConstraintWorkspace<Q> cws(w.model, static_cast<int>(nu.size()));
  hybridDynamics(w.model, w.state.x, w.state.qd, driven, held, w.ws, cws, qdd, tau);
  BOOST_TEST(mismatch(qdd, w.state.qdd) == "");
  BOOST_TEST(mismatch(tau, expected) == "");
  BOOST_TEST(mismatch(cws.nu, nu) == "");
}

// Which loops are closed where, in the case below: some at links that move, so that the local road
// is seen, and some at the world.
BOOST_AUTO_TEST_CASE(loops_of_the_next_case_close_at_moving_links_too) {
  int at_links = 0, at_world = 0;
  for (int seed = 0; seed < 2 * kSeeds; ++seed) {
    const Wrist w(closedWrist(seed), seed);
    for (const auto& group :
         recursive::detail::loopGroups(w.model, buildConstraints(w.m, w.number, w.model), false))
      ++(group.ancestor < 0 ? at_world : at_links);
  }
  BOOST_TEST(at_links >= 4);
  BOOST_TEST(at_world >= 2);
}

// Not closed at this state, which the equations do not ask for: J qdd + gamma = 0, and Lagrange's
// tau of that qdd is what was given and J' lambda: two conditions that only one qdd obeys.
BOOST_DATA_TEST_CASE(closed_forward_dynamics, data::xrange(2 * kSeeds) * data::make({false, true}),
                     seed, at_base) {
  Wrist w(closedWrist(seed), seed);
  auto closures = buildConstraints(w.m, w.number, w.model);
  constraintEquations(w.model, w.state.x, w.state.qd, w.ws, closures);
  const auto found =
      closedForwardDynamics(w.model, w.state.x, w.state.qd, w.state.tau, closures, w.ws, at_base);
  SemidefiniteSolver<Q> of_J(2);
  of_J.factorize(closures.J * closures.J.transpose());
  BOOST_TEST(found.rank == of_J.rank());
  const Eigen::Map<const VectorX<Q>> qdd(found.qdd.data(), 6), tau(w.state.tau.data(), 6);
  BOOST_TEST(mismatch(VectorX<Q>(closures.J * qdd), VectorX<Q>(-closures.gamma)) == "");
  w.state.qdd = found.qdd;
  const std::vector<Q> needed = w.lagrange();
  const VectorX<Q> given = tau + closures.J.transpose() * found.lambda;
  BOOST_TEST(mismatch(Eigen::Map<const VectorX<Q>>(needed.data(), 6), given) == "");
}

BOOST_AUTO_TEST_SUITE_END()
