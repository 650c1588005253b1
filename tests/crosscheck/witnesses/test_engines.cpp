// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo, DART and KDL, as far as this build has them, against our sweeps.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/witness_names.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

std::vector<WitnessKind> engines() {
  return {mujocoKind(), mujocoPrincipalKind(), dartKind(), kdlKind()};
}
std::vector<WitnessKind> presentEngines() {
  std::vector<WitnessKind> present;
  for (const WitnessKind& kind : engines())
    if (kind.info.present) present.push_back(kind);
  return present;
}

Options statesOf(int count) {
  Options options;
  options.states = count;
  options.seed = 5;
  return options;
}

std::string textOf(const CheckResult& check) {
  std::ostringstream out;
  out << check.statement << ": " << name(check.verdict) << " " << check.reason << ", ratio "
      << check.ratio;
  return out.str();
}

/// The engine's answers against both of our sweeps that answer the quantity.
std::vector<CheckResult> checksOf(const WitnessKind& engine, const scene::Scene& scene,
                                  int states) {
  std::vector<CheckResult> checks;
  for (const CheckResult& check : compareWitnesses(
           scene, {newtonEulerKind(), articulatedBodyKind(), engine}, statesOf(states)))
    if (check.right == engine.info.name) checks.push_back(check);
  return checks;
}

/// The largest relative error of M over some states, newton_euler being right.
double relativeErrorOfM(const WitnessKind& engine, const scene::Scene& scene) {
  const auto reference = newtonEulerKind().make(scene).value(), asked = engine.make(scene).value();
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    const scene::State<double> state = drawState(scene.mechanism, scene.name, 5, k);
    const Eigen::MatrixXd M = reference->answer(Quantity::kM, state).value;
    const Eigen::MatrixXd error = asked->answer(Quantity::kM, state).value - M;
    worst = std::max(worst, error.cwiseAbs().maxCoeff() / M.cwiseAbs().maxCoeff());
  }
  return worst;
}

/// Its root has a mass and the name that some engines keep for themselves.
scene::Scene weightyWorld() {
  return scene::readSceneToml(R"(
[[link]]
name = "world"
mass = 1
[[link]]
name = "arm"
parent = "world"
mass = 1
com = [1, 0, 0]
[link.joint]
kind = "revolute"
)",
                              "weighty_world.toml");
}

}  // namespace

namespace {

/// Why an engine has no joints for a mechanism; "" where it has.
std::string missing(const std::string& engine, const scene::Mechanism& mechanism) {
  if (mechanism.hasGyroscopicRotors()) return "is gyroscopic";
  for (const scene::Link& link : mechanism.links) {
    const scene::JointKind kind = link.joint.kind;
    const bool is_helical = kind == scene::JointKind::kHelical;
    if (engine == "kdl" && (is_helical || scene::degreesOfFreedom(kind) > 1))
      return "this witness builds fixed, revolute and prismatic";
    if (engine.rfind("mujoco", 0) == 0 && is_helical) return "MuJoCo has no joint that turns";
  }
  return "";
}

}  // namespace

BOOST_AUTO_TEST_SUITE(crosscheck_of_engines)

BOOST_DATA_TEST_CASE(each_engine_agrees_with_our_sweeps_on_every_quantity,
                     data::make(scene::bundledScenes())) {
  // Measured at 2 000 states of each of 16 scenes, seed 7, the loss of `mujoco` aside: at most 67 %
  // of the limits are used (mujoco_principal, kinetic, elastic_pendulum); by DART and KDL 44 %.
  const scene::Scene scene = scene::readScene(sample);
  for (const WitnessKind& engine : presentEngines()) {
    const std::vector<CheckResult> checks = checksOf(engine, scene, 25);
    const std::string why_not = missing(engine.info.name, scene.mechanism);
    // these engines are not asked for reactions, and have no momentum of rotors in the world; one
    // that refuses says so to every question
    const std::size_t lacks = scene.mechanism.hasGearedRotors() ? 2 : 1;
    BOOST_TEST(checks.size() == std::size(kAllQuantities) - (why_not.empty() ? lacks : 0));
    for (const CheckResult& check : checks) {
      if (why_not.empty()) {
        BOOST_TEST((check.verdict == Verdict::kAgree), textOf(check));
      } else {  // refused, never answered wrongly
        BOOST_TEST((check.verdict == Verdict::kNotAnswerable), textOf(check));
        BOOST_TEST(check.reason.find(why_not) != std::string::npos, textOf(check));
      }
    }
  }
}

