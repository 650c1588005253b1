// SPDX-License-Identifier: GPL-3.0-or-later
// Rotors geared to all rates of a joint: by hand, as links of their own that gears hold, and by
// Lagrange's equations over the rationals.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/regressor.hpp"
#include "scene/own_rates.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/wrist.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using crosscheck::Direction;
using crosscheck::Dual;
using fixtures::mismatch;
using fixtures::numberOf;
using fixtures::Q;
using fixtures::Wrist;

namespace {

constexpr int kSeeds = 3;
/// From cylindrical to floating: all of several rates.
const auto kKinds = data::xrange(static_cast<int>(JointKind::kCylindrical),
                                 static_cast<int>(JointKind::kFloating) + 1);

/// A random tree with all that acts on joints, whose joint that most others carry is of this kind
/// and has two plain and two gyroscopic rotors: which fewer than its rates tell from a full matrix.
/// @param slanted  their axes are none of the joint frame's
scene::Mechanism geared(int kind_number, std::uint64_t seed, bool slanted) {
  const auto kind = static_cast<JointKind>(kind_number);
  fixtures::Sampler sample(seed + 31);
  scene::Mechanism m;
  std::size_t deepest = 0;
  for (int most = 0; most < 3; seed += 100) {  // what is across one axis is felt by another
    m = fixtures::wrist(seed, 5);
    std::vector<int> inboard(m.links.size(), 0);  // moving joints
    for (std::size_t i = 1; i < m.links.size(); ++i) {
      inboard[i] = inboard[static_cast<std::size_t>(m.links[i].parent)] +
                   (m.links[i].joint.kind == JointKind::kFixed ? 0 : 1);
      if (inboard[i] <= most || m.links[i].joint.kind == JointKind::kFixed) continue;
      most = inboard[i];
      deepest = i;
    }
  }
  scene::Link& link = m.links[deepest];
  scene::Joint joint;
  joint.kind = kind;
  joint.name = link.joint.name;
  if (link.joint.placement.convention == scene::Placement::Convention::kXyzRpy)
    joint.placement = link.joint.placement;
  for (int i = 0; i < 4; ++i) {
    scene::Rotor rotor;
    rotor.inertia = numberOf(sample.positive());
    for (int k = 0; k < scene::degreesOfFreedom(kind); ++k)
      rotor.ratio.push_back(numberOf(sample.rational()));
    if (i >= 2)
      rotor.axis = slanted ? fixtures::vectorOf(sample.axis())
                           : scene::Vector{scene::Number(i == 2 ? -3 : 0), scene::Number(0),
                                           scene::Number(i == 2 ? 0 : 2)};
    joint.rotors.push_back(rotor);
  }
  link.joint = joint;
  return m;
}

std::vector<Q> newtonEuler(const Model<Q>& model, const scene::State<Q>& state,
                           const std::vector<Q>& qd, const std::vector<Q>& qdd) {
  Workspace<Q> ws(model);
  std::vector<Q> tau(qd.size(), Q(0));
  inverseDynamics(model, state.x, qd, qdd, ws, tau);
  return tau;
}

/// G: the tree's rates of the mechanism's.
MatrixX<Q> gears(const scene::Mechanism& m, const fixtures::RationalNumbers& number, int rates) {
  MatrixX<Q> G = MatrixX<Q>::Constant(rates, m.dof(), Q(0));
  for (int i = 0; i < m.dof(); ++i) G(i, i) = Q(1);
  int first = 0, row = m.dof();
  for (const scene::Link& link : m.links) {
    for (const scene::Rotor& rotor : link.joint.rotors) {
      for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
        G(row, first + static_cast<int>(k)) = number(rotor.ratio[k]);
      ++row;
    }
    first += link.joint.ownRates();
  }
  return G;
}

std::vector<Q> times(const MatrixX<Q>& A, const std::vector<Q>& x) {
  std::vector<Q> out(static_cast<std::size_t>(A.rows()), Q(0));
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j)
      out[static_cast<std::size_t>(i)] += A(i, j) * x[static_cast<std::size_t>(j)];
  return out;
}

scene::Mechanism read(const std::string& text) {
  return scene::readSceneToml(text, "rotors.toml").mechanism;
}

/// A table that turns about y, one on it about z, and on that a body on a universal joint with
/// this rotor.
scene::Mechanism tables(const std::string& rotors) {
  return read(
      "[[link]]\nname = \"base\"\n"
      "[[link]]\nname = \"outer\"\nparent = \"base\"\nmass = 2\ninertia = { xx = 1, yy = 1, zz = 1 "
      "}\n[link.joint]\nkind = \"revolute\"\naxis = [0, 1, 0]\n"
      "[[link]]\nname = \"inner\"\nparent = \"outer\"\nmass = 3\ninertia = { xx = 2, yy = 2, zz = 2 "
      "}\n[link.joint]\nkind = \"revolute\"\n"
      "[[link]]\nname = \"body\"\nparent = \"inner\"\nmass = 1\ninertia = { xx = 1, yy = 2, zz = 2.5 "
      "}\n[link.joint]\nkind = \"universal\"\n" +
      rotors);
}

