// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep beside the Lagrangian: the same lines, of every scene that has them.
#include "crosscheck/exact/newton_euler_steps.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/scene.hpp"
#include "symbolic/read_back.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;
namespace data = boost::unit_test::data;

namespace {

std::vector<std::string> smallScenes() {
  std::vector<std::string> files;
  for (const auto& path : scene::bundledScenes())
    if (hasClosedForm(scene::readScene(path).mechanism)) files.push_back(path.string());
  return files;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(beside)

BOOST_DATA_TEST_CASE(both_columns_meet, data::make(smallScenes()), file) {
  Derivation d = derivation(scene::readScene(file).mechanism);
  const std::size_t of_lagrange = d.steps.size();
  std::vector<StepEquation> motion = d.steps.back().equations;
  crosscheck::addNewtonEuler(&d);
  BOOST_REQUIRE(d.steps.size() == of_lagrange + 4);
  BOOST_TEST(d.holds());
  for (const Style style : {Style::kText, Style::kMathml})
    BOOST_TEST(readBack(d, print(d, style), style).problem == "");
}

/// The columns are two: a derivation of another mechanism does not meet this one's sweep.
BOOST_AUTO_TEST_CASE(a_wrong_column_is_noticed) {
  const scene::Mechanism right = scene::findScene("double_pendulum").mechanism;
  scene::Mechanism heavier = right;
  heavier.links.back().inertia.mass = scene::Number::parse("m2*(1 + 1e-12)");
  Derivation d = derivation(right);
  d.mechanism = heavier;
  crosscheck::addNewtonEuler(&d);
  BOOST_TEST(!d.holds());
  BOOST_CHECK_THROW(
      [] {
        Derivation large = derivation(scene::findScene("scara").mechanism);
        crosscheck::addNewtonEuler(&large);
      }(),
      scene::InputError);
}

BOOST_AUTO_TEST_SUITE_END()
