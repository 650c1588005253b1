// SPDX-License-Identifier: GPL-3.0-or-later
// Derivations as somebody asked for them: single lines, parameters put in, other letters; and the
// closed forms that mechanisms of many joints have entry by entry.
#include "symbolic/selection.hpp"

#include <functional>
#include <map>

#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"
#include "scene/substitution.hpp"
#include "symbolic/rate_factors.hpp"
#include "symbolic/read_back.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;

namespace {

std::map<std::string, std::string> linesOf(const Derivation& d) {
  std::map<std::string, std::string> lines;
  for (const Step& step : d.steps)
    for (const StepEquation& e : step.equations)
      lines[print(e.left_value ? e.right : e.left, Style::kText)] =
          print(e.left_value ? e.left : e.right, Style::kText);
  return lines;
}

Derivation derived(const std::string& name, const std::vector<std::string>& put_in = {}) {
  return derivation(scene::substituted(scene::findScene(name).mechanism, put_in));
}

void refuses(const std::function<void()>& call, const std::string& part) {
  BOOST_CHECK_EXCEPTION(call(), scene::InputError, [&](const scene::InputError& error) {
    BOOST_TEST_MESSAGE(error.what());
    return std::string(error.what()).find(part) != std::string::npos;
  });
}

}  // namespace

BOOST_AUTO_TEST_SUITE(selection)

BOOST_AUTO_TEST_CASE(one_line_is_that_line) {
  const Derivation d = derived("double_pendulum");
  const auto M12 = linesOf(only(d, {"M12"}));
  BOOST_TEST(M12.size() == 1u);
  BOOST_TEST(M12.at("M12") == "1/3*m2*l2^2 + 1/2*m2*l1*l2*cos(q2)");
  const auto family = linesOf(only(d, {"c", "tau2"}));
  BOOST_TEST(family.size() == 3u);
  BOOST_TEST(family.count("c1") + family.count("c2") + family.count("tau2") == 3u);
  BOOST_TEST(linesOf(only(d, {"T"})).size() == 1u);  // and not T_upper
  // what is made of lines comes with them, and is read back
  const Derivation puma = derived("puma_560"), line = only(puma, {"c1"});
  BOOST_TEST(line.steps.size() < puma.steps.size());
  const ReadBack read = readBack(line, print(line, Style::kText), Style::kText);
  BOOST_TEST(read.problem == "");
  BOOST_TEST(read.formulas == 1);
  // one that is 0 says so
  const Derivation zero = only(derived("scara"), {"M13"});
  BOOST_TEST(print(zero, Style::kText).find("0: M13\n") != std::string::npos);
  refuses([&] { only(d, {"Gama"}); }, "did you mean Gamma?");
  refuses([&] { only(d, {"M13"}); }, "allowed:");
}

BOOST_AUTO_TEST_CASE(parameters_are_put_in_exactly) {
  const auto lines = linesOf(derived("double_pendulum", {"l1=1/3", "m1=0"}));
  BOOST_TEST(lines.at("M12") == "1/3*m2*l2^2 + 1/6*m2*l2*cos(q2)");
  BOOST_TEST(lines.at("g1") == "1/3*m2*g*sin(q1) + 1/2*m2*g*l2*sin(q1 + q2)");
  BOOST_TEST(linesOf(derived("double_pendulum", {"l2=l1"})).at("M22") == "1/3*m2*l1^2");
  refuses([] { derived("double_pendulum", {"l3=1"}); }, "did you mean l1?");
  refuses([] { derived("double_pendulum", {"l1"}); }, "PARAMETER=VALUE");
  refuses([] { derived("double_pendulum", {"l1=l2", "l2=1"}); }, "substituted itself");
  refuses([] { derived("double_pendulum", {"l1=1/0"}); }, "division by zero");
}

/// What was put in is what those numbers give: with all put in, the printed M is M of that scene.
BOOST_AUTO_TEST_CASE(a_derivation_with_numbers_put_in_is_read_back) {
  for (const char* name : {"double_pendulum", "scara"}) {
    const scene::Mechanism m = scene::findScene(name).mechanism;
    std::vector<std::string> all;
    for (const scene::Parameter& p : m.parameters) all.push_back(p.name + "=3/7");
    const Derivation d = derivation(scene::substituted(m, all));
    BOOST_TEST(d.holds());
    for (const Style style : {Style::kText, Style::kLatex, Style::kMathml})
      BOOST_TEST(readBack(d, print(d, style), style).problem == "");
  }
}

