// SPDX-License-Identifier: GPL-3.0-or-later
// Whole mechanisms, closures, springs, drives and acceleration constraints together: all roads of
// every bundled scene that has any agree, and a fault planted into one of them is found.
#include "crosscheck/verdicts/check_mechanism.hpp"

#include <algorithm>
#include <cmath>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/motion/closed_states.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "tests/fixtures/wrong_roads.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::MechanismFault;

namespace {

const std::vector<std::string> kScenes = {
    "andrews_squeezer",   "bead_on_hoop",        "bicycle",          "bricard",
    "car_axis",           "chaplygin_sleigh",    "flyball_governor", "humanoid_both_feet",
    "humanoid_left_foot", "humanoid_right_foot", "kapitza_pendulum", "loop_on_arm",
    "pendulum_on_slides", "rolling_coin",        "satellite_held",   "two_handed"};

Options few(int states) {
  Options options;
  options.states = states;
  return options;
}

}  // namespace

BOOST_AUTO_TEST_CASE(no_bundled_scene_that_is_more_than_its_tree_is_left_out) {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    if (ConstrainedQuantities::isConstrained(scene.mechanism)) names.push_back(scene.name);
  }
  BOOST_TEST(names == kScenes, boost::test_tools::per_element());
}

namespace {

void requireAgreement(const std::string& name, const scene::Scene& scene) {
  const std::vector<CheckResult> checks =
      checkMechanism(PreparedScene(scene), few(kMechanismStates));
  int compared = 0;
  for (const CheckResult& check : checks) {
    BOOST_TEST_MESSAGE(name << ": " << check.statement << ": " << check.worst << " of "
                            << check.limit << " ulp, " << check.judged() << " states "
                            << check.reason);
    if (check.asksNothing()) {
      BOOST_TEST(!check.reason.empty());
      continue;
    }
    BOOST_TEST_CONTEXT(check.statement << ": " << check.reason) {
      BOOST_TEST((check.verdict != Verdict::kDisagree));
      BOOST_TEST(check.voided == check.excused);
      BOOST_TEST(check.states == kMechanismStates);
    }
    compared += check.verdict == Verdict::kAgree ? 1 : 0;
  }
  BOOST_TEST(compared >= 3);  // qdd of three roads at least
}

}  // namespace

BOOST_DATA_TEST_CASE(all_roads_of_a_whole_mechanism_agree, data::make(kScenes), name) {
  requireAgreement(name, scene::findScene(name));
}

// No bundled scene has a closure between two links that both turn in space, and against each other:
// there an axis is carried along while it turns.
BOOST_DATA_TEST_CASE(closures_between_links_that_turn_in_space_agree,
                     data::make({"hinge", "weld", "point", "plane", "planar_point"}), kind) {
  const std::string place = "xyz = [0.3, 0.4, 0.1], rpy = [0.4, 0.3, 0.2] }\n";
  requireAgreement(kind, scene::readSceneToml(std::string(R"toml(
title = "two bodies"
source = "this test"
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "swung"
parent = "base"
mass = 2
com = [0.2, 0.1, -0.1]
inertia = { about = "com", xx = 0.05, yy = 0.06, zz = 0.07, xy = 0.01, xz = -0.005, yz = 0.002 }
[link.joint]
name = "ball"
kind = "spherical"
[[link]]
name = "carried"
parent = "base"
mass = 1.5
com = [0.5, 0.3, 0.2]
inertia = { about = "com", xx = 0.04, yy = 0.03, zz = 0.05, xy = -0.004, xz = 0.003, yz = 0.006 }
[link.joint]
name = "free"
kind = "floating"
[[closure]]
name = "held"
kind = ")toml") + kind + "\"\na = { link = \"swung\", " +
                                                  place + "b = { link = \"carried\", " + place,
                                              "two_bodies.toml"));
}

