// SPDX-License-Identifier: GPL-3.0-or-later
// Lagrange's equations link by link: known answers, the other witnesses over the field, and
// mistakes.
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"

#include <algorithm>
#include <fstream>
#include <ostream>
#include <set>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/exact.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"
#include "tests/fixtures/planted.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::mismatch;
using fixtures::Q;

namespace {

constexpr int kSeeds = 5;
constexpr LagrangeTerms kAll = {true, true, true};

/// A link of a chain in the x-z plane: joint about y at the parent's (0, 0, -length), a point mass
/// at this link's (0, 0, -r). Angle zero hangs down.
scene::Link pendulumLink(int parent, const Q& offset, const Q& r, const Q& mass) {
  scene::Link link;
  link.parent = parent;
  link.joint.kind = scene::JointKind::kRevolute;
  link.joint.axis = {scene::Number(0), scene::Number(1), scene::Number(0)};
  link.joint.placement.xyz = {scene::Number(0), scene::Number(0), fixtures::numberOf(-offset)};
  link.inertia.mass = fixtures::numberOf(mass);
  link.inertia.com = {scene::Number(0), scene::Number(0), fixtures::numberOf(-r)};
  return link;
}
scene::Mechanism hanging(const Q& g) {
  scene::Mechanism m;
  m.has_gravity = true;
  m.gravity = {scene::Number(0), scene::Number(0), fixtures::numberOf(-g)};
  m.links.emplace_back();
  return m;
}

/// The exact comparisons of recursive_lagrange, changed, with the other witnesses.
std::vector<CheckResult> compared(const scene::Scene& scene, Parameters parameters,
                                  const fixtures::Planted<HomogeneousModel>& change) {
  ExactOptions options;
  options.parameters = parameters;
  std::vector<ExactWitness> witnesses = exactWitnesses(
      scene, parameters,
      selectWitnesses({"lagrange", "newton_euler", "composite_body", "articulated_body"}));
  witnesses.push_back(recursiveLagrangeWitness(scene, change));
  std::vector<CheckResult> checks;
  for (const CheckResult& check : compareExactly(scene, witnesses, options))
    if (check.right == "recursive_lagrange") checks.push_back(check);
  return checks;
}
const auto kNothing = [](auto&, const auto&) {};

std::string disputed(const std::vector<CheckResult>& checks) {
  std::set<std::string> quantities;
  for (const CheckResult& check : checks)
    if (check.verdict == Verdict::kDisagree) quantities.insert(check.quantity);
  std::string text;
  for (const std::string& quantity : quantities) text += (text.empty() ? "" : " ") + quantity;
  return text;
}

}  // namespace

// By hand, q2 relative to link 1 (Lagrange, any textbook), with point masses at both tips:
//   tau2 = m2 l2^2 (a1 + a2) + m2 l1 l2 (cos q2 a1 + sin q2 w1^2) + m2 g l2 sin(q1 + q2)
//   tau1 = tau2 + (m1 + m2) l1^2 a1 + m2 l1 l2 (cos q2 (a1 + a2) - sin q2 (w1 + w2)^2)
//          + (m1 + m2) g l1 sin q1
BOOST_DATA_TEST_CASE(a_double_pendulum_obeys_its_textbook_equations, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  const Q l1 = sample.positive(), l2 = sample.positive(), m1 = sample.positive(),
          m2 = sample.positive(), g = Q(981) / 100;
  scene::Mechanism two = hanging(g);
  two.links.push_back(pendulumLink(0, 0, l1, m1));
  two.links.push_back(pendulumLink(1, l1, l2, m2));
  const scene::State<Q> state = fixtures::randomState(2, seed);
  const Q w1 = state.qd[0], w2 = state.qd[1], a1 = state.qdd[0], a2 = state.qdd[1];
  const Q s1 = state.x[0].s, c1 = state.x[0].c, s2 = state.x[1].s, c2 = state.x[1].c;
  const Q s12 = s1 * c2 + c1 * s2, w12 = w1 + w2;
  const Q tau2 =
      m2 * l2 * l2 * (a1 + a2) + m2 * l1 * l2 * (c2 * a1 + s2 * w1 * w1) + m2 * g * l2 * s12;
  const Q tau1 = tau2 + (m1 + m2) * l1 * l1 * a1 +
                 m2 * l1 * l2 * (c2 * (a1 + a2) - s2 * w12 * w12) + (m1 + m2) * g * l1 * s1;
  HomogeneousModel<Q> model(two, fixtures::RationalNumbers(two));
  BOOST_TEST(mismatch(model.inverse(state.x, state.qd, state.qdd, kAll),
                      std::vector<Q>{tau1, tau2}) == "");
}

