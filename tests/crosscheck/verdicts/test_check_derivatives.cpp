// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives as quantities of a crosscheck: who is asked, what is seen of a fault, and whether the
// limits bite.
#include "crosscheck/verdicts/check_derivatives.hpp"

#include <map>
#include <set>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/exact/derivative_checks.hpp"
#include "crosscheck/motion/derivative_quantities.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "tests/fixtures/other_arms.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

Options few() {
  Options options;
  options.states = 2;
  return options;
}

std::set<std::string> red(const std::vector<CheckResult>& checks, CheckKind kind) {
  std::set<std::string> quantities;
  for (const CheckResult& check : checks)
    if (check.kind == kind && check.verdict == Verdict::kDisagree)
      quantities.insert(check.quantity);
  return quantities;
}

}  // namespace

// branches, a screw, a cylinder, friction, a floating body, a gyroscopic rotor; joints that follow
BOOST_DATA_TEST_CASE(every_road_says_the_same,
                     data::make({"double_pendulum", "puma_560_friction", "cylindrical_arm",
                                 "satellite_held", "gyroscopic_wrist", "gripper"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const bool has_fast = whyNoFastDerivatives(scene.mechanism).empty();
  std::map<CheckKind, int> asked;
  for (const CheckResult& check : checkDerivatives(scene, few())) {
    ++asked[check.kind];
    const bool refused = check.kind == CheckKind::kWitness;
    BOOST_TEST((check.verdict == (refused ? Verdict::kNotAnswerable : Verdict::kAgree)),
               check.name() << " " << check.statement << ": " << check.reason);
    if (check.kind != CheckKind::kTruth) continue;
    BOOST_TEST(check.limitOverSeen().value_or(0) < kWidestLimit, check.statement);
    BOOST_TEST(check.digits.has_value());
  }
  BOOST_TEST(asked[CheckKind::kSame] == (has_fast ? 36 : 18));
  BOOST_TEST(asked[CheckKind::kTruth] == (has_fast ? 12 : 6));
  BOOST_TEST(asked[CheckKind::kWitness] == (has_fast ? 0 : 6));
  for (const CheckResult& check : checkDerivativesExactly(scene, {})) {
    BOOST_TEST((check.verdict == Verdict::kAgree), check.statement << ": " << check.reason);
    BOOST_TEST(check.exact->error_probability < 1e-18);
  }
}

// Lengths off by 1e-18 are in all derivatives.
BOOST_AUTO_TEST_CASE(another_lagrangian_stands_alone) {
  const scene::Scene scene = scene::findScene("puma_560");
  const scene::Mechanism wrong = fixtures::withLengthsTimes(scene.mechanism, "(1 + 1e-18)");
  const std::vector<CheckResult> checks = checkDerivativesExactly(scene, {}, &wrong);
  BOOST_TEST(red(checks, CheckKind::kSame).size() == 6u);
  const std::vector<Finding> findings = findOutliers(scene.name, checks);
  BOOST_TEST(findings.size() == 6u);
  for (const Finding& finding : findings) BOOST_TEST(finding.witness == "lagrange");
}

BOOST_AUTO_TEST_CASE(answers_of_another_arm_are_beyond_their_limits) {
  const scene::Scene scene = scene::findScene("puma_560");
  scene::Scene wrong = scene;
  wrong.mechanism = fixtures::withLengthsTimes(wrong.mechanism, "(1 + 1e-9)");
  const PreparedScene answering(wrong);
  const std::vector<CheckResult> checks = checkDerivatives(scene, few(), &answering);
  BOOST_TEST(red(checks, CheckKind::kTruth).size() == 6u);
  BOOST_TEST(red(checks, CheckKind::kSame).empty());
}

// `evaluate` and reports use one set of names; dtau_dqdd is M there.
BOOST_AUTO_TEST_CASE(quantities_have_the_names_that_evaluate_knows) {
  for (const Derivative quantity : kDerivatives)
    if (quantity != Derivative::kTauByQdd)
      BOOST_TEST(derivativeQuantityNamed(name(quantity)).has_value(), name(quantity));
}
