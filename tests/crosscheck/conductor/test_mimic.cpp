// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that follow others: known answers, every witness, every road, and what is refused.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <cmath>

#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/mimic.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

scene::Scene fromToml(const std::string& text) {
  return scene::readSceneToml(text, "mimic.toml");
}

const std::string kTwoSliders = R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "b"
parent = "base"
mass = 3
joint = { kind = "prismatic", axis = [1, 0, 0], mimic = { joint = "a", multiplier = -1, offset = 0.25 } }
[[link]]
name = "a"
parent = "base"
mass = 2
joint = { kind = "prismatic", axis = [0, 0, 1] }
)";

/// Two rods in a row, each a point mass m at the end of l, the second turning back by half.
const std::string kHalfBack = R"(
gravity = [0, "-g", 0]
[parameters]
g = 9.81
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 1.5
com = [0.4, 0, 0]
joint = { kind = "revolute" }
[[link]]
name = "lower"
parent = "upper"
mass = 0.8
com = [0.3, 0, 0]
joint = { kind = "revolute", xyz = [0.4, 0, 0], mimic = { joint = "upper", multiplier = -0.5, offset = 0.2 } }
)";

scene::State<double> stateOf(const scene::Scene& scene, std::vector<double> q,
                             std::vector<double> qd, std::vector<double> last) {
  scene::State<double> state;
  for (const double x : scene::allPositions(scene.mechanism, q))
    state.x.push_back(scene::jointPosition(x));
  state.qd = std::move(qd);
  state.qdd = last;
  state.tau = std::move(last);
  return state;
}

Eigen::MatrixXd ask(const WitnessKind& kind, const scene::Scene& scene, Quantity quantity,
                    const scene::State<double>& state) {
  return kind.make(scene).value()->answer(quantity, state).value;
}

std::vector<WitnessKind> presentKinds() {
  std::vector<WitnessKind> kinds;
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.present) kinds.push_back(kind);
  return kinds;
}

std::string complaint(const std::string& text) {
  try {
    fromToml(text);
  } catch (const scene::InputError& error) {
    return error.what();
  }
  return "none";
}

std::string twoJoints(const std::string& first, const std::string& second) {
  return "[[link]]\nname = \"base\"\n[[link]]\nname = \"a\"\nparent = \"base\"\nmass = 1\n"
         "com = [1, 0, 0]\njoint = { " +
         first +
         " }\n[[link]]\nname = \"b\"\nparent = \"a\"\nmass = 1\ncom = [1, 0, 0]\njoint = { " +
         second + " }\n";
}

