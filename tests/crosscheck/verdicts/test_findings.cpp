// SPDX-License-Identifier: GPL-3.0-or-later
// Who stands alone, and how witnesses are asked.

#include <limits>
#include <map>
#include <stdexcept>

#include <boost/test/unit_test.hpp>

#include "crosscheck/verdicts/causes.hpp"
#include "crosscheck/verdicts/check_reading.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/witness.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A witness that says one number about one quantity, or throws.
class Parrot : public Witness {
 public:
  Parrot(std::string name, double value, double bound)
      : name_(std::move(name)), value_(value), bound_(bound) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity == Quantity::kKinetic; }
  Answer answer(Quantity, const scene::State<double>&) override {
    if (name_ == "thrower") throw std::runtime_error("no idea");
    return {Eigen::MatrixXd::Constant(1, 1, value_), Eigen::MatrixXd::Constant(1, 1, bound_)};
  }

 private:
  std::string name_;
  double value_, bound_;
};

WitnessKind saying(const std::string& name, double value, double bound = 0.25) {
  return {{name, "1", "parrot"}, [=](const PreparedScene&) -> MadeWitness {
            return std::make_unique<Parrot>(name, value, bound);
          }};
}

std::vector<CheckResult> compared(const std::vector<WitnessKind>& kinds) {
  scene::Scene scene;
  scene.name = "test_scene";
  scene.mechanism.links.resize(1);
  Options options;
  options.states = 2;
  return compareWitnesses(scene, kinds, options);
}

