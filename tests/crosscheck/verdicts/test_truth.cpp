// SPDX-License-Identifier: GPL-3.0-or-later
// The certified truth against closed forms (exact rationals, Boost's decimal floats) and against
// the derived programs, which share no formula with the sweeps that it runs.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <boost/multiprecision/cpp_dec_float.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using scene::Rational;
using Decimal = boost::multiprecision::cpp_dec_float_100;
namespace data = boost::unit_test::data;

namespace {

scene::Mechanism mechanism(const std::string& toml) {
  return scene::readSceneToml("title = \"t\"\nsource = \"this test\"\n" + toml, "t.toml").mechanism;
}

scene::State<double> state(const std::vector<double>& q, const std::vector<double>& qd = {},
                           const std::vector<double>& qdd = {},
                           const std::vector<double>& tau = {}) {
  scene::State<double> s;
  const std::vector<double> zeros(q.size(), 0.0);
  for (const double x : q) s.x.push_back(scene::jointPosition(x));
  s.qd = qd.empty() ? zeros : qd;
  s.qdd = qdd.empty() ? zeros : qdd;
  s.tau = tau.empty() ? zeros : tau;
  return s;
}

/// A point mass of 0.3 kg, 0.7 m below its pivot about y; q = 0 hangs straight down.
const char* const kPendulum = R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "bob"
parent = "base"
mass = 0.3
com = [0, 0, -0.7]
[link.joint]
name = "pivot"
kind = "revolute"
axis = [0, 1, 0]
)";

/// Two point masses: 2 kg at 1 m, and 1 kg at `com` from a joint 1 m further.
std::string twoLinks(const std::string& axis, const std::string& com) {
  return R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 2
com = [0, 0, -1]
[link.joint]
name = "shoulder"
kind = "revolute"
axis = [0, 1, 0]
[[link]]
name = "lower"
parent = "upper"
mass = 1
com = )" +
         com +
         R"(
[link.joint]
name = "elbow"
kind = "revolute"
xyz = [0, 0, -1]
axis = )" +
         axis + "\n";
}

double distance(const Ball& ball, const Decimal& value) {
  const BallPrecision precision(512);
  return (ball - Ball(static_cast<Rational>(value))).atMost();
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) names.push_back(file.stem().string());
  return names;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(pendulum_mass_is_m_l_squared) {
  Truth truth(mechanism(kPendulum));
  const Certified M = truth(Quantity::kM, state({1.25}));
  BOOST_REQUIRE(M.isSharp());
  BOOST_TEST(M.value(0, 0).contains(Rational(147, 1000)));
  BOOST_TEST(M.value(0, 0).isSharp(100));
}

BOOST_AUTO_TEST_CASE(pendulum_gravity_is_m_g_l_sin_q_to_thirty_digits) {
  Truth truth(mechanism(kPendulum), 110);
  for (const double q : {0.1, 1.25, -3.0, 1e-9}) {
    const Certified g = truth(Quantity::kg, state({q}));
    BOOST_REQUIRE(g.isSharp());
    const Decimal expected = Decimal("2.0601") * sin(Decimal(q));  // 0.3 9.81 0.7
    BOOST_TEST(distance(g.value(0, 0), expected) < 1e-30 * std::abs(std::sin(q)));
  }
}

