// SPDX-License-Identifier: GPL-3.0-or-later
// Second derivatives as checks: who is asked, what is seen of a fault, and whether the limits bite.
#include "crosscheck/exact/second_derivative_checks.hpp"

#include <algorithm>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/laws/second_derivative_pairs.hpp"
#include "crosscheck/motion/derivative_quantities.hpp"
#include "crosscheck/verdicts/check_second_derivatives.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "scene/families.hpp"
#include "tests/fixtures/other_arms.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

// branches, a screw, a cylinder, friction, loads, a floating body, a gyroscopic rotor; joints that
// follow; a rotor geared to several rates, which the sweep does not know
BOOST_DATA_TEST_CASE(every_road_says_the_same,
                     data::make({"humanoid_floating", "puma_560_friction", "cylindrical_arm",
                                 "satellite_held", "gyroscopic_wrist", "gripper",
                                 "differential_wrist"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const std::vector<CheckResult> checks = checkSecondDerivativesExactly(scene, {});
  const bool has_sweep = whyNoSecondSweep(scene.mechanism).empty();
  BOOST_TEST(checks.size() == (has_sweep ? 24u : 8u));
  for (const CheckResult& check : checks) {
    BOOST_TEST((check.verdict == Verdict::kAgree), check.statement << ": " << check.reason);
    BOOST_TEST(check.exact->error_probability < 1e-18);
  }
  for (const CheckResult& check : checkSecondDerivatives(scene, {})) {
    BOOST_TEST((check.verdict == (has_sweep ? Verdict::kAgree : Verdict::kNotAnswerable)),
               check.statement << ": " << check.reason);
    BOOST_TEST(check.limitOverSeen().value_or(0) < kWidestLimit, check.statement);
    BOOST_TEST(check.digits.has_value() == has_sweep);
  }
}

// Lengths off by 1e-18 are in all second derivatives, and Lagrange's road is named.
BOOST_AUTO_TEST_CASE(another_lagrangian_stands_alone) {
  const scene::Scene scene = scene::findScene("puma_560");
  const scene::Mechanism wrong = fixtures::withLengthsTimes(scene.mechanism, "(1 + 1e-18)");
  const std::vector<CheckResult> checks = checkSecondDerivativesExactly(scene, {}, &wrong);
  for (const CheckResult& check : checks)
    BOOST_TEST((check.verdict == Verdict::kDisagree) == (check.left == "lagrange"),
               check.statement);
  const std::vector<Finding> findings = findOutliers(scene.name, checks);
  BOOST_TEST(findings.size() == 8u);
  for (const Finding& finding : findings) BOOST_TEST(finding.witness == "lagrange");
}

BOOST_AUTO_TEST_CASE(answers_of_another_arm_are_beyond_their_limits) {
  const scene::Scene scene = scene::findScene("puma_560");
  scene::Scene wrong = scene;
  wrong.mechanism = fixtures::withLengthsTimes(wrong.mechanism, "(1 + 1e-9)");
  const PreparedScene answering(wrong);
  const std::vector<CheckResult> checks = checkSecondDerivatives(scene, {}, &answering);
  BOOST_TEST(checks.size() == 4u);
  for (const CheckResult& check : checks)
    BOOST_TEST((check.verdict == Verdict::kDisagree), check.statement);
}

// Beyond 40 rates the sweep is not asked, and says so; of tau the others are.
BOOST_AUTO_TEST_CASE(long_chains_are_told) {
  scene::Scene scene;
  BOOST_REQUIRE(scene::findFamily("chain_50", &scene));
  for (const CheckResult& check : checkSecondDerivatives(scene, {})) {
    BOOST_TEST((check.verdict == Verdict::kNotAnswerable));
    BOOST_TEST(check.reason.find("125000 numbers each") != std::string::npos, check.reason);
  }
  const std::vector<CheckResult> exact = checkSecondDerivativesExactly(scene, {});
  BOOST_TEST(exact.size() == 8u);
  for (const CheckResult& check : exact)
    BOOST_TEST((check.verdict == (check.quantity.rfind("d2tau", 0) == 0 ? Verdict::kAgree
                                                                        : Verdict::kNotAnswerable)),
               check.statement << ": " << check.reason);
}

// An entry is named by row, first and second direction.
BOOST_AUTO_TEST_CASE(entries_have_three_indices) {
  for (const CheckResult& check : checkSecondDerivatives(scene::findScene("planar_3r"), {}))
    BOOST_TEST(std::count(check.worst_entry.begin(), check.worst_entry.end(), ',') == 2,
               check.worst_entry);
}

// `evaluate` and reports use one set of names, in one order.
BOOST_AUTO_TEST_CASE(quantities_have_the_names_that_evaluate_knows) {
  for (std::size_t k = 0; k < kSecondDerivativeNames.size(); ++k)
    BOOST_TEST(name(static_cast<DerivativeQuantity>(
                   static_cast<std::size_t>(DerivativeQuantity::kD2tauDqDq) + k)) ==
               std::string(kSecondDerivativeNames[k]));
}