/// The one finding, or an empty one with a note.
Finding findingOf(const std::vector<WitnessKind>& kinds) {
  const std::vector<Finding> findings = findOutliers("test_scene", compared(kinds));
  if (findings.size() == 1) return findings[0];
  Finding none;
  none.text = std::to_string(findings.size()) + " findings";
  return none;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(every_pair_is_compared_once) {
  const auto checks = compared({saying("a", 1), saying("b", 1), saying("c", 1), saying("d", 1)});
  BOOST_TEST(checks.size() == 6u);
  std::map<std::string, int> pairs;
  for (const CheckResult& check : checks) {
    BOOST_TEST(check.name() == "same");
    BOOST_TEST(check.quantity == "kinetic");
    BOOST_TEST((check.verdict == Verdict::kAgree));
    BOOST_TEST(check.states == 2);
    ++pairs[check.left + check.right];
  }
  for (const char* pair : {"ab", "ac", "ad", "bc", "bd", "cd"}) BOOST_TEST(pairs[pair] == 1);
  BOOST_TEST(findOutliers("test_scene", checks).empty());
}

// The limit of a pair is the sum of both bounds: by hand 0.25 + 0.25.
BOOST_AUTO_TEST_CASE(a_pair_may_differ_by_the_sum_of_its_bounds) {
  BOOST_TEST((compared({saying("a", 1), saying("b", 1.5)})[0].verdict == Verdict::kAgree));
  BOOST_TEST((compared({saying("a", 1), saying("b", 1.5001)})[0].verdict == Verdict::kDisagree));
}

BOOST_AUTO_TEST_CASE(one_of_three_stands_alone) {
  for (const int wrong : {0, 1, 2}) {
    std::vector<WitnessKind> kinds;
    for (int i = 0; i < 3; ++i)
      kinds.push_back(saying(std::string(1, static_cast<char>('a' + i)), i == wrong ? 9 : 1));
    const Finding finding = findingOf(kinds);
    BOOST_TEST(finding.scene == "test_scene");
    BOOST_TEST(finding.quantity == "kinetic");
    BOOST_TEST(finding.witness == std::string(1, static_cast<char>('a' + wrong)));
    BOOST_TEST(
        (finding.text.find("test_scene: kinetic: " + finding.witness + " stands alone") == 0),
        finding.text);
  }
}

BOOST_AUTO_TEST_CASE(one_of_four_stands_alone) {
  const Finding finding =
      findingOf({saying("a", 1), saying("b", 1), saying("c", 9), saying("d", 1)});
  BOOST_TEST(finding.witness == "c");
  BOOST_TEST((finding.text.find("a, b, d agree") != std::string::npos), finding.text);
}

BOOST_AUTO_TEST_CASE(of_two_neither_stands_alone) {
  const Finding finding = findingOf({saying("a", 1), saying("b", 9)});
  BOOST_TEST(finding.quantity == "kinetic");
  BOOST_TEST(finding.witness == "");
  BOOST_TEST((finding.text.find("a, b disagree") != std::string::npos), finding.text);
}

namespace {

/// A disagreement, or an agreement, of this kind.
CheckResult judged(CheckKind kind, const std::string& quantity, const std::string& left,
                   const std::string& right, Verdict verdict) {
  CheckResult check;
  check.kind = kind;
  check.quantity = quantity;
  check.left = left;
  check.right = right;
  check.verdict = verdict;
  check.reason = quantity + " by " + left;
  return check;
}

/// A scene of three joints where b is wrong in some quantities, against a, c and the truth.
SceneResult withWrong(const std::vector<std::string>& wrong,
                      const std::vector<std::string>& right) {
  SceneResult scene;
  scene.name = "arm";
  scene.dof = 3;
  for (const bool is_wrong : {true, false})
    for (const std::string& quantity : is_wrong ? wrong : right) {
      const Verdict verdict = is_wrong ? Verdict::kDisagree : Verdict::kAgree;
      scene.checks.push_back(judged(CheckKind::kSame, quantity, "a", "b", verdict));
      scene.checks.push_back(judged(CheckKind::kSame, quantity, "b", "c", verdict));
      scene.checks.push_back(judged(CheckKind::kSame, quantity, "a", "c", Verdict::kAgree));
      CheckResult truth = judged(CheckKind::kTruth, quantity, "b", "", verdict);
      if (is_wrong) {
        truth.off = {quantity + "[2]", "elbow", "N m", 7, 15.1, 12};
        truth.wrong_joints = {"shoulder", "elbow"};
      }
      scene.checks.push_back(truth);
    }
  scene.findings = findOutliers(scene.name, scene.checks);
  return scene;
}

}  // namespace

// A wrong term shows in all that contains it: one cause, with its figures, whatever the order.
BOOST_AUTO_TEST_CASE(one_wrong_term_is_one_line) {
  const SceneResult scene = withWrong({"g", "tau", "qdd", "potential"}, {"M", "c"});
  const std::vector<Cause> causes = causesOf(scene);
  BOOST_REQUIRE(causes.size() == 1u);
  BOOST_TEST(causes[0].checks.size() == 12u);
  BOOST_TEST(
      causes[0].text ==
      "b stands alone in g; tau[2] is off by 3.1 N m where 12 N m is right, at state 7; wrong "
      "at joints 'shoulder' and 'elbow' of 3; so are tau, qdd and potential, which contain it; "
      "right in M and c");
  CrosscheckResult run;
  run.scenes = {scene};
  BOOST_TEST((run.headline().find("12 disagree: one cause, in arm: b stands alone in g") !=
              std::string::npos),
             run.headline());
}

// Two that are wrong are two causes; a pair of both belongs to one of them, and no check is lost.
BOOST_AUTO_TEST_CASE(every_disagreement_belongs_to_one_cause) {
  SceneResult scene = withWrong({"M"}, {"g"});
  for (const char* other : {"a", "c"})
    scene.checks.push_back(judged(CheckKind::kSame, "c", other, "d", Verdict::kDisagree));
  scene.checks.push_back(judged(CheckKind::kSame, "c", "a", "c", Verdict::kAgree));
  scene.checks.push_back(judged(CheckKind::kSame, "M", "b", "d", Verdict::kDisagree));
  scene.checks.push_back(judged(CheckKind::kLaw, "P", "a", "", Verdict::kDisagree));
  scene.checks.back().law = "projector";
  scene.findings = findOutliers(scene.name, scene.checks);
  const std::vector<Cause> causes = causesOf(scene);
  std::size_t explained = 0;
  std::vector<std::string> who;
  for (const Cause& cause : causes) {
    explained += cause.checks.size();
    who.push_back(cause.witness);
  }
  BOOST_TEST(explained == 7u);
  BOOST_TEST(who == (std::vector<std::string>{"b", "d", ""}), boost::test_tools::per_element());
  BOOST_TEST((causes[2].text.find("a: projector") == 0), causes[2].text);
}

// A number that the file does not say (one mimic joint, say) makes tables disagree with everybody:
// who reads the file a second time names it, and all of that is one line.
BOOST_AUTO_TEST_CASE(one_misread_number_is_one_line) {
  SceneResult scene;
  scene.name = "gripper";
  CheckResult reading = judged(CheckKind::kLaw, "numbers", kRereading, "", Verdict::kDisagree);
  reading.law = kReading;
  reading.reason = "multiplier of joint 'right_finger': 1 and -1";
  for (const char* witness : {"a", "b", "c"})
    for (const char* quantity : {"M", "g", "tau", "c", "qdd"}) {
      scene.checks.push_back(
          judged(CheckKind::kTable, quantity, "table", witness, Verdict::kDisagree));
      scene.checks.back().statement = "published";
    }
  scene.checks.push_back(reading);
  scene.findings = findTableDisputes(scene.name, scene.checks);
  const std::vector<Cause> causes = causesOf(scene);
  BOOST_REQUIRE(causes.size() == 1u);
  BOOST_TEST(causes[0].checks.size() == 16u);
  BOOST_TEST((causes[0].text.find("multiplier of joint 'right_finger'") != std::string::npos),
             causes[0].text);
}

// Percentages beyond 1000 say nothing; nor do they of zero.
BOOST_AUTO_TEST_CASE(figures_say_how_far_an_answer_is_off) {
  const auto said = [](double answer, double right) {
    return figures({"tau[1]", "", "N m", 0, answer, right});
  };
  BOOST_TEST(said(15.1, 12) == "is off by 3.1 N m where 12 N m is right");
  BOOST_TEST(said(130, 12) == "is off by 118 N m where 12 N m is right");  // 983 %
  BOOST_TEST(said(345, 3) == "is 345 N m where 3 N m is right, 1.2e+02 times that");
  BOOST_TEST(said(-345, 3) == "is -345 N m where 3 N m is right, 1.2e+02 times that the other way");
  BOOST_TEST(said(0.5, 0) == "is 0.5 N m where 0 is right");
  BOOST_TEST(said(kNaN, 3) == "is not a number where 3 N m is right");
}

BOOST_AUTO_TEST_CASE(two_against_two_blames_nobody) {
  BOOST_TEST(findingOf({saying("a", 1), saying("b", 1), saying("c", 9), saying("d", 9)}).witness ==
             "");
}

BOOST_AUTO_TEST_CASE(three_that_all_differ_blame_nobody) {
  BOOST_TEST(findingOf({saying("a", 1), saying("b", 5), saying("c", 9)}).witness == "");
}

// a ~ b ~ c but a and c too far apart: b agrees with both, so nobody is alone.
BOOST_AUTO_TEST_CASE(a_witness_that_agrees_with_someone_is_not_alone) {
  BOOST_TEST(findingOf({saying("a", 1), saying("b", 1.4), saying("c", 1.8)}).witness == "");
}

BOOST_AUTO_TEST_CASE(identities_and_tables_do_not_vote) {
  std::vector<CheckResult> checks = compared({saying("a", 1), saying("b", 1), saying("c", 9)});
  CheckResult identity;
  identity.law = "power balance";
  identity.quantity = "power";
  identity.left = "a";
  identity.verdict = Verdict::kDisagree;
  checks.push_back(identity);
  const auto findings = findOutliers("test_scene", checks);
  BOOST_REQUIRE(findings.size() == 1u);
  BOOST_TEST(findings[0].witness == "c");
}

// The certified truth decides where pairs, with the sum of two limits, do not.
BOOST_AUTO_TEST_CASE(who_is_off_the_truth_is_named) {
  const auto truth = [](const std::string& witness, Verdict verdict) {
    CheckResult check;
    check.kind = CheckKind::kTruth;
    check.quantity = "kinetic";
    check.left = witness;
    check.verdict = verdict;
    return check;
  };
  for (const double other : {1.0, 9.0}) {  // in no dispute with the other, and in one
    std::vector<CheckResult> checks = compared({saying("a", 1), saying("b", other)});
    checks.push_back(truth("a", Verdict::kAgree));
    checks.push_back(truth("b", Verdict::kDisagree));
    const auto findings = findOutliers("test_scene", checks);
    BOOST_REQUIRE(findings.size() == 1u);
    BOOST_TEST(findings[0].witness == "b");
    BOOST_TEST(findings[0].text == "test_scene: kinetic: b alone is off the certified truth");
    checks.push_back(truth("c", Verdict::kDisagree));
    BOOST_TEST(findOutliers("test_scene", checks)[0].text ==
               "test_scene: kinetic: b, c are off the certified truth");
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(a_witness_that_says_nothing_sensible_stands_alone) {
  BOOST_TEST(findingOf({saying("a", 1), saying("b", kNaN), saying("c", 1)}).witness == "b");
  BOOST_TEST(findingOf({saying("a", kInfinity), saying("b", 1), saying("c", 1)}).witness == "a");
}

BOOST_AUTO_TEST_CASE(a_witness_that_throws_is_asked_but_not_blamed) {
  const auto checks = compared({saying("a", 1), saying("thrower", 1), saying("c", 1)});
  BOOST_REQUIRE(checks.size() == 3u);
  for (const CheckResult& check : checks) {
    const bool asked_it = check.left == "thrower" || check.right == "thrower";
    BOOST_TEST((check.verdict == (asked_it ? Verdict::kNotAnswerable : Verdict::kAgree)));
    if (asked_it)
      BOOST_TEST((check.reason.find("thrower: no idea") != std::string::npos), check.reason);
  }
  BOOST_TEST(findOutliers("test_scene", checks).empty());
}

BOOST_AUTO_TEST_CASE(without_a_bound_nothing_is_proven) {
  const auto checks = compared({saying("a", 1), saying("b", 9, kInfinity)});
  BOOST_TEST((checks[0].verdict == Verdict::kNotAnswerable));
}

// A witness without a bound cannot hide the disagreement of the others, nor be counted among them.
BOOST_AUTO_TEST_CASE(a_witness_without_bound_is_no_third_voice) {
  BOOST_TEST(findingOf({saying("a", 1), saying("b", 9), saying("c", 1, kInfinity)}).witness == "");
}

// Three proven answers suffice to say who is wrong, whether or not a fourth witness can speak.
BOOST_AUTO_TEST_CASE(one_of_three_stands_alone_though_a_fourth_is_silent) {
  BOOST_TEST(
      findingOf({saying("a", 9), saying("b", 1), saying("c", 1), saying("thrower", 1)}).witness ==
      "a");
  BOOST_TEST(findingOf({saying("a", 9), saying("b", 1), saying("c", 1), saying("d", 1, kInfinity)})
                 .witness == "a");
}

BOOST_AUTO_TEST_CASE(an_unknown_witness_is_refused_with_the_names_that_exist) {
  try {
    selectWitnesses({"newton_euler", "newton_eular"});
    BOOST_ERROR("not refused");
  } catch (const scene::InputError& error) {
    const std::string what = error.what();
    BOOST_TEST((what.find("'newton_eular'") != std::string::npos), what);
    for (const char* name :
         {"lagrange", "newton_euler", "composite_body", "articulated_body", "simbody"})
      BOOST_TEST((what.find(name) != std::string::npos), what);
  }
  BOOST_TEST(selectWitnesses({"simbody", "lagrange"}).size() == 2u);
  BOOST_TEST(selectWitnesses({}).size() >= 5u);
}

BOOST_AUTO_TEST_SUITE_END()
