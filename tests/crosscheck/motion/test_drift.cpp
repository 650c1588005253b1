// SPDX-License-Identifier: GPL-3.0-or-later
// Whom the energy drift condemns: a wrong qdd, in every scene whose energy is constant, and never
// steps that are too long for a stiff motion.
#include "crosscheck/motion/drift.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <ostream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/momentum_kept.hpp"
#include "crosscheck/verdicts/check_drift.hpp"
#include "tests/fixtures/program.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Outcome;
using fixtures::Program;

namespace {

/// A point on a rod that falls over on a cart of this mass [kg] (the pole: 0.1 kg). M is regular;
/// but where the pole hangs straight down, the cart alone can turn it back, within sqrt(mass of the
/// cart over that of the pole) of the time of its fall.
std::string lightCartPole(const std::string& cart) {
  return "title = \"Light cart-pole\"\nsource = \"chosen here\"\ngravity = [0, 0, -9.8]\n"
         "[[link]]\nname = \"track\"\n[[link]]\nname = \"cart\"\nparent = \"track\"\nmass = " +
         cart +
         "\njoint = { name = \"slide\", kind = \"prismatic\", axis = [1, 0, 0] }\n"
         "[[link]]\nname = \"pole\"\nparent = \"cart\"\nmass = 0.1\ncom = [0, 0, 0.5]\n"
         "joint = { name = \"hinge\", kind = \"revolute\", axis = [0, 1, 0] }\n"
         "[start]\nq = [0, 0.1]\nqd = [0.2, 0]\n";
}

/// Weight acts upwards.
scene::Mechanism upsideDown(scene::Mechanism mechanism) {
  for (scene::Number& g : mechanism.gravity) g = scene::Number::parse("-(" + g.text() + ")");
  return mechanism;
}

std::vector<std::string> falling() {
  std::vector<std::string> names;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    // the humanoids take minutes
    if (refusals(scene, Command::kDrift).empty() && scene.mechanism.has_gravity &&
        scene.mechanism.dof() <= 9)
      names.push_back(scene.name);
  }
  return names;
}

}  // namespace

BOOST_DATA_TEST_CASE(a_stiff_motion_condemns_nobody, data::make({"1e-3", "1e-6", "1e-9"}), cart) {
  const scene::Scene scene = scene::readSceneToml(lightCartPole(cart), "light.toml");
  const Drift drift = measureDrift(scene, {});
  const CheckResult check = checkDrift(scene, drift);
  BOOST_TEST((check.verdict == Verdict::kAgree), check.reason);
  BOOST_TEST(check.ratio <= 1);
  // equal steps follow the heaviest of the carts at most
  if (std::string(cart) == "1e-9") {
    BOOST_TEST(!isResolved(drift));
    BOOST_TEST((check.unit == Unit::kPowerOfStepError));
    BOOST_TEST(name(check.unit) == "power of a step's error (at least)");
    BOOST_TEST(check.worst > 0.7);  // 5/6 by theory
  }
}

BOOST_DATA_TEST_CASE(a_wrong_qdd_is_condemned_in_a_stiff_motion_too,
                     data::make({"1e-3", "1e-6", "1e-9"}), cart) {
  const scene::Scene scene = scene::readSceneToml(lightCartPole(cart), "light.toml");
  const scene::Mechanism wrong = upsideDown(scene.mechanism);
  DriftOptions options;
  options.moved_by = &wrong;
  const CheckResult check = checkDrift(scene, measureDrift(scene, options), options);
  BOOST_TEST((check.verdict == Verdict::kDisagree), check.statement << check.reason);
}

BOOST_DATA_TEST_CASE(a_wrong_sign_of_gravity_is_condemned_in_every_bundled_scene,
                     data::make(falling()), name) {
  const scene::Scene scene = scene::findScene(name);
  const scene::Mechanism wrong = upsideDown(scene.mechanism);
  DriftOptions options;
  options.duration = 2;
  const CheckResult right = checkDrift(scene, measureDrift(scene, options), options);
  BOOST_TEST((right.verdict != Verdict::kDisagree), right.reason);
  options.moved_by = &wrong;
  const CheckResult check = checkDrift(scene, measureDrift(scene, options), options);
  if (right.verdict == Verdict::kAgree)
    BOOST_TEST((check.verdict == Verdict::kDisagree), check.statement << check.reason);
}

BOOST_AUTO_TEST_CASE(the_program_says_which_steps_do_not_follow_a_motion) {
  const Program program;
  program.write("light.toml", lightCartPole("1e-9"));
  const Outcome none = program.run("drift light.toml --step 0.1,0.05 --duration 1");
  BOOST_TEST(none.status == 2);
  for (const char* part : {"not answerable by this step: at 0.1 s the motion leaves the numbers",
                           "dynwitness simulate", "qdd is not to blame"})
    BOOST_TEST(none.out.find(part) != std::string::npos, none.out);
  program.write("heavier.toml", lightCartPole("1e-3"));
  const Outcome some = program.run("drift heavier.toml --step 0.1,0.0001 --duration 1");
  BOOST_TEST(some.out.find(",nan") == std::string::npos, some.out);
  const Outcome crosscheck =
      program.run("crosscheck light.toml --witness newton_euler,lagrange --random 2 --no-charts");
  BOOST_TEST(crosscheck.out.find("DISAGREE") == std::string::npos, crosscheck.out);
}

