// SPDX-License-Identifier: GPL-3.0-or-later
// Work against precision: what fails says so, and whole turns of a pendulum are kept.
#include "crosscheck/motion/work_precision.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <boost/test/unit_test.hpp>

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

/// Two masses that know nothing of each other, 1000 and 1 rad/s.
scene::Scene uncoupled() {
  std::string text =
      "title = \"Masses on springs\"\nsource = \"chosen here\"\n[[link]]\nname = \"base\"\n";
  for (const std::string stiffness : {"1000000", "1"})
    text += "[[link]]\nname = \"m" + stiffness +
            "\"\nparent = \"base\"\nmass = 1\n[link.joint]\nname = \"j" + stiffness +
            "\"\nkind = \"prismatic\"\naxis = [1, 0, 0]\nstiffness = " + stiffness + "\n";
  return scene::readSceneToml(text + "[start]\nq = [1, 1]\nqd = [0, 0]\n", "springs.toml");
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_run_whose_first_entry_alone_is_lost_is_not_reached) {
  WorkOptions options;
  options.duration = 3;
  options.methods = {"runge_kutta4", "runge_kutta4"};
  const WorkPrecision work = measureWork(uncoupled(), options);
  BOOST_TEST_REQUIRE(work.lines.size() == 1u);
  bool fails = false, arrives = false;
  for (const WorkPoint& point : work.lines[0].points) {
    BOOST_TEST_CONTEXT("h = " << point.step << " s: " << point.failure) {
      (point.failure.empty() ? arrives : fails) = true;
      BOOST_TEST(std::isfinite(point.energy_error) == point.failure.empty());
      BOOST_TEST((point.failure.empty() ? point.error < HUGE_VAL : point.error != 0));
      BOOST_TEST(point.calls > 0);
    }
  }
  BOOST_TEST(fails);
  BOOST_TEST(arrives);
  // two quarters of a period in which kinetic energy is all that the stiff spring had
  BOOST_TEST(std::abs(work.reference.most_kinetic / (0.5e6 + 0.5) - 1) < 1e-2);
}

/* Two of them for want of a range: of bulirsch_stoer8 extrapolation leaves more rounding than
   others have, which grows with the number of steps (order -1), and runge_kutta4 comes as near as
   3.86. */
BOOST_AUTO_TEST_CASE(an_observed_order_is_that_of_theory_or_is_said_not_to_be_seen) {
  WorkOptions options;
  options.duration = 2;
  options.longest_run = 0.1;
  const std::vector<std::string> seen = {"implicit_midpoint", "stormer_verlet", "gauss_6",
                                         "radau_iia_5"};
  options.methods = seen;
  options.methods.insert(options.methods.end(), {"bulirsch_stoer8", "runge_kutta4"});
  for (const WorkLine& line : measureWork(scene::findScene("double_pendulum"), options).lines) {
    const bool is_seen = std::find(seen.begin(), seen.end(), line.method) != seen.end();
    BOOST_TEST(line.no_order.empty() == is_seen, line.method << ": " << line.no_order);
    BOOST_TEST((line.observed_order != 0) == is_seen, line.method << ": " << line.observed_order);
    if (is_seen)
      BOOST_TEST(std::abs(line.observed_order - line.order) <= 0.1,
                 line.method << ": " << line.observed_order);
  }
}

BOOST_AUTO_TEST_CASE(an_elliptic_pendulum_keeps_its_whole_turns) {
  scene::Scene scene = scene::findScene("simple_pendulum");
  for (const int start : {-10, -4, -2, 2, 4, 10}) {
    scene.start_q[0] = scene::Number(start);
    scene.start_qd[0] = scene::Number(0);
    const ReferenceMotion reference = referenceMotion(scene, 2);
    BOOST_TEST_CONTEXT("from " << start << " rad") {
      BOOST_TEST_REQUIRE(reference.elliptic_error.has_value());
      BOOST_TEST(*reference.elliptic_error < 1e-13);
    }
  }
}
