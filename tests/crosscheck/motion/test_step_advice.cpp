// SPDX-License-Identifier: GPL-3.0-or-later
// What is advised before a run is what bisection finds by running. DYNWITNESS_LONG=1 in the
// environment: all scenes.
#include "crosscheck/motion/step_advice.hpp"

#include <cmath>
#include <cstdlib>
#include <ostream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/tree_motion.hpp"
#include "crosscheck/motion/work_precision.hpp"
#include "tests/fixtures/integrators.hpp"
#include "tests/fixtures/program.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

constexpr double kWithin = 1.5;

/// A mass on a spring of 1 N/m that hangs, one on each of a row: frequencies 1, 10, 100 rad/s.
scene::Scene springs(const std::string& damping = "0") {
  std::string text =
      "title = \"Masses on springs\"\nsource = \"chosen here\"\n[[link]]\nname = \"base\"\n";
  for (const char* stiffness : {"1", "100", "10000"})
    text += std::string("[[link]]\nname = \"m") + stiffness +
            "\"\nparent = \"base\"\nmass = 1\n[link.joint]\nname = \"j" + stiffness +
            "\"\nkind = \"prismatic\"\naxis = [1, 0, 0]\nstiffness = " + stiffness +
            (damping == "0" ? "" : "\nfriction = { viscous = " + damping + " }") + "\n";
  return scene::readSceneToml(text + "[start]\nq = [1, 1, 1]\nqd = [0, 0, 0]\n", "springs.toml");
}

scene::Scene sceneOf(const std::string& name) {
  return name == "springs" ? springs() : scene::findScene(name);
}

/// Largest step up to which no run loses as much energy as the motion has.
double bisected(const scene::Scene& scene, const std::string& method, double duration,
                double guess) {
  const auto holds = [&](double h) { return energyLost(scene, method, duration, h) < 1; };
  double held = 0, broken = 0;
  for (double h = guess / 8; h < 16 * guess && h <= duration; h *= 1.05) {
    if (!holds(h)) {
      broken = h;
      break;
    }
    held = h;
  }
  if (held == 0 || broken == 0) return held;
  for (int k = 0; k < 6; ++k) {
    const double middle = (held + broken) / 2;
    (holds(middle) ? held : broken) = middle;
  }
  return held;
}

struct Asked {
  const char *scene, *method;
  double duration;
};
std::ostream& operator<<(std::ostream& out, const Asked& asked) {
  return out << asked.scene << ", " << asked.method << ", " << asked.duration << " s";
}

// Linear stability is what breaks these. Semi-implicit Euler's energy swings by as much as the
// motion has before that, and Runge-Kutta 4 loses the elastic pendulum's at 0.55 of the advice.
const Asked kStable[] = {
    {"springs", "runge_kutta4", 10},
    {"springs", "stormer_verlet", 10},
    {"springs", "euler", 0.2},
    {"springs", "runge_kutta_fehlberg78", 10},
    {"elastic_pendulum", "stormer_verlet", 10},
};

}  // namespace

BOOST_DATA_TEST_CASE(limits_follow_from_the_direction, data::make(integrators()), method) {
  const bool remembers = method.remembers;
  const auto requireNear = [&](double limit, double expected) {
    if (std::isinf(expected))
      BOOST_TEST(std::isinf(limit), method.name << ": " << limit);
    else if (expected == 0)  // it grows with a power of h that rounding hides where h is small
      BOOST_TEST(limit < 0.1, method.name << ": " << limit);
    else
      BOOST_TEST(std::abs(limit / expected - 1) < (remembers ? 0.05 : 1e-3),
                 method.name << ": " << limit);
  };
  requireNear(stabilityLimit(method.name, {-3, 0}), method.real_limit);
  requireNear(stabilityLimit(method.name, {0, 3}), method.imaginary_limit);
}

