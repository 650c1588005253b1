// SPDX-License-Identifier: GPL-3.0-or-later
// A and B in letters: textbook mechanisms by hand, and what is printed of every small scene.
#include "symbolic/linear_system.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"
#include "symbolic/read_back.hpp"
#include "tests/fixtures/scene_files.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;
namespace data = boost::unit_test::data;

namespace {

const std::vector<Style> kStyles = {Style::kText, Style::kLatex, Style::kMathml};

std::vector<int> allRates(const scene::Mechanism& mechanism) {
  std::vector<int> rates(static_cast<std::size_t>(mechanism.dof()));
  std::iota(rates.begin(), rates.end(), 0);
  return rates;
}

LinearSystem systemOf(const scene::Mechanism& mechanism, const std::vector<double>& q) {
  const std::vector<double> still(q.size(), 0);
  return linearSystem(mechanism, putIn(mechanism, q, still, true), allRates(mechanism));
}

/// What stands beside each name, of joint forces on the left.
std::map<std::string, std::string> said(const LinearSystem& system) {
  std::map<std::string, std::string> out;
  for (const Step& step : system.derivation.steps)
    for (const StepEquation& e : step.equations)
      if (e.left_value)
        out[print(e.right, Style::kText)] = print(e.left, Style::kText);
      else
        out[print(e.left, Style::kText)] = print(e.right, Style::kText);
  return out;
}

std::string readProblem(const LinearSystem& system, Style style) {
  return readBack(system.derivation, print(system.derivation, style), style).problem;
}

std::vector<std::string> smallSceneFiles() {
  std::vector<std::string> files;
  for (const std::string& file : sceneFiles())
    if (const scene::Mechanism m = scene::readScene(file).mechanism;
        m.dof() > 0 && hasClosedForm(m) && m.isOpenTree())
      files.push_back(file);
  return files;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(linear_system)

// By hand: M = [mc + mp, mp l; mp l, 4/3 mp l^2], K = [0, 0; 0, -mp g l].
BOOST_AUTO_TEST_CASE(a_cart_pole_upright) {
  const LinearSystem system = systemOf(scene::findScene("cart_pole").mechanism, {0, 0});
  BOOST_TEST(system.derivation.holds());
  BOOST_TEST(system.is_forceless);
  auto text = said(system);
  BOOST_TEST(text["K22"] == "-mp*g*l");
  BOOST_TEST(text["A32"] == "-3*mp*g/(4*mc + mp)");
  BOOST_TEST(text["A42"] == "3*g*(mc + mp)/(l*(4*mc + mp))");
  BOOST_TEST(text["W11"] == "4/(4*mc + mp)");
  BOOST_TEST(text["W12"] == "-3/(l*(4*mc + mp))");
  BOOST_TEST(text["W22"] == "3*(mc + mp)/(mp*l^2*(4*mc + mp))");
}

// By hand: M22 = m2 l2^2/3, Delta = m2 l1^2 l2^2 (4 m1 + 3 m2)/36, K12 = K22 = m2 g l2/2 of rods.
BOOST_AUTO_TEST_CASE(a_double_pendulum_hangs) {
  auto text = said(systemOf(scene::findScene("double_pendulum").mechanism, {0, 0}));
  BOOST_TEST(text["W11"] == "12/(l1^2*(4*m1 + 3*m2))");
  BOOST_TEST(text["A31"] == "-3*g*(2*m1 + m2)/(l1*(4*m1 + 3*m2))");
  BOOST_TEST(text["A32"] == "9*m2*g/(l1*(4*m1 + 3*m2))");
}

// What is no right angle stays a letter, with the force that holds it there.
BOOST_AUTO_TEST_CASE(letters_stay_where_nothing_is_put_in) {
  const scene::Mechanism mechanism = scene::findScene("simple_pendulum").mechanism;
  const PutIn leaning = putIn(mechanism, {0.3}, {0}, true),
              standing = putIn(mechanism, {M_PI}, {0}, true),
              moving = putIn(mechanism, {3 * M_PI / 2}, {2}, false);
  BOOST_TEST(!leaning.right_angles[0].has_value());
  BOOST_TEST(standing.right_angles[0].value() == 2);
  BOOST_TEST(moving.right_angles[0].value() == 3);
  BOOST_TEST(!moving.is_still[0]);
  // an equilibrium that was found is near one
  BOOST_TEST(!putIn(mechanism, {1e-9}, {0}, true).right_angles[0].has_value());
  BOOST_TEST(putIn(mechanism, {1e-9}, {0}, true, 1e-8).right_angles[0].value() == 0);
  const LinearSystem system = systemOf(mechanism, {0.3});
  BOOST_TEST(!system.is_forceless);
  BOOST_TEST(said(system)["tau1"].find("sin(q1)") != std::string::npos);
  BOOST_TEST(said(system)["A21"].find("cos(q1)") != std::string::npos);
  BOOST_CHECK_THROW(systemOf(scene::findScene("puma_560").mechanism, std::vector<double>(6, 0)),
                    std::invalid_argument);
}

BOOST_DATA_TEST_CASE(every_small_scene_says_what_was_derived, data::make(smallSceneFiles()), file) {
  const scene::Mechanism mechanism = scene::readScene(file).mechanism;
  const auto n = static_cast<std::size_t>(mechanism.dof());
  for (const double q : {0.0, 0.3}) {
    const LinearSystem system = systemOf(mechanism, std::vector<double>(n, q));
    for (const Step& step : system.derivation.steps) BOOST_TEST(step.holds, step.name);
    for (const Style style : kStyles) BOOST_TEST(readProblem(system, style) == "");
  }
}

// With rates and accelerations as letters; at rest most D are 0.
BOOST_DATA_TEST_CASE(a_moving_scene_says_what_was_derived,
                     data::make({"acrobot", "furuta_pendulum"}), name) {
  const scene::Mechanism mechanism = scene::findScene(name).mechanism;
  const LinearSystem system =
      linearSystem(mechanism, putIn(mechanism, {0.3, 0.2}, {0.5, 0.4}, false), allRates(mechanism));
  BOOST_TEST(system.derivation.holds());
  BOOST_TEST(said(system).count("D11") == 1u);
  for (const Style style : kStyles) BOOST_TEST(readProblem(system, style) == "");
}

// Every sign that is printed is read.
BOOST_AUTO_TEST_CASE(every_turned_sign_of_a_linear_system_is_noticed) {
  const LinearSystem system = systemOf(scene::findScene("cart_pole").mechanism, {0, 0.3});
  const std::string text = print(system.derivation, Style::kText);
  int turned = 0;
  for (std::size_t line = 0; (line = text.find("\n     ", line)) != std::string::npos; ++line) {
    const std::size_t end = text.find('\n', line + 1);
    for (std::size_t at = text.find(" = ", line); at < end; ++at) {
      if (text[at] != '+' && text[at] != '-') continue;
      ++turned;
      std::string wrong = text;
      wrong[at] = text[at] == '+' ? '-' : '+';
      BOOST_TEST(readBack(system.derivation, wrong, Style::kText).problem != "",
                 text.substr(line, end - line));
    }
  }
  BOOST_TEST(turned > 5);
}

BOOST_AUTO_TEST_SUITE_END()