BOOST_AUTO_TEST_CASE(positions_have_the_letters_that_are_asked_for) {
  const Derivation d = renamed(derived("double_pendulum"), {{"q1", "theta"}, {"q2", "phi_2"}});
  const auto lines = linesOf(d);
  BOOST_TEST(lines.at("c1") == "-1/2*m2*l1*l2*phi_2_dot*(2*theta_dot + phi_2_dot)*sin(phi_2)");
  BOOST_TEST(print(d, Style::kLatex).find("\\dot{\\theta}") != std::string::npos);
  BOOST_TEST(print(d, Style::kLatex).find("\\ddot{\\phi}_{2}") != std::string::npos);
  for (const Style style : {Style::kText, Style::kLatex, Style::kMathml}) {
    BOOST_TEST(readBack(d, print(d, style), style).problem == "");
    // a letter too few is noticed
    std::string wrong = print(d, style);
    const std::string name = print(d.input(Input::kPosition, 1), style);
    wrong.replace(wrong.rfind(name), name.size(), print(d.input(Input::kPosition, 0), style));
    BOOST_TEST(readBack(d, wrong, style).problem != "");
  }
  const Derivation one = renamed(derived("double_pendulum"), {{"q2", "x"}});
  BOOST_TEST(linesOf(one).at("g2") == "1/2*m2*g*l2*sin(q1 + x)");
  const auto refusesName = [](const std::string& from, const std::string& to,
                              const std::string& part) {
    refuses([&] { renamed(derived("double_pendulum"), {{from, to}}); }, part);
  };
  refusesName("q3", "x", "did you mean q1?");
  refusesName("q1", "l1", "a parameter");
  refusesName("q1", "l_1", "a parameter");  // the same in LaTeX
  refusesName("q1", "q2", "a position");
  refusesName("q1", "M12", "a result");
  refusesName("q1", "2x", "a letter first");
}

/// By hand: W = links 2, 3 and 4 as they are carried, a1 and a2 the arms; g along -z.
BOOST_AUTO_TEST_CASE(short_entries_of_four_joints_are_closed) {
  const auto scara = linesOf(derived("scara"));
  BOOST_TEST(scara.at("M33") == "m3 + m4");
  BOOST_TEST(scara.at("M44") == "0.0009*m4 + I4");
  BOOST_TEST(scara.at("M24") == "-(0.0009*m4 + I4) - 0.03*m4*a2*cos(q4)");
  BOOST_TEST(scara.at("M14") == "-(0.0009*m4 + I4) - 0.03*m4*a2*cos(q4) - 0.03*m4*a1*cos(q2 - q4)");
  for (const char* name : {"M11", "M12", "M22"})
    BOOST_TEST(scara.at(name).find("cos(q") != std::string::npos, name);
  for (const auto& [name, line] : scara)  // lines of a program belong to T alone
    if (name[0] == 'M' && name.size() > 1) BOOST_TEST(line.find("t1") == std::string::npos, name);
  // T that is long is the sum of what is short
  BOOST_TEST(linesOf(derived("andrews_squeezer")).at("T") ==
             "T_K1 + T_K2 + T_K3 + T_K5 + T_K4 + T_K7 + T_K6");
  BOOST_TEST(linesOf(derived("puma_560")).count("t1") == 1u);  // what is long stays a program
}