/// Every kind of joint, one on another, in places and about axes of no symmetry: floating ones in
/// the world and on a link that moves.
scene::Scene jointsOfEveryKind(bool with_screw) {
  std::string text = R"(
gravity = [1, 2, -9]
[[link]]
name = "world <&> root"
[[link]]
name = "shelf"
parent = "world <&> root"
[link.joint]
kind = "fixed"
xyz = [0.3, -0.2, 0.1]
rpy = [0.4, 0.5, -0.6]
)";
  std::string parent = "shelf";
  for (const std::string kind : {"floating", "universal", "spherical", "cylindrical", "planar",
                                 "floating", "helical", "revolute"}) {
    if (kind == "helical" && !with_screw) continue;
    const std::string name = "on " + parent;
    text += "[[link]]\nname = \"" + name + "\"\nparent = \"" + parent + R"("
mass = 1.5
com = [0.1, 0.2, -0.3]
inertia = { about = "com", xx = 0.11, yy = 0.12, zz = 0.13 }
[link.joint]
xyz = [0.2, -0.1, 0.3]
rpy = [0.5, -0.3, 0.7]
)" + "kind = \"" +
            kind + "\"\n";
    if (kind == "helical") text += "pitch = 0.2\n";
    if (kind == "cylindrical" || kind == "planar" || kind == "helical" || kind == "revolute")
      text += "axis = [1, -2, 3]\n";
    parent = name;
  }
  text += "[[wrench]]\nlink = \"" + parent + R"("
force = [1, 2, 3]
moment = [0.3, -0.2, 0.1]
at = [0.1, 0.2, 0]
)";
  return scene::readSceneToml(text, "every_kind.toml");
}

// For w x v lost, a rotation the other way round, quaternions in another order.
BOOST_DATA_TEST_CASE(engines_have_joints_of_every_kind, data::make({false, true}), with_screw) {
  const scene::Scene scene = jointsOfEveryKind(with_screw);
  for (const WitnessKind& engine : presentEngines()) {
    if (!missing(engine.info.name, scene.mechanism).empty()) continue;
    const std::vector<CheckResult> checks = checksOf(engine, scene, 10);
    BOOST_TEST(checks.size() == std::size(kAllQuantities) - 1);
    for (const CheckResult& check : checks)
      BOOST_TEST((check.verdict == Verdict::kAgree), textOf(check));
  }
}

// DART breaks the series of its exponential off below 1e-3 rad: 2e-10 of R would be lost there.
BOOST_DATA_TEST_CASE(small_turns_lose_nothing,
                     data::make({0.0, 1e-300, 1e-9, 4e-4, 4.99e-4, 5.01e-4, 6e-4}), half_turn) {
  const scene::Scene scene = scene::findScene("heavy_top");
  scene::State<double> state = drawState(scene.mechanism, scene.name, 5, 0);
  const double q[] = {-3, -half_turn, 2 * half_turn, 2 * half_turn};
  for (int k = 0; k < 4; ++k) state.x[k] = scene::jointPosition(q[k]);
  const auto reference = newtonEulerKind().make(scene).value();
  const Eigen::MatrixXd g = reference->answer(Quantity::kg, state).value;
  for (const WitnessKind& engine : presentEngines()) {
    if (!missing(engine.info.name, scene.mechanism).empty()) continue;
    const Answer answer = engine.make(scene).value()->answer(Quantity::kg, state);
    BOOST_TEST((answer.value - g).cwiseAbs().maxCoeff() <= answer.bound.maxCoeff(),
               engine.info.name);
    BOOST_TEST(answer.bound.maxCoeff() < 1e-12);
  }
}

// An arm without products of inertia, so that `mujoco` has no loss that could hide the mistake.
BOOST_AUTO_TEST_CASE(each_engine_sees_a_mass_that_is_wrong_in_the_ninth_digit) {
  const scene::Scene right = scene::findScene("kuka_iiwa_14");
  scene::Scene wrong = right;
  scene::Number& mass = wrong.mechanism.links.back().inertia.mass;
  const scene::Rational exact = scene::exactValue(mass, wrong.mechanism.parameterValues()).rational;
  mass = scene::Number(exact + exact / 1000000000);
  for (const WitnessKind& engine : presentEngines()) {
    WitnessKind mistaken = engine;
    mistaken.make = [&](const PreparedScene&) { return engine.make(wrong); };
    for (const CheckResult& check : checksOf(mistaken, right, 5))
      BOOST_TEST((check.verdict == Verdict::kDisagree), textOf(check));
  }
}

