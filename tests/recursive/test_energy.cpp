// SPDX-License-Identifier: GPL-3.0-or-later
#include "recursive/energy.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/dual.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using crosscheck::Dual;
using crosscheck::DualNumbers;
using fixtures::mismatch;
using fixtures::Q;
using fixtures::V3;
using D = Dual<Q>;

namespace {

constexpr int kSeeds = 10, kMoving = 6;

/// Place [m] and velocity [m/s] of a mass point in the world.
struct MovingPoint {
  Q mass;
  V3<Q> r, v;
};

/// All mass points of a tree in motion: plain geometry, differentiated by dual numbers.
std::vector<MovingPoint> movingPoints(const fixtures::Tree& tree, const scene::State<Q>& state) {
  std::vector<JointPosition<D>> x;
  for (std::size_t i = 0; i < state.x.size(); ++i)
    x.push_back(crosscheck::moving(state.x[i], state.qd[i]));
  const auto poses = fixtures::linkPoses(tree.mechanism, x);
  std::vector<MovingPoint> points;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (const fixtures::Point& point : tree.clouds[i]) {
      const V3<D> r = fixtures::placeOf(poses[i], point.at);
      points.push_back({point.mass,
                        {r(0).value, r(1).value, r(2).value},
                        {r(0).derivative, r(1).derivative, r(2).derivative}});
    }
  return points;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand: T = m l^2 qd^2 / 2 and V = -m g l cos q + k (q - rest)^2 / 2 of a pendulum with a
// spring.
BOOST_AUTO_TEST_CASE(a_pendulum_has_its_textbook_energies) {
  scene::Mechanism m;
  m.has_gravity = true;
  m.gravity = {scene::Number(0), scene::Number(0), scene::Number(-10)};
  m.links.resize(2);
  scene::Link& bob = m.links[1];
  bob.parent = 0;
  bob.joint.kind = JointKind::kRevolute;
  bob.joint.axis = {scene::Number(0), scene::Number(1), scene::Number(0)};
  bob.joint.stiffness = scene::Number(8);
  bob.joint.rest = scene::Number(1);
  bob.inertia.mass = scene::Number(3);
  bob.inertia.com = {scene::Number(0), scene::Number(0), scene::Number(-2)};
  const Model<Q> model = buildModel(m, fixtures::RationalNumbers(m));
  Workspace<Q> ws(model);
  const std::vector<JointPosition<Q>> x = {{Q(5), Q(3) / 5, Q(4) / 5}};
  BOOST_TEST(kineticEnergy(model, x, {Q(7)}, ws) == Q(3 * 4 * 49) / 2);
  BOOST_TEST(potentialEnergy(model, x, ws) == Q(-3 * 10 * 2 * 3) / 5 + Q(8 * 16) / 2);
  // the velocity of the bob: l qd along the tangent, which points to -x at q = 0
  const Force<Q> p = momentum(model, x, {Q(7)}, ws);
  BOOST_TEST(mismatch(p.force, V3<Q>(Q(-3 * 14 * 3) / 5, 0, Q(3 * 14 * 4) / 5)) == "");
  BOOST_TEST(mismatch(p.moment, V3<Q>(0, 3 * 4 * 7, 0)) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// Sums over mass points: T = sum m v'v / 2, V = -sum m gravity'r, p = sum m v, L = sum r x m v;
// rotors and springs are added by their definition. The world's own links count in V.
BOOST_DATA_TEST_CASE(energies_and_momentum_are_the_sums_over_mass_points, data::xrange(kSeeds),
                     seed) {
  const fixtures::Tree tree = fixtures::randomTree(kMoving, seed);
  const scene::Mechanism& m = tree.mechanism;
  const fixtures::RationalNumbers number(m);
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const V3<Q> gravity = fixtures::rationalVector(m, m.gravity);
  Q kinetic = 0, potential = 0;
  Force<Q> total = Force<Q>::zero();
  for (const MovingPoint& point : movingPoints(tree, state)) {
    kinetic += point.mass * point.v.dot(point.v) / Q(2);
    potential -= point.mass * gravity.dot(point.r);
    total.force += point.v * point.mass;
    total.moment += point.r.cross(V3<Q>(point.v * point.mass));
  }
  std::size_t dof = 0;
  for (const int i : m.movingLinks()) {
    const scene::Joint& joint = m.links[static_cast<std::size_t>(i)].joint;
    const Q rate = number(joint.gear_ratio) * state.qd[dof];
    const Q stretch = state.x[dof].q - number(joint.rest);
    kinetic += number(joint.rotor_inertia) * rate * rate / Q(2);
    potential += number(joint.stiffness) * stretch * stretch / Q(2);
    ++dof;
  }
  for (const FixedJoints fixed_joints : {FixedJoints::kLumped, FixedJoints::kKept}) {
    const Model<Q> model = buildModel(m, number, fixed_joints);
    Workspace<Q> ws(model);
    BOOST_TEST(kineticEnergy(model, state.x, state.qd, ws) == kinetic);
    BOOST_TEST(potentialEnergy(model, state.x, ws) == potential);
    BOOST_TEST(mismatch(momentum(model, state.x, state.qd, ws).vector(), total.vector()) == "");
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(conservation)

// Newton's and Euler's laws for the whole: a floating mechanism without joint forces changes its
// momentum by its weight alone,  dp/dt = m g,  dL/dt = (sum m r) x g;  without gravity not at all.
// qdd comes from the articulated-body sweep, the rate from dual numbers, the weight from the
// points.
BOOST_DATA_TEST_CASE(only_the_weight_changes_the_momentum_of_a_floating_mechanism,
                     data::xrange(6) * data::make({false, true}), seed, gravity) {
  const fixtures::Tree tree = fixtures::floatingTree(3, static_cast<std::uint64_t>(seed), gravity);
  const scene::Mechanism& m = tree.mechanism;
  const fixtures::RationalNumbers number(m);
  const int n = m.dof();
  const scene::State<Q> state = fixtures::randomState(n, static_cast<std::uint64_t>(seed));
  const Model<Q> model = buildModel(m, number);
  Workspace<Q> ws(model);
  std::vector<Q> qdd(static_cast<std::size_t>(n));
  // joint forces inside act and react: they change no total; those of the six floating joints are 0
  std::vector<Q> tau = state.tau;
  for (std::size_t i = 0; i < 6; ++i) tau[i] = 0;
  forwardDynamics(model, state.x, state.qd, tau, ws, qdd);

  const DualNumbers<fixtures::RationalNumbers> dual_numbers(number);
  const Model<D> moving_model = buildModel(m, dual_numbers);
  Workspace<D> moving_ws(moving_model);
  std::vector<JointPosition<D>> x;
  std::vector<D> qd;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    x.push_back(crosscheck::moving(state.x[i], state.qd[i]));
    qd.push_back({state.qd[i], qdd[i]});
  }
  const Force<D> total = momentum(moving_model, x, qd, moving_ws);

  Force<Q> weight = Force<Q>::zero();
  Q momentum_size = 0;
  if (gravity) {
    const V3<Q> g = fixtures::rationalVector(m, m.gravity);
    for (const MovingPoint& point : movingPoints(tree, state)) {
      weight.force += g * point.mass;
      weight.moment += point.r.cross(V3<Q>(g * point.mass));
    }
  }
  V3<Q> force_rate, moment_rate;
  for (int k = 0; k < 3; ++k) {
    force_rate(k) = total.force(k).derivative;
    moment_rate(k) = total.moment(k).derivative;
    momentum_size += abs(total.force(k).value) + abs(total.moment(k).value);
  }
  BOOST_TEST(momentum_size > 0);
  BOOST_TEST(mismatch(force_rate, weight.force) == "");
  BOOST_TEST(mismatch(moment_rate, weight.moment) == "");
}

BOOST_AUTO_TEST_SUITE_END()
