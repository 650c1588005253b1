// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/words.hpp"

#include <boost/test/unit_test.hpp>

using namespace dynwitness::scene;

BOOST_AUTO_TEST_CASE(commas_part_a_list_and_nothing_is_lost) {
  using Words = std::vector<std::string>;
  BOOST_TEST(splitAtCommas("hand,0,,l/2") == (Words{"hand", "0", "", "l/2"}),
             boost::test_tools::per_element());
  BOOST_TEST(splitAtCommas("") == Words{""}, boost::test_tools::per_element());
  BOOST_TEST(splitAtCommas(",") == (Words{"", ""}), boost::test_tools::per_element());
  BOOST_TEST(splitAtCommas(" a , b") == (Words{" a ", " b"}), boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(blanks_go_at_both_ends_and_stay_within) {
  BOOST_TEST(trimmed(" \t q1 = 2 \r") == "q1 = 2");
  BOOST_TEST(trimmed("q1") == "q1");
  BOOST_TEST(trimmed(" \t\r") == "");
  BOOST_TEST(trimmed("") == "");
}
