// SPDX-License-Identifier: GPL-3.0-or-later
// Advice: a pendulum's end is known by elliptic functions, and a scene whose last link weighs
// almost nothing has a smaller model.
#include "crosscheck/reduction/advice.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <boost/test/unit_test.hpp>

#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/work_precision.hpp"
#include "crosscheck/reduction/code_motion.hpp"
#include "scene/envelope.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const auto kSilent = [](const std::string&) {};

const char* const kPendulum = R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "rod"
parent = "base"
mass = 2
com = [0, 0, -0.5]
inertia = { about = "com", xx = "1/6", yy = "1/6" }
[link.joint]
kind = "revolute"
axis = [0, 1, 0]
[start]
q = [1]
)";

/// Two rods and a crumb at the end, which forces of 1 % do not notice.
const char* const kCrumb = R"(
gravity = [0, 0, -9.81]
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 2
com = [0, 0, -0.25]
inertia = { about = "com", xx = 0.05, yy = 0.05, zz = 0.001, xz = 1e-9 }
[link.joint]
name = "shoulder"
kind = "revolute"
axis = [0, 1, 0]
[[link]]
name = "lower"
parent = "upper"
mass = 1
com = [0.000001, 0, -0.25]
inertia = { about = "com", xx = 0.02, yy = 0.02, zz = 0.001 }
[link.joint]
name = "elbow"
kind = "revolute"
axis = [0, 1, 0]
xyz = [0, 0, -0.5]
[start]
q = [0.5, 0.3]
[envelope]
shoulder = { q = [-2, 2], qd = [-20, 20], qdd = [-200, 200] }
elbow = { q = [-3, 3], qd = [-30, 30], qdd = [-300, 300] }
)";

/// How far the end by the C code is from the elliptic functions.
double error(const scene::Scene& scene, const std::string& method, AdvisedScalar scalar, long steps,
             double duration) {
  const AccelerationCode code(scene);
  CodeMotion motion(
      scene, code,
      scalar == AdvisedScalar::kFloat ? kernel::CodeScalar::kFloat : kernel::CodeScalar::kDouble);
  std::vector<double> y = startOf<double>(scene);
  const auto stepper = stepsOf<double>(method, motion);
  const double h = duration / static_cast<double>(steps);
  for (long k = 0; k < steps; ++k) stepper->step(&y, static_cast<double>(k) * h, h);
  const auto known = ellipticPendulum(scene, duration);
  BOOST_REQUIRE(known.has_value());
  return static_cast<double>(std::max(std::abs(y[0] - (*known)[0]), std::abs(y[1] - (*known)[1])));
}

}  // namespace

BOOST_AUTO_TEST_CASE(what_is_advised_keeps_the_error_of_a_pendulum_and_a_longer_step_does_not) {
  const scene::Scene scene = scene::readSceneToml(kPendulum, "pendulum");
  AdviceOptions options;
  options.error = 1e-4;
  options.duration = 3;
  options.methods = {"euler", "runge_kutta4", "adams_bashforth_moulton4"};
  const Advice advice = adviceFor(scene, {}, options, kSilent);
  BOOST_TEST((advice.no_reduction.find("no [envelope]") != std::string::npos));
  BOOST_TEST(advice.models.size() == 1U);
  BOOST_REQUIRE(advice.chosen.has_value());
  int kept = 0;
  for (std::size_t k = 0; k < advice.candidates.size(); ++k) {
    const AdvisedCandidate& c = advice.candidates[k];
    BOOST_TEST_CONTEXT(c.method << " in " << name(c.scalar) << ", " << c.steps << " steps") {
      if (k < *advice.chosen) BOOST_TEST(!c.why_not.empty());
      if (!c.why_not.empty()) continue;
      ++kept;
      const double there = error(scene, c.method, c.scalar, c.steps, options.duration);
      BOOST_TEST(there <= options.error);
      // known_to: what the reference itself is off by
      BOOST_TEST(there <= c.error() + 2 * advice.known_to);
      BOOST_TEST(c.operations == c.calls * advice.models[0].operations);
      // steps of an order p half as long as can be have 2^p times less
      if (c.method == "runge_kutta4")
        BOOST_TEST(error(scene, c.method, c.scalar, c.steps / 2, options.duration) > options.error);
    }
  }
  BOOST_TEST(kept >= 2);
  BOOST_TEST((advice.candidates[*advice.chosen].scalar == AdvisedScalar::kFloat));
}