namespace {

/// A fault is found in a scene within the limits of a road.
void expectFound(const std::string& name, MechanismFault fault, const std::string& claims) {
  const PreparedScene scene(scene::findScene(name));
  // gamma = 0: a parallelogram's coupler does not turn, and the foot that stands is the root
  const bool has_no_gamma = name == "loop_on_arm" || name == "humanoid_right_foot";
  // six hinges in a circle, of which four equations tell all: what they exert is open
  const bool has_no_reactions = name == "bricard";
  // the blade is where the moments of its joint are taken
  const bool has_no_moment = name == "chaplygin_sleigh" && fault == MechanismFault::kLostMoment;
  if (!fixtures::has(scene.mechanism(), fault) ||
      (fixtures::ofReactions(fault) && has_no_reactions) || has_no_moment ||
      (fault == MechanismFault::kLostGamma && has_no_gamma)) {
    BOOST_TEST(true);
    return;
  }
  int found = 0;
  for (const CheckResult& check :
       compareRoads(scene, fixtures::withAWrongRoad(scene, fault, claims), few(2)))
    if (check.verdict == Verdict::kDisagree) {
      BOOST_TEST((check.left == "wrong" || check.right == "wrong"), check.statement);
      ++found;
    }
  BOOST_TEST(found > 0);
}

/// Why MuJoCo does not hold a scene; empty: it does.
std::string whyNotMujoco(const PreparedScene& scene) {
  for (const NamedRoad& road : mechanismRoads(scene))
    if (road.name == "mujoco") return road.road.isRefused() ? road.road.refusal() : "";
  return "no such road";
}

const std::string kAbsent = "not found when dynwitness was built";

}  // namespace

BOOST_DATA_TEST_CASE(a_wrong_road_of_a_whole_mechanism_is_found,
                     data::make(kScenes) * data::make(fixtures::kMechanismFaults), name, fault) {
  expectFound(name, fault, "dense_system");
}

BOOST_DATA_TEST_CASE(limits_of_mujoco_find_a_wrong_road,
                     data::make(kScenes) * data::make(fixtures::kMechanismFaults), name, fault) {
  const std::string why_not = whyNotMujoco(PreparedScene(scene::findScene(name)));
  if (fixtures::ofReactions(fault) || why_not == kAbsent) {  // which it does not tell
    BOOST_TEST(true);
    return;
  }
  BOOST_TEST(why_not == "");
  expectFound(name, fault, "mujoco");
}

BOOST_AUTO_TEST_CASE(mujoco_says_why_it_cannot_hold_a_mechanism) {
  scene::Scene scene = scene::findScene("loop_on_arm");
  const std::string absent = whyNotMujoco(scene);
  if (absent == kAbsent) return;
  BOOST_TEST(absent == "");
  scene::Joint& joint = scene.mechanism.links.back().joint;
  joint.kind = scene::JointKind::kHelical;
  joint.pitch = scene::Number(scene::Rational(1, 10));
  BOOST_TEST(whyNotMujoco(scene).find("is helical, MuJoCo has no joint that turns and advances") !=
             std::string::npos);
}

// Otherwise the scenes would be compared at no state, or at one.
BOOST_DATA_TEST_CASE(states_are_closed_and_differ, data::make(kScenes), name) {
  const PreparedScene scene(scene::findScene(name));
  ClosedStates states(scene);
  std::vector<double> before;
  for (int index = 0; index < 3; ++index) {
    const ClosedState at = states.draw(1, index);
    BOOST_TEST_REQUIRE(at.failure == "");
    std::vector<double> q;
    for (const auto& x : at.state.state.x) q.push_back(x.q);
    BOOST_TEST((q != before));
    before = q;
    BOOST_TEST(std::any_of(at.state.state.qd.begin(), at.state.state.qd.end(),
                           [](double qd) { return std::abs(qd) > 0.01; }));
  }
}

BOOST_AUTO_TEST_CASE(redundant_closures_are_told_and_their_multipliers_not_compared) {
  const std::vector<CheckResult> checks =
      checkMechanism(PreparedScene(scene::findScene("bricard")), few(1));
  int told = 0;
  for (const CheckResult& check : checks)
    if (check.quantity == "mechanism lambda" && !check.asksNothing()) {
      BOOST_TEST(check.excused == 1);
      BOOST_TEST(check.reason.find("4 equations stand for all") != std::string::npos, check.reason);
      ++told;
    }
  BOOST_TEST(told > 0);
}

