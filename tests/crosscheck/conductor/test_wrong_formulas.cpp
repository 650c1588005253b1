// SPDX-License-Identifier: GPL-3.0-or-later
// A deliberate mistake in one witness must be found, and the scene, the quantities and the witness
// be named. The mistakes are those of wrong_formulas.hpp, one at a time.
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "tests/fixtures/wrong_formulas.hpp"

#include <algorithm>
#include <ostream>
#include <set>
#include <sstream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using dynwitness::wrong::FormulaWitness;
using dynwitness::wrong::Mistake;

namespace {

const std::vector<std::string> kWitnesses = {"lagrange", "newton_euler", "composite_body",
                                             "articulated_body", "simbody"};

/// The witnesses of kWitnesses, with a copy of the formulas on one chair.
std::vector<WitnessKind> witnessesWith(const std::string& chair, Mistake mistake) {
  std::vector<WitnessKind> kinds = selectWitnesses(kWitnesses);
  for (WitnessKind& kind : kinds)
    if (kind.info.name == chair)
      kind.make = [chair, mistake](const PreparedScene& scene) -> MadeWitness {
        return std::make_unique<FormulaWitness>(chair, scene.scene(), mistake);
      };
  return kinds;
}

Options fewStates() {
  Options options;
  options.states = 3;
  return options;
}

struct Case {
  Mistake mistake;
  const char* what;   ///< in words
  const char* chair;  ///< the witness that makes it
  const char* scene;  ///< a scene in which it matters
  const char*
      quantities;  ///< in dispute; in brackets where only two witnesses speak: no one stands alone
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.what << " (" << c.chair << ", " << c.scene << ")";
}

const std::vector<Case> kCases = {
    {Mistake::kGravitySign, "gravity: wrong sign", "newton_euler", "puma_560", "g tau"},
    {Mistake::kGravitySign, "gravity: wrong sign", "articulated_body", "puma_560", "qdd"},
    {Mistake::kGravityNotTurned, "gravity not turned into link axes", "newton_euler", "puma_560",
     "g tau"},
    {Mistake::kGravityForgetsALink, "gravity left out of one link", "newton_euler", "acrobot",
     "g tau"},
    {Mistake::kCoriolisSign, "Coriolis term: wrong sign", "newton_euler", "puma_560", "c tau"},
    {Mistake::kCoriolisSign, "Coriolis term: wrong sign", "articulated_body", "furuta_pendulum",
     "qdd"},
    {Mistake::kCoriolisMissing, "Coriolis term missing", "newton_euler", "cart_pole", "c tau"},
    {Mistake::kBiasMissing, "bias force missing", "newton_euler", "franka_panda", "c tau"},
    {Mistake::kForceCrossLosesForce, "force cross product without v x f", "newton_euler",
     "double_pendulum", "c tau"},
    {Mistake::kParallelAxisSign, "inertia shift: wrong sign", "newton_euler", "puma_560",
     "M c tau kinetic (momentum)"},
    {Mistake::kCentreInParentAxes, "inertia shift by a vector of another frame", "newton_euler",
     "kuka_iiwa_14", "M c g tau kinetic potential (momentum)"},
    {Mistake::kProductsOfInertiaSign, "products of inertia: wrong sign", "newton_euler",
     "franka_panda", "M c tau kinetic (momentum)"},
    // (the link that it concerns turns about one fixed axis only: no c)
    {Mistake::kInertiaAxesIgnored, "inertia axes ignored", "newton_euler", "prismatic_revolute_mix",
     "M tau kinetic (momentum)"},
    {Mistake::kRotationTransposed, "R in place of R'", "newton_euler", "puma_560",
     "M c g tau kinetic (momentum)"},
    {Mistake::kRotationTransposed, "R in place of R'", "composite_body", "scara", "M qdd"},
    {Mistake::kTranslationSign, "transformation: wrong sign of p", "newton_euler", "planar_3r",
     "M c tau kinetic (momentum)"},
    {Mistake::kTranslationSign, "transformation: wrong sign of p", "articulated_body", "planar_3r",
     "qdd"},
    {Mistake::kForceMovedLikeMotion, "force transformed like a velocity", "newton_euler",
     "puma_560", "M c g tau (momentum)"},
    {Mistake::kChildForceNotTransformed, "child's force not transformed", "newton_euler", "scara",
     "M c tau (momentum)"},
    {Mistake::kDhTurnsBeforeItMoves, "DH row in the wrong order", "newton_euler", "puma_560",
     "M c g tau kinetic potential (momentum)"},
    {Mistake::kRotorMissing, "rotor inertia missing", "newton_euler", "puma_560", "M tau kinetic"},
    {Mistake::kRotorMissing, "rotor inertia missing", "articulated_body", "humanoid", "qdd"},
    {Mistake::kGearNotSquared, "gear ratio not squared", "newton_euler", "puma_560",
     "M tau kinetic"},
    {Mistake::kGearNotSquared, "gear ratio not squared", "composite_body", "puma_560", "M qdd"},
    {Mistake::kRotorOnNextJoint, "rotor at the wrong joint", "newton_euler", "stanford_arm",
     "M tau kinetic"},
    {Mistake::kSlideTakenForTurn, "prismatic joint taken for a revolute one", "newton_euler",
     "cart_pole", "M c tau kinetic (momentum)"},
    {Mistake::kSpringSign, "spring: wrong sign", "newton_euler", "elastic_pendulum",
     "g tau potential"},
    {Mistake::kWorldLoadNotTurned, "load in world axes not turned", "newton_euler",
     "prismatic_revolute_mix", "tau"},
    {Mistake::kCompositeOfOneChild, "composite body of one child at a branch", "composite_body",
     "prismatic_revolute_mix", "M qdd"},
    {Mistake::kCompositeNotMoved, "composite inertia not transformed", "composite_body", "puma_560",
     "M qdd"},
    {Mistake::kForceNotCarried, "force not carried inward", "composite_body", "franka_panda",
     "M qdd"},
    {Mistake::kInertiaNotProjected, "articulated inertia without U U'/D", "articulated_body",
     "acrobot", "qdd"},
    {Mistake::kJointBiasMissing, "joint's bias force missing", "articulated_body", "puma_560",
     "qdd"},
    {Mistake::kVelocityBiasNotCarried, "bias force without M_a c", "articulated_body",
     "prismatic_revolute_mix", "qdd"},
    {Mistake::kForceOfJointNotCarried, "bias force without U u/D", "articulated_body", "acrobot",
     "qdd"},
};

/// "M c (momentum)" of the findings: in brackets where nobody stands alone.
std::string inDispute(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings)
    text += (text.empty() ? "" : " ") +
            (finding.witness.empty() ? "(" + finding.quantity + ")" : finding.quantity);
  return text;
}

}  // namespace

