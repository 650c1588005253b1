// SPDX-License-Identifier: GPL-3.0-or-later
// qdd is judged by what it leaves of the equations: limits that bite at every size.
#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/verdicts/backward_error.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

Options statesOf(int count) {
  Options options;
  options.states = count;
  return options;
}

const std::vector<std::string> kChains = {
    "chain_4",      "chain_8",      "chain_16",      "chain_32",      "chain_64",
    "flat_chain_4", "flat_chain_8", "flat_chain_16", "flat_chain_32", "flat_chain_64"};

/// Simbody where this build has it, otherwise a sweep of ours in its place.
WitnessKind outsideEngine() {
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.name == "simbody" && kind.info.present) return kind;
  return articulatedBodyKind();
}

/// The scene with the inertia of one link off by this part of it: one moment, about the joint's
/// axis.
scene::Scene withFault(scene::Scene scene, int link, const char* fault) {
  scene::Number& zz = scene.mechanism.links[link].inertia.zz;
  zz = scene::Expression::parse(fmt::format("({}) * (1 + {})", zz.text(), fault));
  return scene;
}

/// An engine that was given another scene.
WitnessKind misled(const WitnessKind& kind, const scene::Scene& other) {
  WitnessKind out = kind;
  out.info.name = "misled";
  out.make = [kind, other](const PreparedScene&) { return kind.make(other); };
  return out;
}

const CheckResult& qddOf(const std::vector<CheckResult>& checks) {
  const auto found = std::find_if(checks.begin(), checks.end(),
                                  [](const CheckResult& c) { return c.quantity == "qdd"; });
  BOOST_REQUIRE(found != checks.end());
  return *found;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(the_residual_of_a_pendulum_is_that_of_its_equation) {
  // by hand: m l^2 x + m g l sin q - tau
  const scene::Scene scene = scene::readSceneToml(R"(
gravity = [0, 0, -10]
[[link]]
name = "world"
[[link]]
name = "bob"
parent = "world"
mass = 2
com = [0, 0, -1]
[link.joint]
kind = "revolute"
axis = [1, 0, 0]
)",
                                                  "pendulum.toml");
  BackwardError backward_error(scene.mechanism);
  scene::State<double> state;
  state.x = {scene::jointPosition(0.5)};
  state.qd = {3};
  state.qdd = {0};
  state.tau = {7};
  backward_error.at(state);
  const Residual r = backward_error(Eigen::MatrixXd::Constant(1, 1, 0.25));
  const double expected = 2 * 0.25 + 20 * std::sin(0.5) - 7;
  BOOST_TEST(r.value(0, 0).mid() == expected, boost::test_tools::tolerance(1e-14));
  BOOST_TEST(r.value(0, 0).radius() < 1e-30);
  const double terms = 7 + 20 * std::sin(0.5) + 2 * 0.25;
  BOOST_TEST(r.size == terms, boost::test_tools::tolerance(1e-14));
  BOOST_TEST(backward_error.condition() == 1.0);
}

BOOST_AUTO_TEST_CASE(the_condition_of_m_does_not_depend_on_units) {
  // by hand: M = [a b; b d] has (1 + r) / (1 - r) with r = |b| / sqrt(a d)
  const scene::Scene scene = scene::findScene("double_pendulum");
  BackwardError backward_error(scene.mechanism);
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  backward_error.at(state);
  Setup<double> setup(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  const Eigen::MatrixXd M = CompositeBody::answer(setup, Quantity::kM, state);
  const double r = std::abs(M(0, 1)) / std::sqrt(M(0, 0) * M(1, 1));
  BOOST_TEST(backward_error.condition() == (1 + r) / (1 - r), boost::test_tools::tolerance(1e-10));
}

// A slide without mass outboard, driven by a gyroscopic rotor: by hand, M = [J_b + n^2 J_1, n J;
// n J, n^2 J], and n J is all that couples them. It is rounded, so its bound cannot be zero.
BOOST_AUTO_TEST_CASE(what_a_gyroscopic_rotor_couples_has_a_bound) {
  const scene::Scene scene = scene::readSceneToml(R"(
[[link]]
name = "world"
[[link]]
name = "arm"
parent = "world"
mass = 1
inertia = { xx = 0.5, yy = 0.5, zz = 0.7 }
[link.joint]
kind = "revolute"
[[link]]
name = "slide"
parent = "arm"
[link.joint]
kind = "prismatic"
rpy = [0.3, 0, 0]
rotor_inertia = 0.01
gear_ratio = 30
gyroscopic = true
)",
                                                  "slide.toml");
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 1, 0);
  SolveBound bound(scene.mechanism, SolvedBy::kSweep, 1);
  const Eigen::MatrixXd of_M = bound.massMatrix(state);
  const double coupling = 30 * 0.01 * std::cos(0.3);
  BOOST_TEST(of_M(0, 1) == of_M(1, 0));
  BOOST_TEST(of_M(0, 1) > 1e-16 * coupling);
  BOOST_TEST(of_M(0, 1) < 1e-13 * coupling);
  const Eigen::VectorXd of_residual = bound(state, Eigen::Vector2d(0, 1));
  BOOST_TEST(of_residual(0) > 1e-16 * coupling);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// A fault of 1e-9 in one moment of inertia, planted into an outside engine. It can be noticed where