// Each joint of Bricard's circle carries what another choice of multipliers puts on it, but about
// its axis: of that, which is compared, the joint's own equation says all.
BOOST_AUTO_TEST_CASE(reactions_that_redundant_closures_leave_open_are_named) {
  const PreparedScene scene(scene::findScene("bricard"));
  int told = 0;
  for (const CheckResult& check : checkMechanism(scene, few(2)))
    if (check.quantity == "mechanism reactions" && !check.right.empty()) {
      BOOST_TEST((check.verdict == Verdict::kAgree), check.reason);
      BOOST_TEST(
          check.statement.find("leave some reactions of all joints open") != std::string::npos,
          check.statement);
      ++told;
    }
  BOOST_TEST(told > 0);
  ClosedStates states(scene);
  const std::vector<char> determined = states.draw(1, 0).state.determined;
  BOOST_TEST_REQUIRE(determined.size() == 6 * (scene.mechanism().links.size() - 1));
  for (std::size_t joint = 0; joint < determined.size() / 6; ++joint)
    for (std::size_t k = 0; k < 3; ++k)
      if (!scene.mechanism().links[joint + 1].joint.axis[k].isLiteralZero())
        BOOST_TEST(determined[6 * joint + 3 + k] == 1);
}

BOOST_AUTO_TEST_CASE(one_road_alone_proves_nothing_and_says_so) {
  const PreparedScene scene(scene::findScene("bead_on_hoop"));
  std::vector<NamedRoad> roads = mechanismRoads(scene);
  roads.erase(roads.begin() + 1, roads.end());
  const std::vector<CheckResult> checks = compareRoads(scene, roads, few(1));
  BOOST_TEST_REQUIRE(checks.size() == 1u);
  BOOST_TEST((checks[0].verdict == Verdict::kNotAnswerable));
  BOOST_TEST(coverageOf(checks)[0].isThin());
}

BOOST_AUTO_TEST_CASE(a_tree_has_nothing_besides) {
  BOOST_TEST(checkMechanism(PreparedScene(scene::findScene("puma_560")), few(1)).empty());
}

// No sweep that solves holds joints that follow others; reactions are cut loose by one road, and
// found by Newton and Euler in another.
BOOST_AUTO_TEST_CASE(reactions_of_joints_that_follow_others_are_told_twice) {
  const PreparedScene scene(scene::readSceneToml(R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 1.5
com = [0.4, 0.1, 0]
joint = { kind = "revolute", axis = [0, 1, 0], xyz = [0.1, 0.2, 0.3], rpy = [0.3, 0.2, 0.1] }
[[link]]
name = "lower"
parent = "upper"
mass = 0.8
com = [0.3, 0, 0.1]
joint = { kind = "revolute", axis = [0, 1, 0], xyz = [0.4, 0, 0.1], rpy = [0.2, 0, 0.4], mimic = { joint = "upper", multiplier = -0.5, offset = 0.2 } }
[[link]]
name = "hand"
parent = "lower"
mass = 0.5
com = [0.1, 0.1, 0]
joint = { kind = "revolute", axis = [1, 0, 0], xyz = [0.5, 0.1, 0] }
[[spring]]
a = { link = "hand", xyz = [0.1, 0.2, 0.3] }
b = { link = "base", xyz = [2, 1, 0] }
stiffness = 50
rest = 0.5
)",
                                                 "mimic_spring.toml"));
  int compared = 0;
  for (const CheckResult& check : checkMechanism(scene, few(3)))
    if (!check.asksNothing()) {
      BOOST_TEST((check.verdict == Verdict::kAgree), check.statement << ": " << check.reason);
      compared += check.quantity == "mechanism reactions" && check.left == "lagrange_multipliers" &&
                  check.right == "dense_system";
    }
  BOOST_TEST(compared == 1);
}