/// Every check of the scene over the field, by name; those that are not answerable are left out.
void requireExact(const scene::Scene& scene, const std::string& may_be_silent = "") {
  for (const CheckResult& check : exactChecks(scene, {})) {
    if (check.verdict == Verdict::kNotAnswerable && check.name() == may_be_silent) continue;
    BOOST_TEST((check.verdict == Verdict::kAgree),
               scene.name << ": " << check.name() << ", " << check.quantity << " (" << check.left
                          << ", " << check.right << "): " << check.reason);
  }
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// By hand: T = (m_a + k^2 m_b) v^2 / 2, V = m_a g z, the follower's slide is level; tau_a + k
// tau_b.
BOOST_AUTO_TEST_CASE(two_sliders_weigh_together_what_the_multiplier_makes_of_them) {
  const scene::Scene scene = fromToml(kTwoSliders);
  BOOST_TEST(scene.mechanism.dof() == 1);
  BOOST_TEST(scene.mechanism.positions() == 2);
  const auto state = stateOf(scene, {0.1}, {0.7}, {4});
  BOOST_TEST(state.x[0].q == 0.15);  // b stands first: -0.1 + 0.25
  for (const WitnessKind& kind : presentKinds()) {
    BOOST_TEST_CONTEXT(kind.info.name) {
      const auto witness = kind.make(scene).value();
      if (witness->answers(Quantity::kM))
        BOOST_TEST(witness->value(Quantity::kM, state)(0, 0) == 5.0);
      if (witness->answers(Quantity::kTau))
        BOOST_TEST(std::abs(witness->value(Quantity::kTau, state)(0, 0) - (5 * 4 + 2 * 9.81)) <
                   1e-13);
      if (witness->answers(Quantity::kQdd))
        BOOST_TEST(std::abs(witness->value(Quantity::kQdd, state)(0, 0) - (4 - 2 * 9.81) / 5) <
                   1e-14);
      if (witness->answers(Quantity::kKinetic))
        BOOST_TEST(std::abs(witness->value(Quantity::kKinetic, state)(0, 0) - 2.5 * 0.49) < 1e-15);
    }
  }
}

// Lagrange by hand, with phi = q/2 + 0.2 the direction of the second rod, so that its mass moves at
//  x = l1 cos q + l2 cos phi, ...  T = (m1 l1^2 + m2 (l1^2 + l2^2/4 + l1 l2 cos(q - phi))) qd^2 / 2
//   d(q - phi)/dt = qd/2:  c = -m2 l1 l2 sin(q - phi) qd^2 / 4
//   V = g ((m1 + m2) l1 sin q + m2 l2 sin phi)
BOOST_DATA_TEST_CASE(a_rod_that_turns_back_by_half_moves_as_lagrange_says,
                     data::make({0.0, 0.9, -2.3, 3.0}), q) {
  const scene::Scene scene = fromToml(kHalfBack);
  const double m1 = 1.5, m2 = 0.8, l1 = 0.4, l2 = 0.3, g = 9.81, qd = 1.7, qdd = -0.6,
               phi = q / 2 + 0.2;
  const double M = m1 * l1 * l1 + m2 * (l1 * l1 + l2 * l2 / 4 + l1 * l2 * std::cos(q - phi));
  const double c = -m2 * l1 * l2 * std::sin(q - phi) * qd * qd / 4;
  const double G = g * ((m1 + m2) * l1 * std::cos(q) + m2 * l2 * std::cos(phi) / 2);
  const auto state = stateOf(scene, {q}, {qd}, {qdd});
  for (const WitnessKind& kind : presentKinds()) {
    BOOST_TEST_CONTEXT(kind.info.name) {
      const auto witness = kind.make(scene).value();
      const auto near = [&](Quantity quantity, double expected) {
        if (!witness->answers(quantity)) return;
        const Answer said = witness->answer(quantity, state);
        BOOST_TEST(std::abs(said.value(0, 0) - expected) <= said.bound(0, 0) + 1e-14);
        BOOST_TEST(said.bound(0, 0) < 1e-10);  // it says something
      };
      near(Quantity::kM, M);
      near(Quantity::kc, c);
      near(Quantity::kg, G);
      near(Quantity::kTau, M * qdd + c + G);
      near(Quantity::kQdd, (qdd - c - G) / M);
      near(Quantity::kKinetic, M * qd * qd / 2);
    }
  }
}

// tau of the mechanism is what the tree's joints need at the followed motion, summed as virtual
// work says.
BOOST_AUTO_TEST_CASE(a_leaders_force_is_its_own_and_its_followers_times_the_multiplier) {
  const scene::Scene scene = scene::findScene("gripper");
  scene::Scene tree = scene;
  tree.mechanism = scene::withoutMimics(scene.mechanism);
  tree.start_qd.resize(tree.mechanism.dof());
  // rates: wrist, left_finger, thumb_base; of the tree: wrist, right, left, thumb_base, thumb_tip
  BOOST_REQUIRE(scene.mechanism.dof() == 3);
  for (int k = 0; k < 5; ++k) {
    const auto state = drawState(scene.mechanism, scene.name, 3, k);
    auto all = state;
    const auto expanded = [](const std::vector<double>& v) {
      return std::vector<double>{v[0], -v[1], v[1], v[2], v[2] * 2 / 3};
    };
    all.qd = expanded(state.qd);
    all.qdd = expanded(state.qdd);
    const Eigen::MatrixXd whole = ask(newtonEulerKind(), scene, Quantity::kTau, state),
                          each = ask(newtonEulerKind(), tree, Quantity::kTau, all);
    BOOST_TEST(std::abs(whole(0, 0) - each(0, 0)) < 1e-13);
    BOOST_TEST(std::abs(whole(1, 0) - (each(2, 0) - each(1, 0))) < 1e-13);
    BOOST_TEST(std::abs(whole(2, 0) - (each(3, 0) + each(4, 0) * 2 / 3)) < 1e-13);
    BOOST_TEST(state.x[1].q == -state.x[2].q - 0.002);  // exact: one product by 1 and one rounding
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(all_roads)

BOOST_AUTO_TEST_CASE(all_checks_of_the_gripper_hold_exactly) {
  requireExact(scene::findScene("gripper"));
}

BOOST_AUTO_TEST_CASE(the_witnesses_and_the_engines_agree_on_the_gripper) {
  const scene::Scene scene = scene::findScene("gripper");
  Options options;
  options.states = 20;
  int answered = 0;
  for (const CheckResult& check : compareWitnesses(scene, presentKinds(), options)) {
    if (check.verdict == Verdict::kAgree) ++answered;
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.statement << ": " << check.reason);
    BOOST_TEST((check.verdict != Verdict::kNotAnswerable), check.statement << ": " << check.reason);
  }
  BOOST_TEST(answered > 100);
  for (const CheckResult& check : checkIdentities(scene, options))
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.statement << ": " << check.reason);
}

// A chain of chains: leaders after followers, followers of followers, ancestors, descendants, other
// branches, rotors that gyrate, friction and screws: the campaign draws them all.
BOOST_AUTO_TEST_CASE(random_mechanisms_with_followers_hold_exactly) {
  int coupled = 0;
  for (int i = 0; coupled < 12; ++i) {
    const scene::Scene scene = randomScene(5, i, 6);
    if (!scene.mechanism.hasMimics()) continue;
    ++coupled;
    requireExact(scene, "independence of the chosen root");
  }
}

// Over the field a follower's point is one of its own, whatever the offset; in double the offset is
// what moves it.
BOOST_AUTO_TEST_CASE(a_lost_offset_or_sign_or_follower_is_found) {
  const scene::Scene right = scene::findScene("gripper");
  Options options;
  options.states = 5;
  const auto disagreements = [&](const scene::Scene& wrong) {
    WitnessKind planted = newtonEulerKind();
    planted.info.name = "planted";
    planted.make = [make = planted.make, wrong](const PreparedScene&) { return make(wrong); };
    int count = 0;
    for (const CheckResult& check :
         compareWitnesses(right, {compositeBodyKind(), planted}, options))
      if (check.verdict == Verdict::kDisagree) ++count;
    for (const CheckResult& check : compareWitnesses(right, {lagrangeKind(), planted}, options))
      if (check.verdict == Verdict::kDisagree) ++count;
    return count;
  };
  BOOST_TEST(disagreements(right) == 0);
  scene::Scene sign = right;  // positions are the state's: rates and forces go the wrong way
  sign.mechanism.links[2].joint.mimic->multiplier = scene::Number(1);
  BOOST_TEST(disagreements(sign) > 0);
  scene::Scene slower = right;
  slower.mechanism.links[5].joint.mimic->multiplier = scene::Number::parse("0.666666666");
  BOOST_TEST(disagreements(slower) > 0);
  scene::Scene offset = right;  // the springs see it
  offset.mechanism.links[5].joint.mimic->offset = scene::Number(0);
  BOOST_TEST(disagreements(offset) > 0);
}

BOOST_AUTO_TEST_CASE(forward_dynamics_needs_no_inertia_of_a_joint_alone) {
  // the leader carries nothing but what its follower moves, and the tree's M is singular
  const scene::Scene scene = fromToml(R"(
[[link]]
name = "base"
[[link]]
name = "a"
parent = "base"
joint = { kind = "prismatic" }
[[link]]
name = "b"
parent = "base"
mass = 2
joint = { kind = "prismatic", mimic = { joint = "a", multiplier = 3 } }
)");
  const auto state = stateOf(scene, {0.3}, {0}, {9});
  BOOST_TEST(std::abs(ask(articulatedBodyKind(), scene, Quantity::kQdd, state)(0, 0) - 0.5) <
             1e-15);
  BOOST_TEST(std::abs(ask(lagrangeKind(), scene, Quantity::kQdd, state)(0, 0) - 0.5) < 1e-15);
}

BOOST_AUTO_TEST_CASE(a_simulation_keeps_followers_where_they_belong) {
  const scene::Scene scene = scene::findScene("gripper");
  SimulateOptions options;
  options.duration = 0.2;
  const Simulation simulation = simulate(scene, options);
  for (const Simulation::Point& point : simulation.points) {
    BOOST_TEST(std::abs(point.q[1] + point.q[2] + 0.002) < 1e-14);
    BOOST_TEST(std::abs(point.q[4] - point.q[3] * 2 / 3 - std::acos(-1.0) / 12) < 1e-14);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(files)

BOOST_AUTO_TEST_CASE(a_scene_with_followers_is_written_as_it_was_read) {
  for (const scene::Scene& scene :
       {scene::findScene("gripper"), fromToml(kTwoSliders), fromToml(kHalfBack)}) {
    const std::string text = scene::writeSceneToml(scene);
    const scene::Scene again = scene::readSceneToml(text, scene.file);
    BOOST_TEST(scene::writeSceneToml(again) == text);
    BOOST_TEST(again.start_q.size() == scene.start_q.size());
  }
}

BOOST_AUTO_TEST_CASE(urdf_says_mimic_and_is_read_as_that) {
  const scene::Scene scene = scene::findScene("gripper");
  const std::string urdf = scene::writeSceneUrdf(scene);
  BOOST_TEST(urdf.find("<mimic joint=\"left_finger\" multiplier=\"-1\" offset=\"-0.002\"/>") !=
             std::string::npos);
  const scene::Scene again = scene::readSceneUrdf(urdf, "gripper.urdf");
  BOOST_REQUIRE(again.mechanism.dof() == 3);
  const auto a = scene::followers(scene.mechanism), b = scene::followers(again.mechanism);
  BOOST_REQUIRE(a.size() == b.size());
  BOOST_TEST((a[0].multiplier == b[0].multiplier));
  BOOST_TEST(again.not_modelled.size() == 1u);  // the limits that URDF asks of a slide
  // engines get the tree: what they make of <mimic> is a servo, or nothing
  BOOST_TEST(scene::urdfForEngines(scene).find("<mimic") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_rotor_in_a_transmission_is_read_and_a_reduction_alone_is_told) {
  const auto robot = [](const std::string& actuator) {
    return scene::readSceneUrdf(
        R"(<robot name="r"><link name="base"/><link name="arm"><inertial><mass value="1"/><inertia ixx="1" iyy="1"
        izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="continuous"><parent link="base"/>
        <child link="arm"/><axis xyz="0 0 1"/></joint><transmission name="t"><type>simple</type><joint name="j"/>
        <actuator name="m">)" +
            actuator + "</actuator></transmission></robot>",
        "r.urdf");
  };
  const scene::Scene rotor =
      robot("<drake:rotor_inertia value=\"0.002\"/><mechanicalReduction>50</mechanicalReduction>");
  BOOST_TEST(rotor.mechanism.links[1].joint.rotor_inertia.text() == "0.002");
  BOOST_TEST(rotor.mechanism.links[1].joint.gear_ratio.text() == "50");
  BOOST_TEST(rotor.not_modelled.empty());
  const scene::Scene told = robot("<mechanicalReduction>50</mechanicalReduction>");
  BOOST_REQUIRE(told.not_modelled.size() == 1u);
  BOOST_TEST(told.not_modelled[0] ==
             "transmission t: reduction 50 not modelled (no rotor inertia is given)");
  BOOST_TEST(robot("<mechanicalReduction>1</mechanicalReduction>").not_modelled.empty());
  BOOST_TEST(robot("<motorInertia>1</motorInertia>").not_modelled.size() == 1u);
}

BOOST_AUTO_TEST_CASE(a_chain_of_followers_is_one_step_each) {
  const scene::Scene scene = fromToml(R"(
[[link]]
name = "base"
[[link]]
name = "c"
parent = "base"
mass = 1
joint = { kind = "prismatic", mimic = { joint = "b", multiplier = "1/3", offset = 0.5 } }
[[link]]
name = "b"
parent = "base"
mass = 1
joint = { kind = "prismatic", mimic = { joint = "a", multiplier = -6, offset = 3 } }
[[link]]
name = "a"
parent = "base"
mass = 1
joint = { kind = "prismatic" }
)");
  const auto followers = scene::followers(scene.mechanism);
  BOOST_REQUIRE(followers.size() == 2u);
  BOOST_TEST((followers[0].multiplier == scene::Rational(-2)));
  BOOST_TEST(followers[0].leader == 3);
  const std::vector<double> q = scene::allPositions(scene.mechanism, {0.25});
  BOOST_TEST(q[0] == 1.0);  // (3 - 6/4)/3 + 0.5
  BOOST_TEST(q[1] == 1.5);
  BOOST_TEST(ask(compositeBodyKind(), scene, Quantity::kM, stateOf(scene, {0.25}, {0}, {0}))(
                 0, 0) == 41.0);
}

BOOST_AUTO_TEST_CASE(what_no_joint_can_follow_is_refused_by_name) {
  const std::string turn = "kind = \"revolute\"";
  const auto expect = [](const std::string& text, const std::string& words) {
    const std::string said = complaint(text);
    BOOST_TEST(said.find(words) != std::string::npos, "said: " << said);
    BOOST_TEST(said.find("mimic.toml:") == 0u, "said: " << said);
  };
  const auto follows = [&](const std::string& table) {
    return turn + ", mimic = { " + table + " }";
  };
  expect(twoJoints(turn, follows("joint = \"z\"")), "there is no joint \"z\"");
  expect(twoJoints(turn, follows("joint = \"b\"")), "which follows it");
  expect(twoJoints(follows("joint = \"b\""), follows("joint = \"a\"")), "which follows it");
  expect(twoJoints(turn, follows("joint = \"a\", multiplier = 0")), "multiplier is 0");
  expect(twoJoints(turn, follows("joint = \"a\", multiplier = \"pi\"")), "without pi");
  expect(twoJoints(turn, follows("multiplier = 2")), "has no joint");
  expect(twoJoints(turn, follows("joint = \"a\", ratio = 2")), "unknown key \"ratio\"");
  expect(twoJoints("kind = \"spherical\"", follows("joint = \"a\"")),
         "is spherical, allowed: revolute");
  expect(twoJoints("kind = \"fixed\"", follows("joint = \"a\"")), "is fixed, allowed: revolute");
  expect(twoJoints(turn + ", motion = \"t\"", follows("joint = \"a\"")), "driven");
  expect(twoJoints(turn, follows("joint = \"a\"") + ", motion = \"t\""), "driven");
  expect(twoJoints(turn, "kind = \"universal\", mimic = { joint = \"a\" }"), "has mimic");
  expect("[parameters]\nk = 2\n" + twoJoints(turn, follows("joint = \"a\", multiplier = \"k\"")),
         "without parameters");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(rotors_geared_to_several_rates)

// By hand: J = 0.5 kg m^2 turns at psi' = 2 nu_1 - nu_2 about x on a link that is fixed in the
// world: that joint bears J psi'' = -0.5 N m more about x at nu' = (1, 3). Simbody is asked about a
// tree in which the rotor turns in the world, so that it cannot be asked for reactions.
BOOST_AUTO_TEST_CASE(a_joint_that_holds_the_carrier_feels_them) {
  const auto sceneWith = [](const std::string& rotors) {
    return fromToml(
        "[[link]]\nname = \"base\"\n[[link]]\nname = \"post\"\nparent = "
        "\"base\"\nmass = 1\njoint = { kind = \"fixed\" }\n[[link]]\nname = "
        "\"arm\"\nparent = \"post\"\nmass = 2\ncom = [0.1, 0, 0]\n[link.joint]\nkind = "
        "\"cylindrical\"\naxis = [0, 0, 1]\n" +
        rotors);
  };
  const scene::Scene with = sceneWith(
                         "rotors = [{ inertia = 0.5, ratio = [2, -1], axis = [1, 0, 0] }]\n"),
                     without = sceneWith("");
  scene::State<double> state;
  state.x = {scene::jointPosition(0.3), scene::jointPosition(0.4)};
  state.qd = {1, 2};
  state.qdd = {1, 3};
  state.tau = {0, 0};
  const auto reactions = [&](const scene::Scene& scene) {
    return newtonEulerKind().make(scene).value()->value(Quantity::kReactions, state);
  };
  const Eigen::MatrixXd more = reactions(with) - reactions(without);
  BOOST_TEST(std::abs(more(3, 0) + 0.5) < 1e-14);
  for (const int k : {0, 1, 2, 4, 5}) BOOST_TEST(more(k, 0) == 0);
  const auto simbody = simbodyKind().make(with).value();
  BOOST_TEST(simbody->answers(Quantity::kTau));
  BOOST_TEST(!simbody->answers(Quantity::kReactions));
  std::vector<std::string> reasons;
  for (const auto& [quantity, reason] : dynamic_cast<const PartialWitness&>(*simbody).leftOut())
    if (quantity == Quantity::kReactions) reasons.push_back(reason);
  BOOST_REQUIRE(reasons.size() == 1u);
  BOOST_TEST(reasons[0].find("the joint does not bear it") != std::string::npos, reasons[0]);
}

BOOST_AUTO_TEST_SUITE_END()
