// SPDX-License-Identifier: GPL-3.0-or-later
// A and B in letters by Lagrange's equations, and dual numbers in the sweeps: the same for all
// values of the letters, and not where a letter is wrong.
#include "crosscheck/studies/linear_letters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "tests/fixtures/scene_files.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

std::vector<std::string> letteredFiles() {
  std::vector<std::string> files;
  for (const std::string& file : sceneFiles()) {
    const scene::Scene scene = scene::readScene(file);
    try {
      requireLetters(scene);
    } catch (const scene::InputError&) {
      continue;
    }
    if (scene.mechanism.dof() > 0) files.push_back(file);
  }
  return files;
}

/// At these positions and rates, all of one value.
symbolic::LinearSystem lettersAt(const scene::Scene& scene, double q, double qd,
                                 bool is_unaccelerated) {
  const auto n = static_cast<std::size_t>(scene.mechanism.dof());
  std::vector<int> rates(n);
  std::iota(rates.begin(), rates.end(), 0);
  return symbolic::linearSystem(scene.mechanism,
                                symbolic::putIn(scene.mechanism, std::vector<double>(n, q),
                                                std::vector<double>(n, qd), is_unaccelerated),
                                rates);
}

bool agree(const std::vector<CheckResult>& checks) {
  return std::all_of(checks.begin(), checks.end(),
                     [](const CheckResult& check) { return check.verdict == Verdict::kAgree; });
}

}  // namespace

BOOST_DATA_TEST_CASE(letters_are_what_the_sweeps_say, data::make(letteredFiles()), file) {
  const scene::Scene scene = scene::readScene(file);
  const double right_angle = std::acos(0.0);
  for (const auto& [q, qd] : {std::pair(0.0, 0.0), {right_angle, 0.0}, {0.3, 0.0}, {0.3, 0.5}}) {
    if (qd != 0 && scene.mechanism.dof() > 2) continue;  // 20 s of modern_robotics_3link alone
    std::vector<CheckResult> checks;
    try {
      checks = checkLettersExactly(scene, lettersAt(scene, q, qd, qd == 0));
    } catch (const std::domain_error&) {
      // M may be singular where an angle is a right one
      BOOST_TEST(q == right_angle);
      continue;
    }
    BOOST_TEST(checks.size() == 3u);
    for (const CheckResult& check : checks)
      BOOST_TEST((check.verdict == Verdict::kAgree), check.name() << ": " << check.reason);
  }
}

// Each entry of A and B with its sign turned, or the state of another one.
BOOST_AUTO_TEST_CASE(wrong_letters_are_noticed) {
  const scene::Scene scene = scene::findScene("acrobot");
  const symbolic::LinearSystem right = lettersAt(scene, 0.3, 0.5, false);
  BOOST_TEST(agree(checkLettersExactly(scene, right)));
  using System = symbolic::LinearSystem;
  for (const auto block : {&System::by_position, &System::by_rate, &System::by_force})
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        System wrong = right;
        auto equations = std::make_shared<symbolic::Equations>(*right.derivation.equations);
        symbolic::Node& entry = (wrong.*block)[i][j];
        entry = equations->graph.negate(entry);
        wrong.derivation.equations = equations;
        BOOST_TEST(!agree(checkLettersExactly(scene, wrong)));
      }
  System still = lettersAt(scene, 0.3, 0, true);
  BOOST_TEST(agree(checkLettersExactly(scene, still)));
  still.at = right.at;  // said of a moving one
  BOOST_TEST(!agree(checkLettersExactly(scene, still)));
}

BOOST_AUTO_TEST_CASE(scenes_without_letters_are_refused_with_the_reason) {
  const auto reason = [](const char* name) -> std::string {
    try {
      requireLetters(scene::findScene(name));
    } catch (const scene::InputError& error) {
      return error.what();
    }
    return "";
  };
  BOOST_TEST(reason("cart_pole") == "");
  BOOST_TEST(reason("puma_560").find("6 rates") != std::string::npos);
  BOOST_TEST(reason("kapitza_pendulum").find("drives") != std::string::npos);
  BOOST_TEST(reason("heavy_top").find("quaternion") != std::string::npos);
}
