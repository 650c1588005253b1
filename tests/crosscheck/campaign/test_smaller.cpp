// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/smaller.hpp"

#include <algorithm>
#include <string>

#include <boost/test/unit_test.hpp>

#include "crosscheck/campaign/case_runner.hpp"
#include "crosscheck/exact/small_state.hpp"
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

/// The composite-body sweep, whose M has the square of the first rate in its first entry.
WitnessKind withSquareOfTheFirstRate() {
  WitnessKind mistaken = compositeBodyKind();
  mistaken.make_exact = [](const PreparedScene& prepared,
                           Parameters parameters) -> OrRefusal<ExactWitness> {
    ExactWitness right = *compositeBodyKind().make_exact(prepared, parameters);
    right.in_field = [in_field = right.in_field](const FieldNumbers& number) {
      return
          [answers = in_field(number)](Quantity quantity, const scene::State<PrimeField>& state) {
            MatrixX<PrimeField> value = answers(quantity, state);
            if (quantity == Quantity::kM && value.size() > 0)
              value(0, 0) += state.qd[0] * state.qd[0];
            return value;
          };
    };
    return right;
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
      // M shows it, at any position
      for (const char* part : {"qd", "qdd", "tau"})
        for (const auto& entry : record.at("small").at("state").at(part)) BOOST_TEST(entry == 0);
      for (const auto& entry : record.at("small").at("state").at("q")) BOOST_TEST(entry == "0");
    }
  }
  BOOST_TEST(disagree == 3);
}

BOOST_AUTO_TEST_CASE(a_state_has_as_few_numbers_as_it_takes) {
  const scene::Scene scene = scene::findScene("double_pendulum");
  const auto state = smallestState(scene.mechanism, 1, [](const SmallState& at) {
    return at.positions[1] != 0 && at.qd[0] * at.qd[1] > 1;
  });
  BOOST_TEST_REQUIRE(state.has_value());
  BOOST_TEST(state->state.positions == (std::vector<int>{0, 1}), boost::test_tools::per_element());
  BOOST_TEST(state->state.tau == (std::vector<int>{0, 0}), boost::test_tools::per_element());
  BOOST_TEST(state->state.qdd == (std::vector<int>{0, 0}), boost::test_tools::per_element());
  // one of them is 1, and not both
  BOOST_TEST(std::min(state->state.qd[0], state->state.qd[1]) == 1);
  BOOST_TEST(std::max(state->state.qd[0], state->state.qd[1]) > 1);
  BOOST_TEST(positionsOf(state->state, scene.mechanism)[1].text() == "pi/2");
  BOOST_TEST(!smallestState(scene.mechanism, 1, [](const SmallState&) { return false; }));
}

BOOST_AUTO_TEST_CASE(a_fault_in_one_velocity_becomes_a_state_in_which_it_alone_is_not_zero) {
  CampaignPlan plan;
  plan.seed = 3;
  plan.error_probability = 1e-30;
  plan.seconds = 600;
  CampaignPart part;
  part.count = 6;
  part.most_joints = 4;
  plan.parts = {part};
  const CaseRunner runner(plan, {}, {newtonEulerKind(), withSquareOfTheFirstRate()});
  int moved = 0;
  for (long k = 0; k < part.count; ++k) {
    const auto record = nlohmann::json::parse(runner.line(k)).at("record");
    const scene::Scene scene = randomWholeScene(plan.seed, static_cast<std::uint64_t>(k), 4);
    if (scene.mechanism.dof() == 0) continue;
    ++moved;
    BOOST_TEST_REQUIRE(record.contains("small"), record.dump());
    const auto& state = record.at("small").at("state");
    int not_zero = 0;
    for (const char* of : {"qd", "qdd", "tau"})
      for (const auto& entry : state.at(of)) not_zero += entry == 0 ? 0 : 1;
    BOOST_TEST(state.at("qd").at(0) == 1, state.dump());
    BOOST_TEST(not_zero == 1, state.dump());
    // the scene starts there
    const scene::Scene small =
        scene::readSceneToml(record.at("small").at("scene").get<std::string>(), "small.toml");
    BOOST_TEST(small.start_qd.at(0).text() == "1");
  }
  BOOST_TEST(moved > 2);
}