BOOST_AUTO_TEST_CASE(an_engine_that_cannot_hold_a_scene_says_why) {
  for (const WitnessKind& engine : presentEngines())
    for (const CheckResult& check : checksOf(engine, weightyWorld(), 2)) {
      if (engine.info.name == "kdl") {  // which has no special names
        BOOST_TEST((check.verdict == Verdict::kAgree), textOf(check));
        continue;
      }
      BOOST_TEST((check.verdict == Verdict::kNotAnswerable), textOf(check));
      BOOST_TEST(check.reason.find("'world'") != std::string::npos, textOf(check));
    }
}

// Names are told without loading engines, so that they stand in a list of their own.
BOOST_AUTO_TEST_CASE(witnesses_are_listed_by_the_names_that_they_have) {
  std::vector<std::string> names;
  for (const WitnessKind& kind : witnessKinds()) names.push_back(kind.info.name);
  BOOST_TEST(witnessNames() == names, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(an_absent_engine_says_that_it_is_absent) {
  const scene::Scene scene = scene::findScene("simple_pendulum");
  for (const WitnessKind& engine : engines()) {
    if (engine.info.present) continue;
    const MadeWitness made = engine.make(scene);
    BOOST_TEST_REQUIRE(made.isRefused());
    BOOST_TEST(made.refusal() == "not found when dynwitness was built");
  }
}

BOOST_AUTO_TEST_CASE(each_engine_shows_its_conventions_as_labelled_lines) {
  for (const WitnessKind& engine : presentEngines()) {
    std::istringstream card(engine.info.conventions);
    std::string line, labels;
    while (std::getline(card, line)) {
      const std::size_t colon = line.find(": ");
      BOOST_TEST_REQUIRE(colon != std::string::npos, engine.info.name << ": " << line);
      labels += line.substr(0, colon) + ";";
    }
    for (const char* label : {"reads;", "spatial vectors;", "inertia;", "bias;", "gravity;",
                              "springs;", "friction;", "rotors;", "loads;", "known loss;"})
      BOOST_TEST(labels.find(label) != std::string::npos,
                 engine.info.name << " says nothing of " << label);
  }
}

BOOST_AUTO_TEST_CASE(engines_read_a_urdf_file_whose_shapes_are_missing) {
  std::string urdf = scene::writeSceneUrdf(scene::findScene("franka_panda"));
  urdf.insert(urdf.find("<inertial>"),
              "<visual><geometry><mesh filename=\"package://nowhere/a.stl\"/></geometry></visual>");
  const fs::path file =
      fs::temp_directory_path() / ("dynwitness_engines_" + std::to_string(getpid()) + ".urdf");
  std::ofstream(file) << urdf;
  const scene::Scene scene = scene::readScene(file);
  for (const WitnessKind& engine : presentEngines())
    for (const CheckResult& check : checksOf(engine, scene, 5))
      BOOST_TEST((check.verdict == Verdict::kAgree), textOf(check));
  fs::remove(file);
}

BOOST_AUTO_TEST_SUITE_END()

// MuJoCo's compiler leaves up to 1.4e-6 rad of the way to the principal axes, see mujoco.cpp.
BOOST_AUTO_TEST_SUITE(loss_of_mujoco)

BOOST_AUTO_TEST_CASE(products_of_inertia_cost_digits_and_principal_axes_bring_them_back) {
  if (!mujocoKind().info.present) return;
  // measured at 100 states: 5e-8 and 2e-15
  const scene::Scene panda = scene::findScene("franka_panda");
  BOOST_TEST(relativeErrorOfM(mujocoKind(), panda) > 1e-9);
  BOOST_TEST(relativeErrorOfM(mujocoKind(), panda) < 1e-6);
  BOOST_TEST(relativeErrorOfM(mujocoPrincipalKind(), panda) < 1e-14);
}

BOOST_AUTO_TEST_CASE(no_products_of_inertia_no_loss) {
  if (!mujocoKind().info.present) return;
  BOOST_TEST(relativeErrorOfM(mujocoKind(), scene::findScene("kuka_iiwa_14")) < 1e-14);
}

// The limit of `mujoco` is the effect of the compiled inertias, found by our sweeps. Where the loss
// is a million times the rounding, the error uses all of that limit: it has no other cause.
BOOST_AUTO_TEST_CASE(the_compiled_inertias_explain_the_loss_and_there_is_no_more_of_it) {
  if (!mujocoKind().info.present) return;
  for (const CheckResult& check : checksOf(mujocoKind(), scene::findScene("franka_panda"), 25)) {
    BOOST_TEST((check.verdict == Verdict::kAgree), textOf(check));
    if (check.worst > 1e6) BOOST_TEST(check.ratio > 0.999, textOf(check));
  }
}

BOOST_AUTO_TEST_SUITE_END()