// Without a mistake the copy agrees with all witnesses on every quantity that two of them answer.
BOOST_DATA_TEST_CASE(the_copy_without_mistake_agrees_with_every_witness,
                     data::make({"puma_560", "prismatic_revolute_mix", "humanoid", "stanford_arm",
                                 "furuta_pendulum"}) *
                         data::make({"newton_euler", "composite_body", "articulated_body"}),
                     scene_name, chair) {
  const scene::Scene scene = scene::findScene(scene_name);
  const auto checks = compareWitnesses(scene, witnessesWith(chair, Mistake::kNone), fewStates());
  int answered = 0;
  for (const CheckResult& check : checks) {
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.statement << ": " << check.reason);
    answered += check.verdict == Verdict::kAgree ? 1 : 0;
  }
  BOOST_TEST(answered > 15);
  BOOST_TEST(findOutliers(scene.name, checks).empty());
}

// One mistake in one witness: the crosscheck disagrees, in exactly these quantities, names the
// scene and says who stands alone.
BOOST_DATA_TEST_CASE(a_mistake_is_found_and_its_maker_named, data::make(kCases), wrong) {
  const scene::Scene scene = scene::findScene(wrong.scene);
  const auto checks =
      compareWitnesses(scene, witnessesWith(wrong.chair, wrong.mistake), fewStates());
  const std::vector<Finding> findings = findOutliers(scene.name, checks);
  BOOST_TEST(inDispute(findings) == wrong.quantities);
  for (const Finding& finding : findings) {
    BOOST_TEST(finding.scene == wrong.scene);
    BOOST_TEST((finding.witness == wrong.chair || finding.witness.empty()), finding.text);
    BOOST_TEST((finding.text.find(wrong.scene) != std::string::npos), finding.text);
    BOOST_TEST((finding.text.find(finding.quantity) != std::string::npos), finding.text);
    BOOST_TEST((finding.text.find(wrong.chair) != std::string::npos), finding.text);
  }
  // and nobody else is accused: every check in dispute is one with the wrong witness
  for (const CheckResult& check : checks)
    BOOST_TEST((check.verdict != Verdict::kDisagree || check.left == wrong.chair ||
                check.right == wrong.chair),
               check.statement << ": " << check.reason);
}

// The table leaves out no mistake that can be made.
BOOST_AUTO_TEST_CASE(every_mistake_is_tried) {
  std::set<Mistake> tried;
  for (const Case& c : kCases) tried.insert(c.mistake);
  BOOST_TEST(tried.size() == static_cast<std::size_t>(Mistake::kForceOfJointNotCarried));
}