/* A cart of 1e-12 kg holds a bob of 1 kg by no force before the rod hangs straight down: the bob
   falls freely, cos(angle) = g t^2 / (2 l), and is thrown back there at t = sqrt(2 l / g) = 0.4515
   s, so that the fall runs backwards on the other side. Steps of 0.01 s pass over that. */
BOOST_AUTO_TEST_CASE(two_methods_expose_a_solver_that_arrives_with_a_wrong_answer) {
  const Program program;
  const std::string file = "light.toml";
  std::ifstream in(std::string(DYNWITNESS_DATA_DIR) + "/reference/motion/light_cart_pole.toml");
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string mass = "M = 1e-6";
  BOOST_TEST_REQUIRE(text.find(mass) != std::string::npos);
  text.replace(text.find(mass), mass.size(), "M = 1e-12");
  program.write(file, text);

  const scene::Scene scene = scene::readSceneToml(text, file);
  const auto drift = [&](const char* method, double duration) {
    DriftOptions options;
    options.method = method;
    options.duration = duration;
    options.steps = {0.01};
    return measureDrift(scene, options);
  };
  const double g = 9.81, bottom = std::sqrt(2 / g);
  const auto angle = [&](double t) { return std::acos(g * t * t / 2); };
  const Drift a = drift("rosenbrock4", 0.4), b = drift("gauss_4", 0.4);
  BOOST_TEST(std::abs(a.paths[0].end[1] - angle(0.4)) < 1e-4);
  BOOST_TEST(comparedEnds(scene, a, b).find("agree to 5 digits") != std::string::npos,
             comparedEnds(scene, a, b));
  BOOST_TEST(!isLost(a.paths[0]));

  const Drift wrong = drift("rosenbrock4", 0.5);
  BOOST_TEST_REQUIRE(!wrong.paths[0].end.empty());  // it says nothing: it arrives
  BOOST_TEST(std::abs(wrong.paths[0].end[1] + angle(2 * bottom - 0.5)) > 1);
  BOOST_TEST(isLost(wrong.paths[0]));
  const Outcome both = program.run(
      "drift light.toml --duration 0.5 --step 0.01 --method "
      "rosenbrock4,semi_implicit_euler");
  for (const char* part :
       {"DISAGREE in the first digit: at t = 0.5 s they are",
        "energy error reached half of the largest kinetic energy at t = 0.49 s: rosenbrock4 with"})
    BOOST_TEST(both.out.find(part) != std::string::npos, both.out);
  const Outcome simulated = program.run("simulate light.toml --duration 2 --method rosenbrock4");
  BOOST_TEST(simulated.status == 1);
  BOOST_TEST(simulated.out.find("positions DISAGREE in the first digit") != std::string::npos,
             simulated.out);
  const Outcome chart = program.run("chart light.toml --simulate --duration 0.5 --method gauss_4");
  BOOST_TEST(chart.status == 3);
  BOOST_TEST(chart.out.find("no reference: after 0.5 s runge_kutta_fehlberg78 in long double does "
                            "not arrive with any step") != std::string::npos,
             chart.out);
}

BOOST_AUTO_TEST_CASE(what_has_no_constant_energy_is_told_in_the_report) {
  const Program program;
  program.run(
      "crosscheck kapitza_pendulum --witness newton_euler,lagrange --random 2 --no-charts "
      "-o r");
  const std::string report = program.read("r/report.json");
  BOOST_TEST(report.find("energy along a motion: joint 'pivot' is driven") != std::string::npos);
  BOOST_TEST(report.find("\"drift\"") == std::string::npos);
}

/* Nothing acts on a humanoid that floats without weight. Seen: 7.4e-14 of its largest part after
   100 steps of order 8, where rounding may do 8.2e-13; 2.2e-7 after as many of order 4. */
BOOST_AUTO_TEST_CASE(the_program_says_how_far_momentum_moves) {
  const scene::Scene humanoid = scene::findScene("humanoid_floating");
  scene::Scene weightless = humanoid;
  weightless.mechanism.has_gravity = false;
  BOOST_TEST(keepsMomentum(weightless.mechanism));
  BOOST_TEST(!keepsMomentum(humanoid.mechanism));
  scene::Mechanism held = scene::findScene("double_pendulum").mechanism;
  held.has_gravity = false;
  BOOST_TEST(!keepsMomentum(held));

  const Program program;
  const std::string floating =
      "drift humanoid_floating --duration 0.2 --step 0.002 --method "
      "runge_kutta_fehlberg78,runge_kutta4";
  const Outcome said = program.run(floating + " --gravity 0,0,0");
  for (const auto& [method, is_kept] :
       {std::pair{"runge_kutta_fehlberg78", true}, {"runge_kutta4", false}}) {
    const std::size_t line =
        said.out.find(std::string("# momentum: ") + method + " with h = 0.002");
    BOOST_TEST_REQUIRE(line != std::string::npos, said.out);
    const auto numberAfter = [&](const std::string& word) {
      return std::stod(said.out.substr(said.out.find(word, line) + word.size()));
    };
    const double moved = numberAfter("from outside, by "),
                 rounding = numberAfter("rounding may by ");
    BOOST_TEST((moved <= rounding) == is_kept, said.out);
    BOOST_TEST(moved < 1e-6, said.out);
  }
  BOOST_TEST(program.run(floating).out.find("momentum") == std::string::npos);
}