// it changes some equation by more than an ulp of the terms in it: less than that is changed by
// writing the exact qdd down in double.
BOOST_DATA_TEST_CASE(a_fault_of_1e_9_in_one_inertia_is_noticed_in_qdd_at_every_size,
                     data::make(kChains), name) {
  const scene::Scene scene = scene::findScene(name);
  const int links = scene.mechanism.dof();
  const WitnessKind engine = outsideEngine();
  BOOST_TEST(
      (qddOf(measureDigits(scene, {engine}, statesOf(4)).checks).verdict == Verdict::kAgree));
  // The equations of the inner joints of a long chain weigh all of it, and rounding these terms in
  // an engine's own axes may leave more than the fault does. Measured, in limits: link 1 of 16 0.3
  // (flat 0.9), of 64 0.008; link 32 of 64 0.02 (flat 0.04).
  std::vector<int> asked = {links - 1, links};
  if (links <= 8) asked.insert(asked.end(), {1, 2, links / 2});
  for (const int link : asked) {
    const scene::Scene other = withFault(scene, link, "1e-9");
    const CheckResult check =
        qddOf(measureDigits(scene, {misled(engine, other)}, statesOf(4)).checks);
    BOOST_TEST((check.verdict == Verdict::kDisagree),
               name << ", link " << link << ": " << check.ratio << " of its limit");
  }
}

// Every bundled scene's own witnesses are held by test_digits; here it is told how much is used.
BOOST_DATA_TEST_CASE(limits_of_chains_are_within_1e4_of_what_is_seen,
                     data::make({"chain_4", "chain_8", "chain_16", "flat_chain_4", "flat_chain_8",
                                 "flat_chain_16"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const std::vector<WitnessKind> kinds = {newtonEulerKind(), compositeBodyKind(),
                                          articulatedBodyKind(), recursiveLagrangeKind(),
                                          fastKind()};
  for (const CheckResult& check : measureDigits(scene, kinds, statesOf(2)).checks) {
    BOOST_TEST((check.verdict == Verdict::kAgree),
               check.left << " " << check.quantity << ": " << check.reason);
    BOOST_TEST(check.limitOverSeen().value_or(0) < kWidestLimit,
               check.left << " " << check.quantity << ": limit " << check.loosest << ", seen "
                          << check.seen);
  }
}

BOOST_DATA_TEST_CASE(laws_of_chains_are_answered_at_every_size,
                     data::make({"chain_8", "flat_chain_16"}), name) {
  for (const CheckResult& law : checkIdentities(scene::findScene(name), statesOf(2))) {
    const bool is_asked = law.voided == 0 || law.excused == law.voided;
    BOOST_TEST(is_asked, law.name() << ": " << law.reason);
    if (law.verdict == Verdict::kNotAnswerable) continue;
    BOOST_TEST((law.verdict == Verdict::kAgree), law.name() << ": " << law.reason);
    if (law.name() == "projections of force and motion are dual")
      continue;  // 0 = 0 without rotors: no size to be wide of
    BOOST_TEST(law.limitOverSeen().value_or(0) < kWidestLimit, law.name()
                                                                   << ": limit " << law.loosest);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(an_answer_that_is_no_number_disagrees) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  BackwardError backward_error(scene.mechanism);
  backward_error.at(drawState(scene.mechanism, scene.name, 1, 0));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Residual r = backward_error(Eigen::MatrixXd::Constant(2, 1, bad));
    BOOST_TEST(!r.value(0, 0).isFinite());
  }
  BOOST_TEST(!backward_error(Eigen::MatrixXd::Zero(1, 1)).value(0, 0).isFinite());
}

BOOST_AUTO_TEST_CASE(where_m_is_singular_nothing_is_compared_and_the_joint_is_named) {
  scene::Scene scene = scene::findScene("double_pendulum");
  scene.mechanism.links[2].inertia = {};  // a massless tip
  const CheckResult check =
      qddOf(compareWitnesses(scene, {compositeBodyKind(), articulatedBodyKind()}, statesOf(3)));
  BOOST_TEST((check.verdict == Verdict::kNotAnswerable));
  BOOST_TEST(check.reason.find("joint 'elbow' moves no inertia") != std::string::npos,
             check.reason);
}

BOOST_AUTO_TEST_SUITE_END()
