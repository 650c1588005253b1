// SPDX-License-Identifier: GPL-3.0-or-later
#include "recursive/articulated_body.hpp"

#include <cmath>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "recursive/build_model.hpp"
#include "recursive/newton_euler.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using fixtures::mismatch;
using fixtures::Q;

namespace {

constexpr int kSeeds = 10, kMoving = 6;

struct Sweeps {
  explicit Sweeps(const scene::Mechanism& m, FixedJoints fixed_joints = FixedJoints::kLumped)
      : model(buildModel(m, fixtures::RationalNumbers(m), fixed_joints)), ws(model) {}

  std::vector<Q> forward(const scene::State<Q>& state, const std::vector<Q>& tau,
                         Terms terms = Terms::all()) {
    std::vector<Q> qdd(static_cast<std::size_t>(model.dof()));
    forwardDynamics(model, state.x, state.qd, tau, ws, qdd, terms);
    return qdd;
  }
  std::vector<Q> inverse(const scene::State<Q>& state, const std::vector<Q>& qdd,
                         Terms terms = Terms::all()) {
    std::vector<Q> tau(static_cast<std::size_t>(model.dof()));
    inverseDynamics(model, state.x, state.qd, qdd, ws, tau, terms);
    return tau;
  }

  Model<Q> model;
  Workspace<Q> ws;
};

/// qdd at q = 0, qd = 0, tau = 0 of a scene beside the published tables.
std::vector<Q> released(const std::string& table_scene) {
  const scene::Scene scene =
      scene::readScene(std::string(DYNWITNESS_DATA_DIR) + "/reference/" + table_scene);
  const auto n = static_cast<std::size_t>(scene.mechanism.dof());
  scene::State<Q> state;
  state.x.assign(n, JointPosition<Q>{Q(0), Q(1), Q(0)});
  state.qd.assign(n, Q(0));
  return Sweeps(scene.mechanism).forward(state, std::vector<Q>(n, Q(0)));
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// Published by rbdl's tests (from Featherstone's spatial_v1), see data/reference/rbdl_*.json; the
// notes there give the exact fractions behind the printed decimals.
BOOST_AUTO_TEST_CASE(links_released_at_rest_fall_as_published) {
  const Q g = Q(981) / 100;
  BOOST_TEST(mismatch(released("rbdl_one_link_offset.toml"), {-g * 3 / 2 / (Q(25) / 4)}) == "");
  BOOST_TEST(mismatch(released("rbdl_two_links.toml"), {g * -3 / 5, g * 2 / 5}) == "");
  BOOST_TEST(mismatch(released("rbdl_three_links.toml"), {g * -8 / 13, g * 5 / 13, g * 2 / 13}) ==
             "");
}

// By hand: two slides along z, the outer one of mass m, the inner of mass M, forces F and f:
//   m (A + a) = f - m g,  M A = F - f - M g.
BOOST_DATA_TEST_CASE(two_stacked_slides_share_their_forces, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  const Q M = sample.positive(), m = sample.positive(), g = sample.positive();
  scene::Mechanism stack;
  stack.has_gravity = true;
  stack.gravity = {scene::Number(0), scene::Number(0), fixtures::numberOf(-g)};
  stack.links.resize(3);
  for (int i = 0; i < 2; ++i) {
    scene::Link& link = stack.links[static_cast<std::size_t>(i + 1)];
    link.parent = i;
    link.joint.kind = JointKind::kPrismatic;
    link.inertia.mass = fixtures::numberOf(i == 0 ? M : m);
  }
  const scene::State<Q> state = fixtures::randomState(2, seed);
  const Q F = state.tau[0], f = state.tau[1];
  const Q A = (F - f) / M - g;
  BOOST_TEST(mismatch(Sweeps(stack).forward(state, state.tau), {A, f / m - g - A}) == "");
}

// The numbers of test_newton_euler's chain of slides, backwards: every D is exactly 1 and every
// projected mass exactly 0 along z, so double arithmetic has nothing to round.
BOOST_AUTO_TEST_CASE(a_chain_of_100000_slides_accelerates_as_its_forces_ask) {
  constexpr int n = 100000;
  Model<double> model;
  model.gravity = {0, 0, -10};
  for (int i = 0; i < n; ++i) {
    LinkModel<double> link;
    link.parent = i - 1;
    link.dof = link.slot = i;
    link.kind = JointKind::kPrismatic;
    link.M = {1, {0, 0, 0}, Symmetric3<double>::zero()};
    model.links.push_back(link);
    model.link_of_dof.push_back(i);
    model.positions = i + 1;
  }
  Workspace<double> ws(model);
  const std::vector<JointPosition<double>> x(n, JointPosition<double>{0.5, 1, 0});
  const std::vector<double> qd(n, 3.0);
  std::vector<double> tau(n), qdd(n, 0.0);
  double carried = 0;
  for (int i = n - 1; i >= 0; --i) tau[static_cast<std::size_t>(i)] = carried += i + 11;
  forwardDynamics(model, x, qd, tau, ws, qdd);
  int wrong = 0;
  for (const double a : qdd) wrong += a == 1.0 ? 0 : 1;
  BOOST_TEST(wrong == 0);
}

// A chain that hangs straight down rests: gravity pulls along it and turns no joint.
BOOST_AUTO_TEST_CASE(a_hanging_chain_of_100000_hinges_rests) {
  constexpr int n = 100000;
  Model<double> model;
  model.gravity = {-9.81, 0, 0};  // down is -x; hinges about z, links along -x
  for (int i = 0; i < n; ++i) {
    LinkModel<double> link;
    link.parent = i - 1;
    link.dof = link.slot = i;
    link.kind = JointKind::kRevolute;
    if (i > 0) link.X_tree.p = {-1, 0, 0};
    link.M = RigidInertia<double>::aboutCenterOfMass(1, {-0.5, 0, 0}, {0.0, 0.25, 0.25, 0, 0, 0});
    model.links.push_back(link);
    model.link_of_dof.push_back(i);
    model.positions = i + 1;
  }
  Workspace<double> ws(model);
  std::vector<JointPosition<double>> x(n, JointPosition<double>{0, 1, 0});
  const std::vector<double> zeros(n, 0.0);
  std::vector<double> qdd(n, 1.0);
  forwardDynamics(model, x, zeros, zeros, ws, qdd);
  int moving = 0;
  for (const double a : qdd) moving += a == 0 ? 0 : 1;
  BOOST_TEST(moving == 0);
  // held aslant by 53 degrees at its first joint, it does not stay: the test can fail
  x[0] = {0.9272952180016122, 0.6, 0.8};
  forwardDynamics(model, x, zeros, zeros, ws, qdd);
  BOOST_TEST(qdd[0] < 0);
  BOOST_TEST(std::isfinite(qdd[n - 1]));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_DATA_TEST_CASE(forward_dynamics_inverts_inverse_dynamics, data::xrange(kSeeds), seed) {
  Sweeps sweeps(fixtures::randomTree(kMoving, seed).mechanism);
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  BOOST_TEST(mismatch(sweeps.forward(state, sweeps.inverse(state, state.qdd)), state.qdd) == "");
  BOOST_TEST(mismatch(sweeps.inverse(state, sweeps.forward(state, state.tau)), state.tau) == "");
}

BOOST_DATA_TEST_CASE(forward_dynamics_leaves_out_the_terms_that_inverse_dynamics_leaves_out,
                     data::xrange(3) * data::xrange(8), seed, mask) {
  const Terms terms = {(mask & 1) != 0, (mask & 2) != 0, (mask & 4) != 0};
  Sweeps sweeps(fixtures::randomTree(4, static_cast<std::uint64_t>(seed)).mechanism);
  const scene::State<Q> state = fixtures::randomState(4, static_cast<std::uint64_t>(seed));
  BOOST_TEST(mismatch(sweeps.forward(state, sweeps.inverse(state, state.qdd, terms), terms),
                      state.qdd) == "");
}

BOOST_DATA_TEST_CASE(lumping_fixed_joints_changes_no_acceleration, data::xrange(kSeeds), seed) {
  const scene::Mechanism m = fixtures::randomTree(kMoving, seed).mechanism;
  Sweeps lumped(m), kept(m, FixedJoints::kKept);
  BOOST_TEST(kept.model.links.size() > lumped.model.links.size());
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  BOOST_TEST(mismatch(lumped.forward(state, state.tau), kept.forward(state, state.tau)) == "");
}

BOOST_AUTO_TEST_SUITE_END()