BOOST_AUTO_TEST_CASE(double_pendulum_accelerations_follow_the_textbook) {
  // point masses 2 kg and 1 kg on rods of 1 m; relative angles; solved by Cramer's rule
  Truth truth(mechanism(twoLinks("[0, 1, 0]", "[0, 0, -1]")), 110);
  const double q1 = 0.6, q2 = -2.0, u1 = 1.5, u2 = -0.25, t1 = 3.0, t2 = -0.5;
  const Certified qdd = truth(Quantity::kQdd, state({q1, q2}, {u1, u2}, {}, {t1, t2}));
  BOOST_REQUIRE(qdd.isSharp());
  const Decimal c2 = cos(Decimal(q2)), s2 = sin(Decimal(q2)), g("9.81");
  const Decimal M11 = 4 + 2 * c2, M12 = 1 + c2, M22 = 1;
  const Decimal g2 = g * sin(Decimal(q1) + Decimal(q2)), g1 = 3 * g * sin(Decimal(q1)) + g2;
  const Decimal b1 = t1 - (-s2 * (2 * Decimal(u1) * u2 + Decimal(u2) * u2)) - g1;
  const Decimal b2 = t2 - s2 * u1 * u1 - g2;
  const Decimal det = M11 * M22 - M12 * M12;
  BOOST_TEST(distance(qdd.value(0, 0), (M22 * b1 - M12 * b2) / det) < 1e-30);
  BOOST_TEST(distance(qdd.value(1, 0), (M11 * b2 - M12 * b1) / det) < 1e-30);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// 2 states a scene: the programs and the sweeps have no formula in common
BOOST_DATA_TEST_CASE(truth_overlaps_the_derived_programs_on_balls, data::make(sceneNames()), name) {
  const scene::Scene scene = scene::findScene(name);
  symbolic::Options options;
  options.fold_parameters = true;
  symbolic::Equations e = symbolic::derive(scene.mechanism, options);
  std::vector<symbolic::Node> M;
  for (const auto& row : e.M) M.insert(M.end(), row.begin(), row.end());
  const std::vector<std::pair<Quantity, std::vector<symbolic::Node>>> derived = {
      {Quantity::kM, M},
      {Quantity::kc, e.c},
      {Quantity::kg, e.g},
      {Quantity::kTau, symbolic::inverseDynamics(e)},
      {Quantity::kKinetic, {e.kinetic}},
      {Quantity::kPotential, {e.potential}}};
  Truth truth(scene.mechanism);
  const BallPrecision precision(256);
  for (const auto& [quantity, nodes] : derived) {
    const symbolic::Program program = symbolic::compile(e.graph, nodes);
    symbolic::ProgramRun<Ball> run(program, BallNumbers(scene.mechanism));
    for (int k = 0; k < 2; ++k) {
      const scene::State<double> at = drawState(scene.mechanism, scene.name, 1, k);
      const Certified certified = truth(quantity, at);
      BOOST_REQUIRE(certified.exists());
      MatrixX<Ball> by_sweep = certified.value;
      by_sweep.transposeInPlace();  // the program's M is written row by row
      const std::vector<Ball> by_program = run(ballState(at, scene.mechanism));
      for (std::size_t i = 0; i < by_program.size(); ++i)
        BOOST_TEST((by_program[i] - by_sweep.data()[i]).containsZero(),
                   crosscheck::name(quantity)
                       << " number " << i << " at state " << k << ": " << by_program[i].text()
                       << " and " << by_sweep.data()[i].text());
    }
  }
}

BOOST_DATA_TEST_CASE(forward_dynamics_undoes_inverse_dynamics, data::make(sceneNames()), name) {
  // tau is rounded to double on the way, so 16 digits and the condition of M are what must come
  // back
  const scene::Scene scene = scene::findScene(name);
  Truth truth(scene.mechanism);
  scene::State<double> at = drawState(scene.mechanism, scene.name, 3, 0);
  const Certified tau = truth(Quantity::kTau, at);
  for (std::size_t i = 0; i < at.tau.size(); ++i) at.tau[i] = tau.value(i, 0).mid();
  const Certified qdd = truth(Quantity::kQdd, at);
  BOOST_REQUIRE(qdd.isSharp());
  for (std::size_t i = 0; i < at.qdd.size(); ++i)
    BOOST_TEST(std::abs(qdd.value(i, 0).mid() - at.qdd[i]) < 1e-9);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(precision)

BOOST_AUTO_TEST_CASE(precision_is_doubled_until_the_enclosure_is_narrow) {
  // tau = m l (l qdd + g sin q) with qdd next to -g sin q / l: 53 bits cancel
  Truth truth(mechanism(kPendulum));
  const double q = 1.25;
  const Certified easy = truth(Quantity::kTau, state({q}, {}, {1.0}));
  BOOST_TEST(easy.bits == 128);
  const Certified hard = truth(Quantity::kTau, state({q}, {}, {-9.81 / 0.7 * std::sin(q)}));
  BOOST_REQUIRE(hard.isSharp());
  BOOST_TEST(hard.bits == 256);
  BOOST_TEST(hard.value(0, 0).isSharp(Truth::kAccuracy));
  BOOST_TEST(hard.value(0, 0).atMost() < 1e-14);
  BOOST_TEST(hard.value(0, 0).atLeast() > 0);
}

BOOST_AUTO_TEST_CASE(an_entry_that_is_zero_by_cancellation_is_left_when_it_is_negligible) {
  const scene::Scene scene = scene::findScene("puma_560");  // joint 1 is vertical: g_1 = 0
  Truth truth(scene.mechanism);
  const Certified g = truth(Quantity::kg, drawState(scene.mechanism, scene.name, 1, 0));
  BOOST_REQUIRE(g.exists());
  BOOST_TEST(!g.isSharp());
  BOOST_TEST(g.sharp_entries == 5);
  BOOST_TEST(g.bits == 256);
  BOOST_TEST(g.value(0, 0).containsZero());
  BOOST_TEST(g.value(0, 0).atMost() < 1e-48 * g.value(1, 0).atLeast());
  BOOST_TEST(contains(g.reason, "g[1] cannot be told from zero"), g.reason);
}

BOOST_AUTO_TEST_CASE(a_quantity_that_is_zero_throughout_says_so_at_the_last_precision) {
  // the axis is oblique and gravity is parallel to it
  Truth truth(mechanism(R"(
gravity = [-1, -2, -3]
[[link]]
name = "base"
[[link]]
name = "bob"
parent = "base"
mass = 0.3
com = [0.1, 0.2, 0.3]
inertia = { about = "com", xx = 1, yy = 1, zz = 1 }
[link.joint]
name = "pivot"
kind = "revolute"
axis = [1, 2, 3]
)"));
  const Certified g = truth(Quantity::kg, state({1.0}));
  BOOST_REQUIRE(g.exists());
  BOOST_TEST(!g.isSharp());
  BOOST_TEST(g.bits == Truth::kMaxBits);
  BOOST_TEST(g.value(0, 0).containsZero());
  BOOST_TEST(g.value(0, 0).atMost() < 1e-300);
  BOOST_TEST(contains(g.reason, "g cannot be told from zero: at 4096 bits"), g.reason);
}

BOOST_AUTO_TEST_CASE(a_structural_zero_is_exact) {
  Truth truth(mechanism(kPendulum));
  const Certified c = truth(Quantity::kc, state({1.25}, {2.0}));
  BOOST_TEST(c.isSharp());
  BOOST_TEST(c.value(0, 0).isZero());
  BOOST_TEST(c.reason.empty());
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(a_massless_tip_has_no_accelerations_and_the_joint_is_named) {
  scene::Mechanism m = mechanism(twoLinks("[0, 1, 0]", "[0, 0, -1]"));
  m.links[2].inertia.mass = scene::Number(0);  // a file that says so is refused by the reader
  Truth truth(m);
  const Certified qdd = truth(Quantity::kQdd, state({0.5, 0.25}, {1, 1}));
  BOOST_TEST(!qdd.exists());
  BOOST_TEST(!qdd.isSharp());
  BOOST_TEST(contains(qdd.reason, "M is singular: joint 'elbow'"), qdd.reason);
  BOOST_TEST(contains(qdd.reason, "D = 0"), qdd.reason);
  BOOST_TEST(qdd.bits == 128);  // more would not help
  const Certified M = truth(Quantity::kM, state({0.5, 0.25}));
  BOOST_REQUIRE(M.isSharp());
  BOOST_TEST(M.value(1, 1).isZero());
}

BOOST_AUTO_TEST_CASE(a_singularity_that_only_exact_arithmetic_could_see_is_reported_as_such) {
  // the point mass lies on the oblique axis of its joint: D = 0, but no term of it is
  scene::Mechanism m = mechanism(twoLinks("[0, 1, 0]", "[0, 0, -1]"));
  m.links[2].joint.axis = {scene::Number(1), scene::Number(2), scene::Number(3)};
  m.links[2].inertia.com = m.links[2].joint.axis;
  Truth truth(m);
  const Certified qdd = truth(Quantity::kQdd, state({0.5, 0.25}, {1, 1}));
  BOOST_TEST(!qdd.exists());
  BOOST_TEST(contains(qdd.reason, "joint 'elbow'"), qdd.reason);
  BOOST_TEST(contains(qdd.reason, "at 4096 bits"), qdd.reason);
}

BOOST_AUTO_TEST_SUITE_END()
