// SPDX-License-Identifier: GPL-3.0-or-later
// Conversations with crosscheck's engines: several questions under way, each larger than a pipe.
#include "crosscheck/system/children.hpp"

#include <stdexcept>
#include <string>

#include <boost/test/unit_test.hpp>

using namespace dynwitness::crosscheck;

namespace {

constexpr std::size_t kLong = 1 << 20;  ///< a pipe holds 1 << 16

std::string question(char letter) {
  return std::string(kLong, letter);
}

}  // namespace

BOOST_TEST_DECORATOR(*boost::unit_test::timeout(60))
BOOST_AUTO_TEST_CASE(questions_longer_than_pipes_are_answered_in_their_order) {
  Conversation echo("cat", {});
  echo.put(question('a'));
  echo.put(question('b'));
  BOOST_TEST((echo.take(2 * kLong) == question('a')));
  echo.put(question('c'));
  BOOST_TEST((echo.take(2 * kLong) == question('b')));
  BOOST_TEST((echo.take(2 * kLong) == question('c')));
  BOOST_TEST(echo.ask("d", 10) == "d");
}

BOOST_AUTO_TEST_CASE(answers_that_come_at_once_are_told_apart) {
  Conversation both("read a; read b; echo \"$a 1\"; echo \"$b 2\"; cat", {});
  both.put("first");
  both.put("second");
  BOOST_TEST(both.take(100) == "first 1");
  BOOST_TEST(both.take(100) == "second 2");
}

BOOST_AUTO_TEST_CASE(one_that_ends_between_two_questions_is_heard_once) {
  Conversation once("read a; echo \"$a\"", {});
  once.put("first");
  once.put("second");
  BOOST_TEST(once.take(100) == "first");
  BOOST_CHECK_EXCEPTION(once.take(100), std::runtime_error, [](const std::runtime_error& error) {
    return std::string(error.what()).find("it ended (status 0), expected an answer") == 0;
  });
  BOOST_CHECK_THROW(once.put("third"), std::runtime_error);
}

BOOST_AUTO_TEST_CASE(an_answer_without_a_question_is_refused) {
  Conversation talks("read a; echo one; echo two; cat", {});
  BOOST_TEST(talks.ask("first", 100) == "one");
  try {
    talks.put("second");
    BOOST_TEST(talks.take(100) == "two");  // it may come too late to be seen before
  } catch (const std::runtime_error& error) {
    BOOST_TEST(std::string(error.what()).find("it said more than was asked") == 0u);
  }
}