BOOST_AUTO_TEST_CASE(quadratic_forms_are_products_where_they_are) {
  const auto product = [](const LinearForm& a, const LinearForm& b) {
    QuadraticForm q;
    for (const auto& [i, r] : a)
      for (const auto& [j, s] : b) q[std::minmax(i, j)] += r * s;
    for (auto it = q.begin(); it != q.end();) it = it->second == 0 ? q.erase(it) : std::next(it);
    return q;
  };
  const std::vector<LinearForm> forms = {{{1, 2}, {2, 1}, {3, 1}}, {{2, 1}, {3, 1}},
                                         {{1, 1}, {2, -1}},        {{1, 1}, {2, 1}},
                                         {{3, Rational(2, 3)}},    {{1, 1}, {3, -5}}};
  for (const LinearForm& a : forms)
    for (const LinearForm& b : forms) {
      const auto found = linearFactors(product(a, b));
      BOOST_REQUIRE(found);
      BOOST_TEST((product(found->first, found->second) == product(a, b)));
    }
  BOOST_TEST(!linearFactors({{{1, 1}, 1}, {{2, 2}, 1}}));               // x^2 + y^2
  BOOST_TEST(!linearFactors({{{1, 1}, 1}, {{2, 2}, -2}}));              // sqrt(2) is no rational
  BOOST_TEST(!linearFactors({{{1, 2}, 1}, {{1, 3}, 1}, {{2, 3}, 1}}));  // xy + xz + yz
  const auto c1 = linesOf(derived("planar_3r")).at("c1");
  BOOST_TEST(c1.find("(2*qd1 + qd2 + qd3)*(qd2 + qd3)*sin(q2 + q3)") != std::string::npos, c1);
}

BOOST_AUTO_TEST_CASE(no_checks_are_printed_unless_they_fail) {
  Derivation d = only(derived("double_pendulum"), {"M22"});
  BOOST_TEST(print(d, Style::kText, false).find("check:") == std::string::npos);
  d.steps[0].holds = false;
  BOOST_TEST(print(d, Style::kText, false).find("DOES NOT HOLD") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(shorthand)

BOOST_AUTO_TEST_CASE(sums_of_positions_have_short_names_and_a_legend) {
  const auto pendulum = linesOf(withShorthand(derived("double_pendulum")));
  BOOST_TEST(pendulum.at("g2") == "1/2*m2*g*l2*s12");
  BOOST_TEST(pendulum.at("s12") == "sin(q1 + q2)");
  BOOST_TEST(pendulum.at("M12") == "1/3*m2*l2^2 + 1/2*m2*l1*l2*cos(q2)");
  const auto scara = linesOf(withShorthand(derived("scara")));
  BOOST_TEST(scara.at("c2m4") == "cos(q2 - q4)");
  BOOST_TEST(scara.at("x_flange") == "a1*cos(q1) + a2*c12 + 0.03*c12m4");
  const auto renamed_ones =
      linesOf(withShorthand(renamed(derived("double_pendulum"), {{"q1", "theta"}})));
  BOOST_TEST(renamed_ones.at("s12") == "sin(theta + q2)");
  // nothing to shorten
  BOOST_TEST(linesOf(withShorthand(derived("simple_pendulum"))) ==
             linesOf(derived("simple_pendulum")));
}

BOOST_AUTO_TEST_CASE(a_name_that_means_something_else_is_left_to_it) {
  scene::Mechanism m = scene::findScene("double_pendulum").mechanism;
  m.parameters.push_back({"s12", scene::Number(1), {}});
  const auto lines = linesOf(withShorthand(derivation(m)));
  BOOST_TEST(lines.count("s12") == 0u);
  BOOST_TEST(lines.at("g2") == "1/2*m2*g*l2*sin(q1 + q2)");
  BOOST_TEST(lines.count("c12") == 1u);
}

BOOST_AUTO_TEST_CASE(shorthand_is_read_back_with_its_legend) {
  for (const char* name : {"double_pendulum", "planar_3r", "scara", "puma_560"}) {
    const Derivation d = withShorthand(derived(name));
    for (const Style style : {Style::kText, Style::kLatex, Style::kMathml})
      BOOST_TEST(readBack(d, print(d, style), style).problem == "");
  }
  const Derivation d = withShorthand(derived("double_pendulum"));
  std::string text = print(d, Style::kText);
  const std::string right = "s12 = sin(q1 + q2)";
  text.replace(text.find(right), right.size(), "s12 = sin(q1 - q2)");
  BOOST_TEST(readBack(d, text, Style::kText).problem != "");
}

BOOST_AUTO_TEST_SUITE_END()