// By hand: n slides along z, stacked, each of 1 kg; sum over everything outboard. All numbers are
// integers below 2^53, so double arithmetic is exact too. Nothing recurses, and time grows with n.
BOOST_AUTO_TEST_CASE(a_chain_of_20000_slides_carries_what_is_above_each) {
  constexpr int n = 20000;
  scene::Mechanism m = hanging(10);
  for (int i = 0; i < n; ++i) {
    scene::Link link = pendulumLink(i, 0, 0, 1);
    link.joint.kind = scene::JointKind::kPrismatic;
    link.joint.axis = {scene::Number(0), scene::Number(0), scene::Number(1)};
    m.links.push_back(link);
  }
  HomogeneousModel<double> model(m, scene::RealNumbers<double>(m));
  const std::vector<scene::JointPosition<double>> x(n, {0.5, 1, 0});
  const std::vector<double> qd(n, 3.0), qdd(n, 1.0);
  const std::vector<double> tau = model.inverse(x, qd, qdd, kAll);
  int wrong = 0;
  double expected = 0;
  for (int i = n - 1; i >= 0; --i) {
    expected += i + 11;  // link i accelerates with i + 1 and weighs 10
    if (tau[static_cast<std::size_t>(i)] != expected) ++wrong;
  }
  BOOST_TEST(wrong == 0);
}

std::vector<std::string> bundledNames() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) names.push_back(file.stem().string());
  return names;
}

// Every kind of joint, rotors, springs, loads, DH rows: all bundled scenes, M, c, g, tau, qdd and
// the energies by Lagrange's derivation and the sweeps, momentum by the sweep.
BOOST_DATA_TEST_CASE(it_is_the_same_mathematics_in_every_bundled_scene, data::make(bundledNames()),
                     name) {
  const auto checks = compared(scene::findScene(name), Parameters::kAsWritten, kNothing);
  BOOST_TEST(checks.size() >= 15u);
  for (const CheckResult& check : checks) {
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.quantity << " " << check.reason);
    if (check.quantity != "qdd") BOOST_TEST((check.verdict == Verdict::kAgree), check.reason);
  }
}
BOOST_AUTO_TEST_CASE(it_is_the_same_mathematics_for_every_robot_of_that_structure) {
  for (const char* name : {"puma_560", "furuta_pendulum", "heavy_top", "elastic_pendulum"})
    for (const CheckResult& check : compared(scene::findScene(name), Parameters::kRandom, kNothing))
      BOOST_TEST((check.verdict == Verdict::kAgree), name << " " << check.quantity);
}

// One mistake at a time, and the quantities that it must spoil. A change takes any model.
BOOST_AUTO_TEST_SUITE(mistakes_are_seen)