BOOST_DATA_TEST_CASE(the_largest_stable_step_is_what_bisection_finds, data::make(kStable), asked) {
  const scene::Scene scene = sceneOf(asked.scene);
  const StableStep advised = largestStableStep(spectrumAlong(scene, asked.duration), asked.method);
  const double found = bisected(scene, asked.method, asked.duration, advised.step);
  BOOST_TEST_MESSAGE(asked << ": advised " << advised.step << " s, found " << found << " s");
  BOOST_TEST(advised.step <= kWithin * found);
  BOOST_TEST(advised.step >= found / kWithin);
}

BOOST_AUTO_TEST_CASE(all_scenes_where_it_is_asked_for) {
  if (std::getenv("DYNWITNESS_LONG") == nullptr) return;
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    if (!refusals(scene, Command::kDrift).empty() || scene.mechanism.dof() > 9) continue;
    for (const char* method : {"runge_kutta4", "stormer_verlet", "runge_kutta_fehlberg78"}) {
      constexpr double kDuration = 5;
      if (integratorNamed(method).needs_momenta &&
          !TreeMotion<double>(scene.mechanism).hasMomenta())
        continue;
      const StableStep advised = largestStableStep(spectrumAlong(scene, kDuration), method);
      if (std::isinf(advised.step)) continue;
      const double found = bisected(scene, method, kDuration, advised.step);
      BOOST_TEST_MESSAGE(scene.name << ", " << method << ": advised " << advised.step << ", found "
                                    << found << ", ratio " << advised.step / found);
    }
  }
}

BOOST_DATA_TEST_CASE(the_step_for_an_accuracy_is_what_bisection_finds,
                     data::make({"simple_pendulum", "elastic_pendulum"}) *
                         data::make({"runge_kutta4", "stormer_verlet", "runge_kutta_dopri5"}),
                     name, method) {
  constexpr double kDuration = 2, kAccuracy = 1e-6;
  const scene::Scene scene = scene::findScene(name);
  const AccurateStep advised = accurateStep(scene, method, kDuration, kAccuracy, kDuration);
  BOOST_TEST_REQUIRE(advised.step > 0, advised.why);
  const std::vector<long double> reference = referenceMotion(scene, kDuration).y;
  TreeMotion<double> motion(scene.mechanism);
  const auto error = [&](long steps) {
    std::vector<double> y = startOf<double>(scene);
    const auto stepper = stepsOf<double>(method, motion);
    try {
      for (long k = 0; k < steps; ++k) stepper->step(&y, 0, kDuration / static_cast<double>(steps));
    } catch (const std::runtime_error&) {  // too long for an implicit method
      return HUGE_VAL;
    }
    double worst = 0;
    for (std::size_t i = 0; i + 1 < y.size(); ++i)
      if (const double d = static_cast<double>(std::abs(y[i] - reference[i])); !(d <= worst))
        worst = d;
    return std::isfinite(worst) ? worst : HUGE_VAL;
  };
  long fewest = 1;  // steps, by doubling and bisection
  while (error(fewest) > kAccuracy) fewest *= 2;
  for (long low = fewest / 2; fewest - low > 1 + fewest / 100;) {
    const long middle = (low + fewest) / 2;
    (error(middle) > kAccuracy ? low : fewest) = middle;
  }
  const double found = kDuration / static_cast<double>(fewest);
  BOOST_TEST_MESSAGE(name << ", " << method << ": advised " << advised.step << ", found " << found);
  BOOST_TEST(advised.step <= kWithin * found);
  BOOST_TEST(advised.step >= found / kWithin);
}

BOOST_AUTO_TEST_CASE(a_run_that_goes_unstable_is_explained) {
  const std::string said = adviceAfterFailure(springs(), "runge_kutta4", 10, 0.04, 3.1);
  for (const char* part :
       {"at t = 3.1 s: runge_kutta4 with h = 0.04 s is unstable here (h |lambda| = 4 ",
        "limit 2.83", "h <= 0.028 s, or implicit_midpoint"})
    BOOST_TEST(said.find(part) != std::string::npos, said);
  const fixtures::Program program;
  const fixtures::Outcome drift =
      program.run("drift elastic_pendulum --step 0.5 --method runge_kutta4");
  BOOST_TEST(drift.out.find("runge_kutta4 with h = 0.5 s is") != std::string::npos, drift.out);
}
