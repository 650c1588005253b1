// SPDX-License-Identifier: GPL-3.0-or-later
// Formulas by hand against the derived ones. What is right here was derived on paper, and what is
// wrong was made wrong by hand: the verdict has to say how.
#include "crosscheck/diagnosis/formulas_report.hpp"
#include "crosscheck/diagnosis/judge_formulas.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"
#include "symbolic/derivation.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

JudgedFormulas judged(const std::string& scene, const std::vector<std::string>& texts) {
  std::vector<StatedFormula> formulas;
  for (const std::string& text : texts) formulas.push_back({text, {"test", 1}});
  return judgeFormulas(scene::findScene(scene), formulas);
}
JudgedFormula one(const std::string& text, const std::string& scene = "double_pendulum") {
  return judged(scene, {text}).formulas[0];
}
std::string gapsOf(const JudgedFormula& f) {
  std::string text;
  for (const FormulaGap& gap : f.gaps)
    text += gap.term + " " + gap.derived.str() + " " + gap.stated.str() + "; ";
  return text;
}

/// Two thin rods, on paper.
const std::vector<std::string> kDoublePendulum = {
    "M11 = (m1/3 + m2)*l1^2 + m2*l2^2/3 + m2*l1*l2*cos(q2)",
    "M12 = m2*l2*(l2/3 + l1*cos(q2)/2)",
    "M_21 = m2*l2^2/3 + m2*l1*l2*cos(q2)/2",
    "M22 = 1/3*m2*l2^2",
    "c1 = -m2*l1*l2*(2*qd1*qd2 + qd2^2)*sin(q2)/2",
    "c2 = m2*l1*l2*qd1^2*sin(q2)/2",
    "g1 = (m1/2 + m2)*g*l1*sin(q1) + m2*g*l2*sin(q1 + q2)/2",
    "g2 = m2*g*l2*(sin(q1)*cos(q2) + cos(q1)*sin(q2))/2",
    "V = -(m1/2 + m2)*g*l1*cos(q1) - m2*g*l2*cos(q2 + q1)/2",
    "T = m1*l1^2*qd1^2/6 + m2*(l1^2*qd1^2 + l2^2*(qd1 + qd2)^2/3 + l1*l2*qd1*(qd1 + qd2)*cos(q2))/2",
    "p2 = m2*l2^2*(qd1 + qd2)/3 + m2*l1*l2*qd1*cos(q2)/2",
    "Gamma112 = -m2*l1*l2*sin(q2)/2",
    "Gamma111 = 0",
    "tau2 = m2*l2^2*(qdd1 + qdd2)/3 + m2*l1*l2*(cos(q2)*qdd1 + sin(q2)*qd1^2)/2 + "
    "m2*g*l2*sin(q1 + q2)/2",
};

}  // namespace

BOOST_AUTO_TEST_SUITE(formulas)

BOOST_AUTO_TEST_CASE(what_was_derived_on_paper_is_right) {
  const JudgedFormulas all = judged("double_pendulum", kDoublePendulum);
  for (const JudgedFormula& f : all.formulas)
    BOOST_TEST((f.relation == FormulaRelation::kEqual), f.text);
  BOOST_TEST(all.isRight());
  BOOST_TEST(all.chance <= 1e-18);
}

/// Each sign and each number of each formula, changed one at a time: none passes as right.
BOOST_DATA_TEST_CASE(nothing_that_is_changed_in_them_passes, data::make(kDoublePendulum), text) {
  std::vector<std::string> changed;
  for (std::size_t at = text.find('=') + 1; at < text.size(); ++at) {
    std::string other = text;
    if (text[at] == '-' || text[at] == '+')
      other[at] = text[at] == '-' ? '+' : '-';
    else if (text[at] == '2' || text[at] == '3')
      other[at] = text[at] == '2' ? '1' : '2';
    else
      continue;
    changed.push_back(other);
  }
  if (changed.empty()) return;
  for (const JudgedFormula& f : judged("double_pendulum", changed).formulas)
    BOOST_TEST(!f.isRight(), f.text << " for " << text);
}