BOOST_AUTO_TEST_CASE(gravity_of_the_wrong_sign) {
  const auto checks = compared(scene::findScene("puma_560"), Parameters::kAsWritten,
                               [](auto& model, const auto&) { model.gravity = -model.gravity; });
  BOOST_TEST(disputed(checks) == "g potential qdd tau");
}
BOOST_AUTO_TEST_CASE(inertia_taken_for_second_moments) {  // I for (tr I / 2) 1 - I
  const auto checks =
      compared(scene::findScene("puma_560"), Parameters::kAsWritten, [](auto& model, const auto&) {
        auto& J = model.bodies.back().J;
        const auto trace = J(0, 0) + J(1, 1) + J(2, 2);
        for (int i = 0; i < 3; ++i) J(i, i) = trace - J(i, i);
      });
  BOOST_TEST(disputed(checks) == "M c kinetic momentum qdd tau");
}
BOOST_AUTO_TEST_CASE(an_axis_that_points_the_other_way) {
  const auto checks =
      compared(scene::findScene("scara"), Parameters::kAsWritten, [](auto& model, const auto&) {
        auto& E = model.bodies.back().axes[0].E;
        E = -E;  // the generator, not the motion
      });
  BOOST_TEST(disputed(checks).find("M") != std::string::npos);
  BOOST_TEST(disputed(checks).find("tau") != std::string::npos);
}
BOOST_AUTO_TEST_CASE(a_rotor_left_out) {
  const auto checks =
      compared(scene::findScene("humanoid"), Parameters::kAsWritten, [](auto& model, const auto&) {
        using T = std::decay_t<decltype(model.gravity(0))>;
        for (auto& axis : model.bodies.back().axes) axis.rotor = T(0);
      });
  BOOST_TEST(disputed(checks) == "M kinetic qdd tau");
}
BOOST_AUTO_TEST_CASE(a_gyroscopic_rotor_that_spins_backwards) {
  const auto checks = compared(scene::findScene("gyroscopic_wrist"), Parameters::kAsWritten,
                               [](auto& model, const auto&) {
                                 for (auto& body : model.bodies)
                                   if (body.kind == scene::JointKind::kFixed)
                                     for (auto& axis : body.axes) axis.E = -axis.E;
                               });
  BOOST_TEST(disputed(checks) == "M c kinetic momentum qdd tau");
}
BOOST_AUTO_TEST_CASE(a_spring_left_out) {
  const auto checks = compared(scene::findScene("elastic_pendulum"), Parameters::kAsWritten,
                               [](auto& model, const auto&) {
                                 using T = std::decay_t<decltype(model.gravity(0))>;
                                 for (auto& body : model.bodies) body.stiffness = T(0);
                               });
  BOOST_TEST(disputed(checks) == "g potential qdd tau");
}
BOOST_AUTO_TEST_CASE(a_load_in_the_wrong_axes) {
  const auto checks = compared(scene::findScene("prismatic_revolute_mix"), Parameters::kAsWritten,
                               [](auto& model, const auto&) {
                                 for (auto& load : model.loads) load.in_world = !load.in_world;
                               });
  BOOST_TEST(disputed(checks) == "qdd tau");
}

BOOST_AUTO_TEST_SUITE_END()

// What a witness shares with another it cannot testify about: of the sweeps it takes M = L D L'
// alone, as lagrange does, and of the derivation nothing; scalars, and a quaternion scaled by a
// power of two, are no formulas.
BOOST_AUTO_TEST_CASE(it_shares_no_formula) {
  std::ifstream source(std::string(DYNWITNESS_SOURCE_DIR) +
                       "/crosscheck/witnesses/recursive_lagrange.hpp");
  std::set<std::string> included;
  for (std::string line; std::getline(source, line);)
    if (line.rfind("#include \"", 0) == 0) included.insert(line.substr(10, line.size() - 11));
  BOOST_TEST((included == std::set<std::string>{"crosscheck/scalars/adjoint_error.hpp",
                                                "crosscheck/scalars/prime_field.hpp",
                                                "crosscheck/witnesses/bounded_answer.hpp",
                                                "recursive/factorization.hpp", "scene/mimic.hpp",
                                                "scene/numbers.hpp", "scene/state.hpp"}));
}
