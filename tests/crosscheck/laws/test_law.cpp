// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of laws: words and sides in step, laws that a mechanism does not have, and divisions by
// zero.
#include "crosscheck/laws/law.hpp"

#include <string>

#include <boost/test/unit_test.hpp>

#include "crosscheck/verdicts/within_bounds.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

struct Number {
  using Scalar = RunningError;
  double x;
  Kept<double> twice;
  int computed = 0;
};
MatrixX<RunningError> one(double x) {
  return MatrixX<RunningError>::Constant(1, 1, RunningError(x));
}

struct Doubling : Law {
  static constexpr LawWords kWords = {"doubling", "2 x = x + x", "x", "product", "sum"};
  static TwoSides<RunningError> sides(Number& at) {
    return {one(at.twice([&] { return ++at.computed, 2 * at.x; })), one(at.x + at.x)};
  }
};
struct OfTrees : Law {
  static constexpr LawWords kWords = {"of trees", "x = x", "x", "", ""};
  static bool appliesTo(const scene::Mechanism& mechanism) { return mechanism.closures.empty(); }
  static TwoSides<RunningError> sides(Number& at) { return {one(at.x), one(at.x)}; }
};
struct Reciprocal : Law {
  static constexpr LawWords kWords = {"reciprocal", "x (1/x) = 1",        "x", "quotient",
                                      "",           "x has no reciprocal"};
  static TwoSides<RunningError> sides(Number& at) {
    if (at.x == 0) throw std::domain_error("division by zero");
    return {one(at.x * (1 / at.x)), one(1)};
  }
};
struct Halving : Law {
  static constexpr LawWords kWords = {"halving", "2 x / 2 = x + 1", "x", "quotient", ""};
  static TwoSides<RunningError> sides(Number& at) {
    return {one(at.twice([&] { return ++at.computed, 2 * at.x; }) / 2), one(at.x + 1)};
  }
};
using Arithmetic = Laws<Doubling, OfTrees, Reciprocal, Halving>;

scene::Mechanism withClosure() {
  scene::Mechanism mechanism;
  mechanism.closures.emplace_back();
  return mechanism;
}
/// "name: verdict", one a check.
std::string verdicts(const scene::Mechanism& mechanism, double x) {
  std::string text;
  for (const CheckResult& check :
       withinBounds(Arithmetic::words(mechanism), Arithmetic::sides(mechanism, Number{x, {}})))
    text +=
        check.name() + ": " + name(check.verdict) +
        (check.reason.empty() || check.verdict == Verdict::kDisagree ? "" : ", " + check.reason) +
        "; ";
  return text;
}

}  // namespace

BOOST_AUTO_TEST_CASE(each_verdict_is_that_of_its_own_law) {
  BOOST_TEST(verdicts({}, 3) ==
             "doubling: agree; of trees: agree; reciprocal: agree; halving: disagree; ");
}
BOOST_AUTO_TEST_CASE(what_a_mechanism_does_not_have_is_not_asked) {
  BOOST_TEST(verdicts(withClosure(), 3) ==
             "doubling: agree; reciprocal: agree; halving: disagree; ");
}
BOOST_AUTO_TEST_CASE(a_division_by_zero_takes_one_law_and_says_what_it_means) {
  BOOST_TEST(verdicts({}, 0) ==
             "doubling: agree; of trees: agree; reciprocal: not answerable, x has no reciprocal "
             "(state 0: division by zero); halving: disagree; ");
}
BOOST_AUTO_TEST_CASE(what_two_laws_ask_is_computed_once) {
  Number at{3, {}};
  Arithmetic::sides({}, at);
  BOOST_TEST(at.computed == 1);
}
BOOST_AUTO_TEST_CASE(nothing_is_kept_of_a_computation_that_fails) {
  Kept<int> kept;
  const auto fails = []() -> int { throw std::domain_error("no"); };
  BOOST_CHECK_THROW(kept(fails), std::domain_error);
  BOOST_CHECK_THROW(kept(fails), std::domain_error);
  BOOST_TEST(kept([] { return 1; }) == 1);
  BOOST_TEST(kept([] { return 2; }) == 1);
}
