// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are nearly right, thousands of them: each is refused in words or read, and what is
// read is written and read again as the same scene. Under the sanitizers, too (ground_floor); what
// a fuzzer makes of the same question is in tests/fuzz/.
//
// DYNWITNESS_MUTATIONS=FIRST-LAST asks for those numbers instead of the usual ones: a failure names
// its own, and a night may be asked for.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/fixtures/mutations.hpp"
#include "tests/fixtures/near_files.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;

BOOST_DATA_TEST_CASE(a_file_that_is_nearly_right_is_refused_in_words_or_read,
                     data::make(fixtures::fileReaders()), reader) {
  unsigned long first = 0, last = 10000;
  if (const char* asked = std::getenv("DYNWITNESS_MUTATIONS"))
    BOOST_REQUIRE(std::sscanf(asked, "%lu-%lu", &first, &last) == 2);
  const std::vector<std::string> good = fixtures::goodTexts(reader);
  BOOST_TEST_REQUIRE(good.size() > 20u);
  int read = 0;
  for (unsigned long k = first; k < last; ++k) {
    const std::string text = fixtures::mutated(good, k);
    BOOST_TEST_CHECKPOINT("mutation " << k);  // which is told when a signal ends it
    bool is_read = false;
    const std::string wrong = fixtures::readerFault(reader, text, &is_read);
    BOOST_TEST(wrong == "", "mutation " << k << ": " << wrong);
    read += is_read ? 1 : 0;
  }
  BOOST_TEST_MESSAGE(read << " of " << last - first << " are read");
  if (last - first >= 1000) BOOST_TEST(read > static_cast<int>(last - first) / 100);
}
