// SPDX-License-Identifier: GPL-3.0-or-later
// Files of states that are nearly right: each is refused in words, with file and line, or read.
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <exception>
#include <string>
#include <vector>

#include "crosscheck/inputs/states_file.hpp"
#include "scene/error.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/files.hpp"
#include "tests/fixtures/mutations.hpp"

using namespace dynwitness;

BOOST_AUTO_TEST_CASE(states_that_are_nearly_right_are_refused_in_words_or_read) {
  const scene::Mechanism mechanism = scene::findScene("heavy_top").mechanism;  // has a quaternion
  const std::vector<std::string> good = {
      "q1,q2,q3,q4,qd1,qd2,qd3\n1,0,0,0,0.5,-0.25,1e-3\n0.5,0.5,0.5,0.5,0,0,0\n",
      "# states\nq1,q2,q3,q4,tau1,tau2,tau3\n\n1,0,0,0,1,2,3\n",
      "q1,q2,q3,q4\n1,0,0,0\n0,1,0,0\n0,0,1,0\n0,0,0,1\n",
  };
  const files::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "states.csv";
  int read = 0;
  constexpr int kMutations = 3000;
  for (int k = 0; k < kMutations; ++k) {
    std::ofstream(file, std::ios::binary) << fixtures::mutated(good, static_cast<std::uint64_t>(k));
    BOOST_TEST_CHECKPOINT("mutation " << k);
    try {
      crosscheck::StatesReader states(file, mechanism);
      for (scene::State<double> state; states.next(&state);)
        for (const auto& x : state.x)
          BOOST_TEST(std::isfinite(x.q), "mutation " << k << " reads what is no number");
      ++read;
    } catch (const scene::InputError& refusal) {
      const std::string words = refusal.what();
      BOOST_TEST(words.find("states.csv:") != std::string::npos, "mutation " << k << ": " << words);
    } catch (const std::exception& other) {
      BOOST_TEST(false, "mutation " << k << " is neither read nor refused: " << other.what());
    }
  }
  BOOST_TEST(read > kMutations / 100);
  BOOST_TEST(read < kMutations);
}