BOOST_AUTO_TEST_CASE(a_term_that_is_missing_extra_or_has_another_coefficient_is_named) {
  BOOST_TEST(gapsOf(one("M12 = m2*l1*l2*cos(q2)/2")) == "m2*l2^2 1/3 0; ");
  BOOST_TEST(gapsOf(one("M22 = m2*l2^2/3 + m1*l1^2/12")) == "m1*l1^2 0 1/12; ");
  BOOST_TEST(gapsOf(one("M11 = (m1/3 + m2)*l1^2 + m2*l2^2/4 + m2*l1*l2*cos(q2)")) ==
             "m2*l2^2 1/3 1/4; ");
  // of the forms that say it the shortest: not cos(q1) sin(q2) and sin(q1) cos(q2)
  BOOST_TEST(gapsOf(one("g1 = (m1/2 + m2)*g*l1*sin(q1) + m2*g*l2*sin(q1 - q2)/2")).size() > 0u);
  BOOST_TEST(gapsOf(one("g1 = (m1/2 + m2)*g*l1*sin(q1)")) == "m2*g*l2*sin(q1 + q2) 1/2 0; ");
}

BOOST_AUTO_TEST_CASE(a_sign_a_factor_or_another_quantity_is_named) {
  BOOST_TEST((one("c2 = -m2*l1*l2*qd1^2*sin(q2)/2").relation == FormulaRelation::kNegative));
  JudgedFormula f = one("c2 = m2*l1*l2*qd1^2*sin(q2)");
  BOOST_TEST((f.relation == FormulaRelation::kMultiple));
  BOOST_TEST(f.factor == "2");
  f = one("c2 = -m2*l1^2*l2*qd1^2*sin(q2)/6");
  BOOST_TEST((f.relation == FormulaRelation::kMultiple));
  BOOST_TEST(f.factor == "-1/3*l1");
  f = one("c2 = m2*l1*l2*qd1^2*sin(q2)/(2*m2^2)");
  BOOST_TEST(f.factor == "1/m2^2");
  f = one("g1 = m2*g*l2*sin(q1 + q2)/2");
  BOOST_TEST((f.relation == FormulaRelation::kAnotherQuantity));
  BOOST_TEST(f.another == "g2");
  BOOST_TEST(one("M11 = -m2*l2^2/3").another == "-M22");
}

BOOST_AUTO_TEST_CASE(zero_is_no_multiple_and_no_other_quantity) {
  BOOST_TEST((one("M22 = 0").relation == FormulaRelation::kDifferent));
  BOOST_TEST((one("Gamma111 = m1*l1").relation == FormulaRelation::kDifferent));
}

BOOST_AUTO_TEST_CASE(the_height_of_zero_is_free_in_V_alone) {
  BOOST_TEST((one("V = (m1/2 + m2)*g*l1*(1 - cos(q1)) - m2*g*l2*cos(q1 + q2)/2").relation ==
              FormulaRelation::kUpToConstant));
  BOOST_TEST(!one("M22 = m2*l2^2/3 + m1").isRight());
  BOOST_TEST(!one("V = -(m1/2 + m2)*g*l1*cos(q1) - m2*g*l2*cos(q1 + q2)/2 + q1").isRight());
}

BOOST_AUTO_TEST_CASE(the_scenes_own_numbers_are_right_and_told_apart) {
  // m2 = 0.8 and l2 = 0.4
  BOOST_TEST((one("M22 = 0.8*0.16/3").relation == FormulaRelation::kForThisScene));
  BOOST_TEST(one("M22 = 0.8*0.16/3").isRight());
  BOOST_TEST(!one("M22 = 0.0426667").isRight());
}

