// SPDX-License-Identifier: GPL-3.0-or-later
// Files of states (crosscheck/inputs/states_file.hpp) that are nearly right: each is refused in
// words, with file and line, or read.
#include <boost/test/unit_test.hpp>

#include <fstream>
#include <string>

#include "tests/fixtures/files.hpp"
#include "tests/fixtures/mutations.hpp"
#include "tests/fixtures/near_states.hpp"

using namespace dynwitness;

BOOST_AUTO_TEST_CASE(states_that_are_nearly_right_are_refused_in_words_or_read) {
  const files::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "states.csv";
  int read = 0;
  constexpr int kMutations = 3000;
  for (int k = 0; k < kMutations; ++k) {
    std::ofstream(file, std::ios::binary)
        << fixtures::mutated(fixtures::kGoodStates, static_cast<std::uint64_t>(k));
    BOOST_TEST_CHECKPOINT("mutation " << k);
    bool is_read = false;
    const std::string wrong = fixtures::statesFault(file, &is_read);
    BOOST_TEST(wrong == "", "mutation " << k << ": " << wrong);
    read += is_read ? 1 : 0;
  }
  BOOST_TEST(read > kMutations / 100);
  BOOST_TEST(read < kMutations);
}
