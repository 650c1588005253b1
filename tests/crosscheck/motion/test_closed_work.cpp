// SPDX-License-Identifier: GPL-3.0-or-later
// Work against precision where loops are closed: orders are those of theory, what fails says so,
// and the reference is held to what others have published.
#include "crosscheck/motion/closed_work.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <boost/test/unit_test.hpp>

#include "crosscheck/report/work_drawing.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

const WorkLine& lineOf(const WorkPrecision& work, const std::string& label) {
  for (const WorkLine& line : work.lines)
    if (line.method == label) return line;
  BOOST_REQUIRE_MESSAGE(false, "no " << label);
  return work.lines.front();
}

}  // namespace

/* The published angles are good to 1e-10 (data/reference/motion/andrews_squeezer.json), ours differ
   from them by no more. Orders seen on a machine with time: runge_kutta4 4.02 (Baumgarte),
   radau_iia_5 4.99 (index 1), 5.00 (index 2), 4.99 (ggl), of 5; a slow one sees fewer of them. */
BOOST_AUTO_TEST_CASE(orders_of_the_squeezer_are_those_of_theory) {
  WorkOptions options;
  options.duration = 0.03;
  options.methods = {"radau_iia_5", "runge_kutta4"};
  const WorkPrecision work = measureClosedWork(scene::findScene("andrews_squeezer"), options);
  BOOST_TEST(work.reference.published.find("published") == 0, work.reference.published);
  BOOST_TEST(work.lines.size() == 7u);
  int seen = 0;
  double best = HUGE_VAL, worst = 0;
  for (const WorkLine& line : work.lines) {
    BOOST_TEST(line.left_out == "");
    BOOST_TEST((line.observed_order == 0) == !line.no_order.empty(), line.method);
    if (line.observed_order != 0) {
      ++seen;
      const double more = line.observed_order - line.order;
      BOOST_TEST((line.method == "radau_iia_5 index3" ? more >= -0.1 : std::abs(more) <= 0.1),
                 line.method << ": " << line.observed_order);
    }
    for (const WorkPoint& point : line.points) {
      if (!point.failure.empty()) continue;
      best = std::min(best, point.error);
      worst = std::max(worst, point.error);
    }
  }
  BOOST_TEST(seen >= 2);
  BOOST_TEST(worst / best > 1e6);
  const std::string csv = workCsv(work);
  BOOST_TEST(csv.find("\nradau_iia_5 index3,3,") != std::string::npos, csv);
}

// Its springs are stiff rods: explicit steps that are too long for them end nowhere, at a price.
BOOST_AUTO_TEST_CASE(runs_of_the_governor_that_fail_say_why_and_what_they_cost) {
  WorkOptions options;
  options.duration = 1;
  options.methods = {"runge_kutta4", "radau_iia_3"};
  options.longest_run = 0.05;
  const WorkPrecision work = measureClosedWork(scene::findScene("flyball_governor"), options);
  BOOST_TEST(work.reference.published.find("by hand") != std::string::npos,
             work.reference.published);
  const WorkLine& line = lineOf(work, "runge_kutta4 projection");
  const WorkPoint& longest = line.points.front();
  BOOST_TEST(longest.failure != "");
  BOOST_TEST(longest.calls > 0);
  BOOST_TEST(std::isfinite(longest.seconds));
  BOOST_TEST(line.points.back().failure == "");
  // without closures there is nothing to keep: one form is all forms
  BOOST_TEST(lineOf(work, "runge_kutta4 index1").left_out != "");
  BOOST_TEST(lineOf(work, "radau_iia_3 index2").left_out != "");
}

BOOST_AUTO_TEST_CASE(methods_that_know_no_closed_loops_are_refused) {
  WorkOptions options;
  options.methods = {"stormer_verlet"};
  BOOST_CHECK_THROW(measureClosedWork(scene::findScene("andrews_squeezer"), options),
                    scene::InputError);
}