BOOST_AUTO_TEST_CASE(every_closed_form_that_derive_prints_is_right) {
  for (const char* name : {"double_pendulum", "cart_pole", "furuta_pendulum", "planar_3r"}) {
    const scene::Scene scene = scene::findScene(name);
    const symbolic::Derivation d = symbolic::derivation(scene.mechanism);
    std::vector<StatedFormula> formulas;
    for (const symbolic::Step& step : d.steps)
      for (const symbolic::StepEquation& equation : step.equations) {
        const std::string left = print(equation.left, symbolic::Style::kText);
        const std::string letters = left.substr(0, left.find_first_of("0123456789"));
        const bool is_known = letters == "p" || letters == "M" || letters == "c" ||
                              letters == "g" || letters == "Gamma" || left == "T" || left == "V";
        if (is_known && equation.left.kind == symbolic::Formula::Kind::kSymbol &&
            equation.right.kind != symbolic::Formula::Kind::kMatrix)
          formulas.push_back({print(equation, symbolic::Style::kText), {}});
      }
    BOOST_TEST(formulas.size() > 6u);
    for (const JudgedFormula& f : judgeFormulas(scene, formulas).formulas)
      BOOST_TEST((f.relation == FormulaRelation::kEqual), name << ": " << f.text);
  }
}

BOOST_AUTO_TEST_CASE(many_joints_are_decided_and_told_where_terms_are_few) {
  BOOST_TEST(one("M34 = 0", "scara").isRight());
  BOOST_TEST(one("M11 = 1", "puma_560").gaps.size() > 10u);
  const JudgedFormula f = one("T = 0", "franka_panda");
  BOOST_TEST(!f.isRight());
  BOOST_TEST(f.gaps.empty());
  BOOST_TEST(!f.no_gaps.empty());
}

BOOST_AUTO_TEST_CASE(bad_formulas_are_refused_with_place_and_what_is_allowed) {
  const auto refuses = [](const std::string& text, const std::string& part) {
    try {
      one(text);
      BOOST_TEST(false, text << " was read");
    } catch (const scene::InputError& error) {
      const std::string said = error.what();
      BOOST_TEST(said.find("test:1: ") == 0u, said);
      BOOST_TEST(said.find(part) != std::string::npos, said);
    }
  };
  refuses("M12 = m3*l1",
          "column 1: m3: unknown (did you mean m1?), allowed: g, m1, m2, l1, l2, pi");
  refuses("M12 = m2*L1", "L1: unknown (did you mean l1?)");  // m1 is as near but for the case
  refuses("c1 = m2*qd2**2", "\"**\", allowed: ^ for powers");
  refuses("M12 = m2*l1*cos(q3)", "q3");
  refuses("M13 = m2", "allowed before \"=\": T, V, p1..p2, M11..M22");
  refuses("K = m2", "no quantity of this scene");
  refuses("m2*l1", "NAME = EXPRESSION");
  refuses("M12 = m2 = m1", "NAME = EXPRESSION");
  refuses("M12 = m2*l1*cos(q1/2)", "sums of whole multiples");
  refuses("M12 = m2*cos(qd1)", "no angle");
  refuses("M12 = sqrt(m2)", "allowed: cos, sin");
  refuses("M12 = m2*(l1", "never closed");
  refuses("M12 = m2 l1", "column 4");
  refuses("M12 =", "empty");
  refuses("M12 = m2/0", "division by 0");
}

BOOST_AUTO_TEST_CASE(a_division_by_what_is_zero_as_a_formula_is_refused) {
  BOOST_CHECK_THROW(one("M12 = m2/(cos(q1)^2 + sin(q1)^2 - 1)"), scene::InputError);
}

BOOST_AUTO_TEST_CASE(rates_that_are_no_derivatives_are_refused) {
  BOOST_CHECK_THROW(one("T = 0", "heavy_top"), scene::InputError);
}

BOOST_AUTO_TEST_CASE(the_report_says_it_in_words) {
  const std::string text =
      formulasText(judged("double_pendulum", {"M12 = m2*l1*l2*cos(q2)/2", "M22 = m2*l2^2/3"}));
  BOOST_TEST(text.find("M12  wrong      at 1 term\n") != std::string::npos, text);
  BOOST_TEST(text.find("missing      1/3*m2*l2^2\n") != std::string::npos, text);
  BOOST_TEST(text.find("M22  right\n") != std::string::npos, text);
  BOOST_TEST(text.find("\nWRONG\n") != std::string::npos, text);
}

BOOST_AUTO_TEST_SUITE_END()
