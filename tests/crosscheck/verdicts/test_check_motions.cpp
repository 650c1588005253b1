// SPDX-License-Identifier: GPL-3.0-or-later
// Published motions in the report: where nobody prints figures, ours are found again here by
// equations that were derived by hand and by two methods; and a wrong motion is red.
#include "crosscheck/verdicts/check_motions.hpp"

#include <cmath>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "tests/fixtures/motions_by_hand.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Long;

namespace {

MotionTable onlyTable(const char* name) {
  const std::vector<MotionTable> tables = reportedMotionTables(scene::findScene(name));
  BOOST_REQUIRE(tables.size() == 1u);
  return tables[0];
}

}  // namespace

// by equations in (a, b); the two methods leave 1e-15 between them, the table is rounded to 1e-14
BOOST_AUTO_TEST_CASE(figures_of_a04_follow_from_equations_by_hand) {
  const fixtures::BricardByHand motion;
  auto one = motion.start(), other = one;
  Long before = 0;
  for (const MotionTable::Row& row : onlyTable("bricard").rows) {
    one = fixtures::byFehlberg(motion, one, before, row.time, 500);
    other = fixtures::byExtrapolation(motion, other, before, row.time, 1e-16L);
    before = row.time;
    BOOST_TEST(motion.gap(one) < 1e-15L);
    for (int k = 0; k < 3; ++k) {
      BOOST_TEST(std::abs(motion.output(one)[k] - motion.output(other)[k]) < 1e-14L);
      BOOST_TEST(std::abs(motion.output(one)[k] - row.values[k]) < 1e-13L);
    }
  }
}

// by equations in s and alpha; the two methods leave 1e-13 between them in the turn
BOOST_AUTO_TEST_CASE(figures_of_a05_follow_from_equations_by_hand) {
  const fixtures::GovernorByHand motion;
  BOOST_TEST(std::abs(motion.momentum() - 53.86899865841843L) < 1e-13L);  // printed
  auto one = motion.start(), other = one;
  Long before = 0;
  for (const MotionTable::Row& row : onlyTable("flyball_governor").rows) {
    one = fixtures::byFehlberg(motion, one, before, row.time, 40000);
    other = fixtures::byExtrapolation(motion, other, before, row.time, 1e-14L);
    before = row.time;
    const int columns[] = {4, 0, 1, 1};
    for (int k = 0; k < 4; ++k) {
      BOOST_TEST(std::abs(one[columns[k]] - other[columns[k]]) < 1e-12L);
      BOOST_TEST(std::abs(one[columns[k]] - row.values[k]) < 1e-12L);
    }
  }
}

BOOST_DATA_TEST_CASE(every_published_motion_is_reached_and_a_wrong_one_is_red,
                     data::make({"pendulum_on_slides", "four_bars_2", "andrews_squeezer", "bricard",
                                 "flyball_governor", "car_axis", "heavy_top", "cart_pole"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const std::vector<MotionTable> tables = reportedMotionTables(scene);
  BOOST_TEST_REQUIRE(!tables.empty());
  for (MotionTable table : tables) {
    const PublishedMotion motion = reenacted(table, scene);
    BOOST_TEST_CONTEXT(table.title) {
      BOOST_TEST(motion.values == static_cast<int>(table.rows.size() * table.columns.size()));
      BOOST_TEST(motion.entries.size() == table.columns.size());
      BOOST_TEST((checkMotion(motion).verdict == Verdict::kAgree), checkMotion(motion).reason);
    }
    // rates that are off by 1e-3 at the start, which projection does not take away again
    for (scene::Number& rate : table.scene.start_qd)
      rate = scene::Number::parse("(" + rate.text() + ") + 1/1000");
    const CheckResult wrong = checkMotion(reenacted(table, scene));
    BOOST_TEST((wrong.verdict == Verdict::kDisagree), table.title);
    BOOST_TEST(wrong.reason.find("simulated") != std::string::npos, wrong.reason);
  }
}

BOOST_AUTO_TEST_CASE(a_motion_that_cannot_be_simulated_disagrees) {
  MotionTable table = onlyTable("pendulum_on_slides");
  table.scene.mechanism.closures[0].length = scene::Number(9);
  const CheckResult check = checkMotion(reenacted(table, table.scene));
  BOOST_TEST((check.verdict == Verdict::kDisagree));
  BOOST_TEST(!check.reason.empty());
}