// qdd in float keeps seven digits and no more.
BOOST_AUTO_TEST_CASE(float_is_not_advised_beyond_its_digits) {
  const scene::Scene scene = scene::readSceneToml(kPendulum, "pendulum");
  AdviceOptions options;
  options.error = 1e-9;
  options.duration = 1;
  options.methods = {"runge_kutta_fehlberg78"};
  options.draws = true;
  const Advice advice = adviceFor(scene, {}, options, kSilent);
  BOOST_REQUIRE(advice.chosen.has_value());
  BOOST_TEST((advice.candidates[*advice.chosen].scalar == AdvisedScalar::kDouble));
  const auto in_float =
      std::find_if(advice.candidates.begin(), advice.candidates.end(),
                   [](const auto& c) { return c.scalar == AdvisedScalar::kFloat; });
  BOOST_REQUIRE((in_float != advice.candidates.end()));
  BOOST_TEST((in_float->why_not.find("roundings") != std::string::npos), in_float->why_not);
  BOOST_TEST(advice.curves.size() == 2U);
  for (const AdvisedCurve& curve : advice.curves) BOOST_TEST(curve.points.size() >= 5U);
}

// Of several motions lanes cost a share, and err as double does: the kernel's cosines are others.
BOOST_AUTO_TEST_CASE(lanes_are_advised_to_several_motions_and_not_to_one) {
  const scene::Scene scene = scene::readSceneToml(kPendulum, "pendulum");
  AdviceOptions options;
  options.error = 1e-9;  // beyond float
  options.duration = 1;
  options.methods = {"runge_kutta_fehlberg78"};
  options.draws = true;
  for (const long motions : {1L, 3L, 1000L}) {
    options.motions = motions;
    const Advice advice = adviceFor(scene, {}, options, kSilent);
    const auto of = [&](AdvisedScalar scalar) {
      return std::find_if(advice.candidates.begin(), advice.candidates.end(),
                          [&](const auto& c) { return c.scalar == scalar; });
    };
    const auto lanes = of(AdvisedScalar::kLanes), plain = of(AdvisedScalar::kDouble);
    BOOST_TEST((lanes != advice.candidates.end()) == (motions > 1));
    if (motions == 1) continue;
    BOOST_TEST(advice.lanes >= 2);
    BOOST_TEST(advice.curves.size() == 3U);
    BOOST_TEST(lanes->why_not.empty(), lanes->why_not);
    BOOST_TEST(lanes->steps == plain->steps);
    BOOST_TEST(lanes->step_error == plain->step_error);
    // of 3 motions in 4 lanes one call is enough, in 2 two; of 1000 one in `lanes`
    const double share = static_cast<double>((motions + advice.lanes - 1) / advice.lanes) /
                         static_cast<double>(motions);
    const int operations = advice.models[0].lane_operations;
    BOOST_TEST(operations > 0);
    BOOST_TEST(std::abs(lanes->operations - lanes->calls * operations * share) <=
               1e-9 * lanes->operations);
    BOOST_REQUIRE(advice.chosen.has_value());
    BOOST_TEST((advice.candidates[*advice.chosen].scalar == AdvisedScalar::kLanes));
  }
}

BOOST_AUTO_TEST_CASE(a_smaller_model_is_advised_where_it_does_and_named_why_not_where_it_does_not) {
  const scene::Scene scene = scene::readSceneToml(kCrumb, "crumb");
  const auto ranges = scene::envelopeOf(kCrumb, scene);
  AdviceOptions options;
  options.duration = 0.5;
  options.methods = {"runge_kutta4"};
  for (const double asked : {1e-2, 1e-11}) {
    options.error = asked;
    const Advice advice = adviceFor(scene, ranges, options, kSilent);
    BOOST_TEST_CONTEXT("error " << asked << ", " << advice.no_reduction) {
      BOOST_REQUIRE(advice.models.size() > 1U);
      BOOST_REQUIRE(advice.chosen.has_value());
      const AdvisedCandidate& c = advice.candidates[*advice.chosen];
      BOOST_TEST(c.error() <= asked);
      BOOST_TEST((c.model > 0) == (asked > 1e-6));
      for (std::size_t m = 1; m < advice.models.size(); ++m) {
        BOOST_TEST(advice.models[m].force_error <= advice.models[m].allowed);
        if (advice.models[m].end_error >= asked) BOOST_TEST(!advice.models[m].why_not.empty());
      }
    }
  }
}
