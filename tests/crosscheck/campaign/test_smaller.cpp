// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/smaller.hpp"

#include <algorithm>
#include <string>

#include <boost/test/unit_test.hpp>

#include "crosscheck/campaign/case_runner.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/witnesses/exact_sweeps.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

#include <nlohmann/json.hpp>

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

int joints(const scene::Scene& scene, scene::JointKind kind) {
  return static_cast<int>(
      std::count_if(scene.mechanism.links.begin() + 1, scene.mechanism.links.end(),
                    [&](const scene::Link& link) { return link.joint.kind == kind; }));
}

/// The composite-body sweep with a rotor that is a millionth too heavy.
WitnessKind withHeavyRotors() {
  WitnessKind mistaken = compositeBodyKind();
  mistaken.make_exact = [](const PreparedScene& prepared, Parameters) {
    return sweepWitness<CompositeBody>(prepared.scene(), [](auto& model, const auto& number) {
      using T = typename std::decay_t<decltype(number)>::Scalar;
      for (auto& link : model.links) link.rotor *= T(1) + T(1) / T(1000000);
    });
  };
  return mistaken;
}

bool hasRotor(const scene::Scene& scene) {
  return std::any_of(
      scene.mechanism.links.begin(), scene.mechanism.links.end(),
      [](const scene::Link& link) { return !link.joint.rotor_inertia.isLiteralZero(); });
}

}  // namespace

BOOST_AUTO_TEST_CASE(what_shows_a_helical_joint_with_weight_is_one_such_joint_at_last) {
  const auto shows = [](const scene::Scene& scene) {
    return std::any_of(scene.mechanism.links.begin() + 1, scene.mechanism.links.end(),
                       [](const scene::Link& link) {
                         return link.joint.kind == scene::JointKind::kHelical &&
                                !link.inertia.mass.isLiteralZero();
                       });
  };
  int found = 0;
  for (unsigned index = 0; index < 40; ++index) {
    const scene::Scene scene = randomWholeScene(4, index, 8);
    if (!shows(scene)) continue;
    ++found;
    const SmallerScene small = smaller(scene, shows, 100000);
    BOOST_TEST_CONTEXT(scene::writeSceneToml(small.scene)) {
      BOOST_TEST(small.is_smallest);
      // the only links that are left are those that carry it, on joints that do not move
      BOOST_TEST(joints(small.scene, scene::JointKind::kHelical) == 1);
      BOOST_TEST(joints(small.scene, scene::JointKind::kFixed) ==
                 static_cast<int>(small.scene.mechanism.links.size()) - 2);
      BOOST_TEST(!small.scene.mechanism.has_gravity);
      BOOST_TEST(small.scene.mechanism.wrenches.empty());
      BOOST_TEST(small.scene.mechanism.closures.empty());
      BOOST_TEST(small.scene.mechanism.links.back().inertia.mass.text() == "1");
      // the same again
      const SmallerScene again = smaller(scene, shows, 100000);
      BOOST_TEST(scene::writeSceneToml(again.scene) == scene::writeSceneToml(small.scene));
      BOOST_TEST(again.trials == small.trials);
    }
  }
  BOOST_TEST(found > 3);
}

BOOST_AUTO_TEST_CASE(a_limit_of_trials_is_kept_and_told) {
  const scene::Scene scene = randomWholeScene(4, 2, 8);
  const SmallerScene small = smaller(
      scene, [](const scene::Scene&) { return true; }, 3);
  BOOST_TEST(small.trials == 3);
  BOOST_TEST(!small.is_smallest);
  BOOST_CHECK_THROW(smaller(
                        scene, [](const scene::Scene&) { return false; }, 3),
                    std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(a_fault_in_rotors_becomes_a_scene_of_one_rotor) {
  CampaignPlan plan;
  plan.seed = 3;
  plan.error_probability = 1e-30;
  plan.seconds = 600;
  CampaignPart part;
  part.count = 20;
  part.most_joints = 5;
  plan.parts = {part};
  const CaseRunner runner(plan, {}, {newtonEulerKind(), withHeavyRotors()});
  int disagree = 0;
  for (long k = 0; k < part.count && disagree < 3; ++k) {
    const auto record = nlohmann::json::parse(runner.line(k)).at("record");
    const scene::Scene scene = randomWholeScene(plan.seed, static_cast<std::uint64_t>(k), 5);
    const bool expected = hasRotor(scene);
    BOOST_TEST((record.at("verdict") == "disagree") == expected, record.dump());
    if (!expected) continue;
    ++disagree;
    const auto cause = record.at("cause").get<std::string>();
    BOOST_TEST(cause.find("composite_body") != std::string::npos, cause);
    const scene::Scene small =
        scene::readSceneToml(record.at("small").at("scene").get<std::string>(), "small.toml");
    BOOST_TEST_CONTEXT(scene::writeSceneToml(small)) {
      BOOST_TEST(record.at("small").at("is_smallest").get<bool>());
      BOOST_TEST(small.mechanism.dof() == 1);
      BOOST_TEST(hasRotor(small));
      BOOST_TEST(!small.mechanism.has_gravity);
    }
  }
  BOOST_TEST(disagree == 3);
}