/// What the rotors add to tau at q = 0.
std::vector<double> added(const std::string& rotors, const std::vector<double>& qd,
                          const std::vector<double>& qdd) {
  std::vector<double> out;
  for (const std::string& line : {rotors, std::string()}) {
    const scene::Mechanism m = tables(line);
    const auto model = buildModel(m, scene::RealNumbers<double>(m));
    Workspace<double> ws(model);
    std::vector<double> tau(4);
    inverseDynamics<double>(model, std::vector<JointPosition<double>>(4, {0, 1, 0}), qd, qdd, ws,
                            tau);
    if (out.empty())
      out = tau;
    else
      for (int i = 0; i < 4; ++i) out[i] -= tau[i];
  }
  return out;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand: D = J [3^2 + 1, 3 2 + 1 (-1); ., 2^2 + 1] with J = 0.5
BOOST_AUTO_TEST_CASE(plain_rotors_add_a_full_matrix_and_no_velocity_products) {
  const std::vector<double> tau =
      added("rotors = [{ inertia = 0.5, ratio = [3, 2] }, { inertia = 0.5, ratio = [1, -1] }]\n",
            {7, -2, 3, 5}, {1, 2, 4, -8});
  const std::vector<double> expected = {0, 0, 0.5 * (10 * 4 + 5 * -8), 0.5 * (5 * 4 + 5 * -8)};
  for (int i = 0; i < 4; ++i) BOOST_TEST(std::abs(tau[i] - expected[i]) < 1e-12);
}

// By hand: h = J psi' x on the inner table, which turns with w = (0, u, v) at q = 0, u' = v' = 0
// but w' = u y x v z = u v x: its moment w x h + J psi'' x = J psi' (v y - u z) + J psi'' x, of
// which the tables' motors give y and z; and the rotor's own equation J (psi'' + u v), n times.
BOOST_AUTO_TEST_CASE(a_gyroscopic_rotor_on_a_turntable) {
  const double u = 7, v = -2, J = 0.5, rate = 3 * 3 + 2 * 5, acceleration = 3 * 4 + 2 * -8;
  const std::vector<double> tau =
      added("rotors = [{ inertia = 0.5, ratio = [3, 2], axis = [4, 0, 0] }]\n", {u, v, 3, 5},
            {0, 0, 4, -8});
  const std::vector<double> expected = {J * rate * v, -J * rate * u, 3 * J * (acceleration + u * v),
                                        2 * J * (acceleration + u * v)};
  for (int i = 0; i < 4; ++i) BOOST_TEST(std::abs(tau[i] - expected[i]) < 1e-12);
}

// By hand: rates of a ball are no derivatives, and still D w' is all that plain rotors ask for
BOOST_AUTO_TEST_CASE(no_term_of_hamel_on_a_ball_joint) {
  const scene::Mechanism m = read(
      "[[link]]\nname = \"base\"\n[[link]]\nname = \"ball\"\nparent = \"base\"\nmass = 1\n"
      "inertia = { xx = 1, yy = 1, zz = 1 }\n[link.joint]\nkind = \"spherical\"\n"
      "rotors = [{ inertia = 0.5, ratio = [3, 2, 0] }]\n");
  const fixtures::RationalNumbers number(m);
  const symbolic::Equations e = symbolic::derive(m);
  scene::State<Q> state;
  state.x.assign(4, {Q(0), Q(1), Q(0)});
  state.x[0].q = Q(1);
  state.qd = {Q(5), Q(-7), Q(11)};
  const std::vector<Q> c = symbolic::ProgramRun<Q>(symbolic::compile(e.graph, e.c), number)(state);
  BOOST_TEST(mismatch(c, std::vector<Q>(3, Q(0))) == "");
  const auto model = buildModel(m, number);
  BOOST_TEST(mismatch(newtonEuler(model, state, state.qd, {Q(1), Q(1), Q(1)}),
                      std::vector<Q>{Q(1) + Q(15) / 2, Q(1) + Q(5), Q(1)}) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(lagrange)

BOOST_DATA_TEST_CASE(inverse_and_forward_dynamics, data::xrange(kSeeds) * kKinds, seed, kind) {
  Wrist w(geared(kind, static_cast<std::uint64_t>(seed), true), static_cast<std::uint64_t>(seed));
  const std::vector<Q> tau = w.lagrange();
  BOOST_TEST(mismatch(newtonEuler(w.model, w.state, w.state.qd, w.state.qdd), tau) == "");
  std::vector<Q> qdd = tau;
  forwardDynamics(w.model, w.state.x, w.state.qd, tau, w.ws, qdd);
  BOOST_TEST(mismatch(qdd, w.state.qdd) == "");
}

BOOST_DATA_TEST_CASE(mass_matrix_and_kinetic_energy, data::xrange(kSeeds) * kKinds, seed, kind) {
  Wrist w(geared(kind, static_cast<std::uint64_t>(seed), true), static_cast<std::uint64_t>(seed));
  const symbolic::Equations e = symbolic::derive(w.m);
  std::vector<symbolic::Node> wanted = {e.kinetic};
  for (const auto& row : e.M) wanted.insert(wanted.end(), row.begin(), row.end());
  const std::vector<Q> expected =
      symbolic::ProgramRun<Q>(symbolic::compile(e.graph, wanted), w.number)(w.state);
  const int n = w.model.dof();
  MatrixX<Q> M(n, n);
  massMatrix(w.model, w.state.x, w.ws, M);
  std::vector<Q> swept = {kineticEnergy(w.model, w.state.x, w.state.qd, w.ws)};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) swept.push_back(M(i, j));
  BOOST_TEST(mismatch(swept, expected) == "");
}

BOOST_DATA_TEST_CASE(derivatives, data::xrange(2) * kKinds, seed, kind) {
  const Wrist w(geared(kind, static_cast<std::uint64_t>(seed), true),
                static_cast<std::uint64_t>(seed));
  DerivativesWorkspace<Q> room(w.model);
  InverseDynamicsDerivatives<Q> swept(w.model);
  inverseDynamicsDerivatives(w.model, w.state.x, w.state.qd, w.state.qdd, room, swept);
  const symbolic::Program program = w.program();
  symbolic::ProgramRun<Dual<Q>> run(program,
                                    crosscheck::DualNumbers<fixtures::RationalNumbers>(w.number));
  const int n = w.model.dof();
  for (const auto& [part, matrix] :
       {std::pair<std::vector<Q> Direction<Q>::*, MatrixX<Q>>(&Direction<Q>::q, swept.dtau_dq),
        {&Direction<Q>::qd, swept.dtau_dqd},
        {&Direction<Q>::qdd, swept.M}})
    for (int k = 0; k < n; ++k) {
      Direction<Q> unit;
      (unit.*part).assign(static_cast<std::size_t>(n), Q(0));
      (unit.*part)[static_cast<std::size_t>(k)] = Q(1);
      std::vector<Q> by_duals, column;
      for (const Dual<Q>& x : run(crosscheck::moving(w.model, w.state, unit)))
        by_duals.push_back(x.derivative);
      for (int i = 0; i < n; ++i) column.push_back(matrix(i, k));
      BOOST_TEST(mismatch(column, by_duals) == "");
    }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(roads)

// each rotor a link of its own, and G the gears: tau = G' tau_tree(G qd, G qdd)
BOOST_DATA_TEST_CASE(rotors_as_links_that_gears_hold, data::xrange(kSeeds) * kKinds, seed, kind) {
  const Wrist w(geared(kind, static_cast<std::uint64_t>(seed), false),
                static_cast<std::uint64_t>(seed));
  const scene::Mechanism tree = scene::withOwnRates(w.m);
  const Model<Q> model = buildModel(tree, w.number);
  BOOST_TEST(model.rotors.empty());
  BOOST_TEST(model.dof() == w.model.dof() + 4);
  const MatrixX<Q> G = gears(w.m, w.number, model.dof());
  scene::State<Q> state = w.state;
  state.x.resize(static_cast<std::size_t>(model.positions), {Q(2), Q(3) / 5, Q(4) / 5});
  const std::vector<Q> of_tree =
      times(G.transpose(), newtonEuler(model, state, times(G, w.state.qd), times(G, w.state.qdd)));
  // friction and springs alike: rotors have none
  BOOST_TEST(mismatch(newtonEuler(w.model, w.state, w.state.qd, w.state.qdd), of_tree) == "");
}

BOOST_DATA_TEST_CASE(coriolis_matrix, data::xrange(kSeeds) * kKinds, seed, kind) {
  Wrist w(geared(kind, static_cast<std::uint64_t>(seed), true), static_cast<std::uint64_t>(seed));
  const MatrixX<Q> C = coriolisMatrix(w.model, w.state.x, w.state.qd, w.ws);
  std::vector<Q> c = w.state.qd;
  inverseDynamics(w.model, w.state.x, w.state.qd, std::vector<Q>(c.size(), Q(0)), w.ws, c,
                  Terms::none());
  BOOST_TEST(mismatch(times(C, w.state.qd), c) == "");
}

BOOST_DATA_TEST_CASE(regressor_times_parameters, data::xrange(kSeeds) * kKinds, seed, kind) {
  Wrist w(geared(kind, static_cast<std::uint64_t>(seed), true), static_cast<std::uint64_t>(seed));
  const auto parameters = scene::inertialParameters(w.m);
  MatrixX<Q> Y(w.model.dof(), static_cast<Eigen::Index>(parameters.size()));
  regressor(w.model, parameters, w.state.x, w.state.qd, w.state.qdd, w.ws, Y);
  Terms inertial = Terms::none();
  inertial.gravity = true;
  std::vector<Q> tau = w.state.qd;
  inverseDynamics(w.model, w.state.x, w.state.qd, w.state.qdd, w.ws, tau, inertial);
  BOOST_TEST(mismatch(times(Y, inertialValues(w.m, parameters, w.number)), tau) == "");
}

BOOST_AUTO_TEST_SUITE_END()
