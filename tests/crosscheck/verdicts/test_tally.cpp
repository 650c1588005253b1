// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/tally.hpp"

#include <limits>

#include <boost/test/unit_test.hpp>

using namespace dynwitness::crosscheck;
using Eigen::MatrixXd;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kEps = std::numeric_limits<double>::epsilon();

Tally tallyOf(const char* quantity) {
  CheckResult description;
  description.kind = CheckKind::kSame;
  description.quantity = quantity;
  return Tally(description);
}

MatrixXd column(double a, double b) {
  return (MatrixXd(2, 1) << a, b).finished();
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(a_residual_within_its_limit_agrees) {
  Tally tally = tallyOf("tau");
  tally.add(0, column(8, 1), column(8 + 4 * kEps * 8, 1), column(5 * kEps * 8, 0));
  const CheckResult result = tally.result();
  BOOST_TEST((result.verdict == Verdict::kAgree));
  BOOST_TEST(result.states == 1);
  BOOST_TEST(result.reason == "");
  // by hand: |left - right| / (eps * 8) = 4, limit 5 in the same unit (scale: largest entry, a bit
  // over 8)
  BOOST_TEST(result.worst == 4, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(result.limit == 5, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(result.ratio == 0.8, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(result.worst_entry == "tau[1]");
}

BOOST_AUTO_TEST_CASE(a_residual_at_its_limit_agrees_and_just_above_does_not) {
  Tally at = tallyOf("tau"), above = tallyOf("tau");
  at.add(0, column(1, 3), column(1, 3.5), column(0, 0.5));
  BOOST_TEST((at.result().verdict == Verdict::kAgree));
  BOOST_TEST(at.result().ratio == 1);
  above.add(0, column(1, 3), column(1, 3.5), column(0, std::nextafter(0.5, 0)));
  BOOST_TEST((above.result().verdict == Verdict::kDisagree));
}

BOOST_AUTO_TEST_CASE(a_difference_names_entry_state_and_limit) {
  Tally tally = tallyOf("M");
  const MatrixXd one = MatrixXd::Identity(3, 3);
  MatrixXd other = one;
  other(0, 1) += 2 * kEps;
  MatrixXd limit = MatrixXd::Constant(3, 3, kEps);
  tally.add(7, one, one, limit);
  tally.add(8, one, other, limit);
  tally.add(9, one, one, limit);
  const CheckResult result = tally.result();
  BOOST_TEST((result.verdict == Verdict::kDisagree));
  BOOST_TEST(result.worst_entry == "M[1,2]");
  BOOST_TEST(result.worst_state == 8);
  BOOST_TEST(result.states == 3);
  BOOST_TEST(result.ratio == 2);
  BOOST_TEST((result.reason.find("M[1,2]") != std::string::npos), result.reason);
  BOOST_TEST((result.reason.find("state 8") != std::string::npos), result.reason);
}

// A large entry does not lend its room to a small one: limits hold entry by entry.
BOOST_AUTO_TEST_CASE(a_small_entry_is_not_hidden_by_a_large_one) {
  Tally tally = tallyOf("tau");
  tally.add(0, column(1e9, 1e-9), column(1e9 + 1e-6, 2e-9), column(1e-3, 1e-12));
  const CheckResult result = tally.result();
  BOOST_TEST((result.verdict == Verdict::kDisagree));
  BOOST_TEST(result.worst_entry == "tau[2]");
}

// Of what is zero within rounding an ulp says nothing: residual and limit are in the quantity's own
// unit. By hand: 2^-60 of a limit of 2^-50, where the answers are 2^-60 and 0.
BOOST_AUTO_TEST_CASE(what_is_zero_within_rounding_has_a_unit) {
  Tally zero = tallyOf("tau"), small = tallyOf("tau");
  zero.add(0, column(0x1p-60, 0), column(0, 0), column(0x1p-50, 0x1p-50));
  BOOST_TEST((zero.result().unit == Unit::kAbsolute));
  BOOST_TEST(zero.result().worst == 0x1p-60);
  BOOST_TEST(zero.result().limit == 0x1p-50);
  BOOST_TEST(zero.result().unitName() == "N m or N (zero within rounding)");
  small.add(0, column(0x1p-60, 0x1p-49), column(0, 0x1p-49), column(0x1p-50, 0x1p-50));
  BOOST_TEST(small.result().unitName() == "ulp");
  Tally edge = tallyOf("tau");  // rounding alone may just make the largest entry
  edge.add(0, column(0x1p-60, 0x1p-50), column(0, 0x1p-50), column(0x1p-50, 0x1p-50));
  BOOST_TEST((edge.result().unit == Unit::kAbsolute));
  BOOST_TEST(small.result().worst == 0x1p+41);  // 2^-60 / (2^-52 2^-49)
}

// what is 0 in balls of 2048 bits: an ulp of it is 0 in double, and no unit
BOOST_AUTO_TEST_CASE(what_is_smaller_than_any_double_has_a_unit) {
  Tally tiny = tallyOf("tau");
  const double least = std::numeric_limits<double>::denorm_min();
  tiny.addDifference(0, column(0, 0), column(least, least), least);
  BOOST_TEST((tiny.result().unit == Unit::kAbsolute));
  BOOST_TEST(tiny.result().worst == 0);
  BOOST_TEST(tiny.result().limit == least);
}

BOOST_AUTO_TEST_CASE(a_zero_limit_asks_for_equality) {
  Tally equal = tallyOf("g"), different = tallyOf("g");
  equal.add(0, column(0, 0), column(0, 0), column(0, 0));
  BOOST_TEST((equal.result().verdict == Verdict::kAgree));
  different.add(0, column(0, 1e-300), column(0, 0), column(0, 0));
  BOOST_TEST((different.result().verdict == Verdict::kDisagree));
}

BOOST_AUTO_TEST_CASE(entries_are_named_by_the_shape) {
  BOOST_TEST(entryName("M", 0, 1, MatrixXd(2, 2)) == "M[1,2]");
  BOOST_TEST(entryName("tau", 2, 0, MatrixXd(3, 1)) == "tau[3]");
  BOOST_TEST(entryName("kinetic", 0, 0, MatrixXd(1, 1)) == "kinetic");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(what_is_not_a_number_disagrees) {
  for (const auto& [left, right] : {std::pair{kNaN, 1.0},
                                    {1.0, kNaN},
                                    {kNaN, kNaN},
                                    {kInfinity, 1.0},
                                    {kInfinity, kInfinity}}) {
    Tally tally = tallyOf("tau");
    tally.add(0, column(1, left), column(1, right), column(1, 1));
    BOOST_TEST((tally.result().verdict == Verdict::kDisagree), left << " and " << right);
    BOOST_TEST(tally.result().worst_entry == "tau[2]");
  }
}

// The same where the number that is none comes after one that is fine, or the limit is none.
BOOST_AUTO_TEST_CASE(what_is_not_a_number_is_not_forgotten) {
  Tally tally = tallyOf("tau");
  tally.add(0, column(1, 2), column(1, 2), column(1, 1));
  tally.add(1, column(1, kNaN), column(1, 2), column(1, 1));
  tally.add(2, column(1, 2), column(1, 2), column(1, 1));
  BOOST_TEST((tally.result().verdict == Verdict::kDisagree));
  BOOST_TEST(tally.result().worst_state == 1);
}

BOOST_AUTO_TEST_CASE(without_a_proven_limit_the_check_is_not_answerable) {
  for (const double limit : {kInfinity, kNaN}) {
    Tally tally = tallyOf("qdd");
    tally.add(3, column(1, 2), column(1, 2.5), column(0, limit));
    const CheckResult result = tally.result();
    BOOST_TEST((result.verdict == Verdict::kNotAnswerable));
    BOOST_TEST((result.reason.find("qdd[2]") != std::string::npos), result.reason);
    BOOST_TEST((result.reason.find("state 3") != std::string::npos), result.reason);
  }
}

BOOST_AUTO_TEST_CASE(a_disagreement_outweighs_a_state_without_limit) {
  Tally tally = tallyOf("qdd");
  tally.add(0, column(1, 2), column(1, 2.5), column(0, kInfinity));
  tally.add(1, column(1, 2), column(1, 2.5), column(0, 0.1));
  BOOST_TEST((tally.result().verdict == Verdict::kDisagree));
}

BOOST_AUTO_TEST_CASE(different_shapes_disagree) {
  Tally tally = tallyOf("tau");
  tally.add(0, column(1, 2), MatrixXd::Ones(3, 1), column(1, 1));
  tally.add(1, column(1, 2), column(1, 2), column(1, 1));  // a good state does not wash it away
  const CheckResult result = tally.result();
  BOOST_TEST((result.verdict == Verdict::kDisagree));
  BOOST_TEST((result.reason.find("shapes differ: 2 x 1 and 3 x 1") != std::string::npos),
             result.reason);
}

BOOST_AUTO_TEST_CASE(a_witness_that_fails_at_one_state_voids_that_state_alone) {
  Tally tally = tallyOf("tau");
  tally.add(0, column(1, 2), column(1, 2), column(1, 1));
  tally.fail(1, "simbody: no convergence");
  const CheckResult result = tally.result();
  BOOST_TEST((result.verdict == Verdict::kAgree));
  BOOST_TEST(result.states == 2);
  BOOST_TEST(result.voided == 1);
  BOOST_TEST(result.judged() == 1);
  BOOST_TEST(result.excused == 0);
  BOOST_TEST(result.first_voided == 1);
  BOOST_TEST((result.voided_reason.find("simbody: no convergence") != std::string::npos),
             result.voided_reason);
  tally.add(2, column(1, 2), column(1, 3), column(0, 0));
  BOOST_TEST((tally.result().verdict == Verdict::kDisagree));
}

BOOST_AUTO_TEST_CASE(a_state_without_limit_voids_that_state_alone) {
  Tally tally = tallyOf("qdd");
  tally.add(0, column(1, 2), column(1, 2.5), column(0, kInfinity));
  tally.add(1, column(1, 2), column(1, 2), column(1, 1));
  const CheckResult result = tally.result();
  BOOST_TEST((result.verdict == Verdict::kAgree));
  BOOST_TEST(result.voided == 1);
  BOOST_TEST((result.voided_reason.find("qdd[2] at state 0") != std::string::npos),
             result.voided_reason);
}

// An entry without a limit does not excuse the others of its state.
BOOST_AUTO_TEST_CASE(a_disagreement_in_a_voided_state_is_one) {
  Tally tally = tallyOf("qdd");
  tally.add(0, column(1, 2), column(1.5, 2.5), column(0.1, kInfinity));
  BOOST_TEST((tally.result().verdict == Verdict::kDisagree));
  BOOST_TEST(tally.result().worst_entry == "qdd[1]");
}

BOOST_AUTO_TEST_CASE(where_there_is_nothing_to_compare_the_state_is_excused) {
  Tally tally = tallyOf("qdd");
  tally.add(0, column(1, 2), column(1, 2.5), column(0, kInfinity), "M is singular");
  tally.fail(1, "simbody: infinite", "M is singular");
  tally.add(2, column(1, 2), column(1, 2), column(1, 1),
            "M is singular");  // it has a limit all the same
  const CheckResult result = tally.result();
  BOOST_TEST((result.verdict == Verdict::kAgree));
  BOOST_TEST(result.voided == 2);
  BOOST_TEST(result.excused == 2);
  BOOST_TEST(result.voided_reason == "M is singular");
}

BOOST_AUTO_TEST_CASE(a_check_that_was_asked_at_no_state_does_not_agree) {
  BOOST_TEST((tallyOf("tau").result().verdict == Verdict::kNotAnswerable));
}

BOOST_AUTO_TEST_SUITE_END()
