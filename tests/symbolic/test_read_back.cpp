// SPDX-License-Identifier: GPL-3.0-or-later
// What is printed of a derivation, read again in three notations: every equation of every scene,
// and every sign that is turned in what was printed.
#include "symbolic/read_back.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"
#include "tests/fixtures/scene_files.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;
namespace data = boost::unit_test::data;

namespace {

const std::vector<Style> kStyles = {Style::kText, Style::kLatex, Style::kMathml};

scene::Mechanism pendulumWith(const std::string& parameters, const std::string& mass) {
  return scene::readSceneToml(
             "title = \"p\"\nsource = \"this test\"\ngravity = [0, 0, -10]\n"
             "[parameters]\n" +
                 parameters +
                 "\n[[link]]\nname = \"base\"\n"
                 "[[link]]\nname = \"bob\"\nparent = \"base\"\nmass = \"" +
                 mass +
                 "\"\ncom = [0, 0, -1]\n[link.joint]\nkind = \"revolute\"\n"
                 "axis = [0, 1, 0]\n",
             "p.toml")
      .mechanism;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(printed)

BOOST_DATA_TEST_CASE(every_equation_of_every_scene_says_what_was_derived,
                     data::make(derivedSceneFiles()), file) {
  const scene::Mechanism mechanism = scene::readScene(file).mechanism;
  const Derivation d = derivation(mechanism, hasClosedForm(mechanism));
  for (const Step& step : d.steps) BOOST_TEST(step.holds, step.name);
  for (const Style style : kStyles) {
    const ReadBack read = readBack(d, print(d, style), style);
    BOOST_TEST(read.problem == "");
    BOOST_TEST(read.points == 2);
    BOOST_TEST(read.formulas > 2 * d.equations->dof());
  }
}

/// Signs of what is printed, turned one at a time: of all that stand in an equation, read or named.
BOOST_AUTO_TEST_CASE(every_turned_sign_is_noticed) {
  for (const char* name : {"double_pendulum", "stanford_arm"}) {
    const Derivation d = derivation(scene::findScene(name).mechanism);
    const std::string text = print(d, Style::kText);
    int turned = 0;
    for (std::size_t line = 0; (line = text.find("\n     ", line)) != std::string::npos; ++line) {
      const std::size_t end = text.find('\n', line + 1);
      for (std::size_t at = text.find(" = ", line); at < end; ++at) {
        if (text[at] != '+' && text[at] != '-') continue;
        if (++turned % 17 != 1 && std::string(name) != "double_pendulum") continue;
        std::string wrong = text;
        wrong[at] = text[at] == '+' ? '-' : '+';
        BOOST_TEST(readBack(d, wrong, Style::kText).problem != "",
                   name << ": " << text.substr(line, end - line));
      }
    }
    BOOST_TEST(turned > 10);
  }
}

BOOST_AUTO_TEST_CASE(other_faults_of_printers_are_noticed) {
  const Derivation d = derivation(scene::findScene("double_pendulum").mechanism);
  const auto problem = [&](Style style, const std::string& right, const std::string& wrong) {
    std::string text = print(d, style);
    const std::size_t at = text.find(right);
    BOOST_REQUIRE_MESSAGE(at != std::string::npos, right);
    text.replace(at, right.size(), wrong);
    return readBack(d, text, style).problem;
  };
  // a lost exponent, an argument, an index, a factor, parentheses, a whole line
  BOOST_TEST(problem(Style::kText, "l1^2", "l1") != "");
  BOOST_TEST(problem(Style::kText, "cos(q1 + q2)", "cos(q1)") != "");
  BOOST_TEST(problem(Style::kText, "*sin(q2)", "*sin(q1)") != "");
  BOOST_TEST(problem(Style::kText, "(2*qd1 + qd2)", "2*qd1 + qd2") != "");
  BOOST_TEST(problem(Style::kText, "     M22 = 1/3*m2*l2^2\n", "") != "");
  BOOST_TEST(problem(Style::kLatex, "(q_{1} + q_{2})", "q_{1} + q_{2}") != "");
  BOOST_TEST(problem(Style::kLatex, "\\tfrac{1}{3}", "\\tfrac{1}{2}") != "");
  BOOST_TEST(problem(Style::kLatex, "\\dot{q}_{1}", "q_{1}") != "");
  BOOST_TEST(problem(Style::kMathml, "<mo>&#x2212;</mo>", "<mo>+</mo>") != "");
  BOOST_TEST(problem(Style::kMathml, "<mn>3</mn>", "<mn>4</mn>") != "");
}

BOOST_AUTO_TEST_CASE(what_is_said_of_parameters_is_read) {
  const Derivation d = derivation(pendulumWith("m1 = 2.5\nm2 = \"m1/3\"", "m1 + m2"));
  const std::string said[] = {
      "with m1 = 2.5 kg, m2 = 5/6 kg",
      "with $m_{1} = 2.5\\,\\mathrm{kg}$, $m_{2} = \\tfrac{5}{6}\\,\\mathrm{kg}$",
      "<mn>2.5</mn></mrow></math> kg, "};
  for (std::size_t k = 0; k < kStyles.size(); ++k) {
    const std::string text = print(d, kStyles[k]);
    BOOST_TEST(readBack(d, text, kStyles[k]).problem == "");
    BOOST_TEST(text.find(said[k]) != std::string::npos, text);
    std::string wrong = text;
    wrong.replace(wrong.find("2.5"), 3, "2.6");
    BOOST_TEST(readBack(d, wrong, kStyles[k]).problem.find("no value of the scene") !=
               std::string::npos);
  }
  std::string silent = print(d, Style::kText);
  silent.erase(silent.find("   with m1"),
               silent.find('\n', silent.find("with m1")) - silent.find("   with m1"));
  BOOST_TEST(readBack(d, silent, Style::kText).problem.find("other parameters") !=
             std::string::npos);
}

BOOST_AUTO_TEST_CASE(letters_that_look_alike_are_told) {
  const Derivation d = derivation(pendulumWith("m1 = 1\nm_1 = 2", "m1*m_1"));
  BOOST_TEST(readBack(d, print(d, Style::kText), Style::kText).problem == "");
  const std::string problem = readBack(d, print(d, Style::kLatex), Style::kLatex).problem;
  BOOST_TEST(problem.find("'m_{1}' stands for two things") != std::string::npos, problem);
}

BOOST_AUTO_TEST_SUITE_END()
