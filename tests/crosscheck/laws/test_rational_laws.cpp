// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of identities.hpp over the rationals.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "tests/crosscheck/laws/rational_laws.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using fixtures::mismatch;
using fixtures::Q;
using recursive::MatrixX;

// Every law of identities.hpp, which the crosscheck asks within rounding: here without any
// rounding, on random trees. The residual is 0 or it is not.
BOOST_DATA_TEST_CASE(the_laws_of_mechanics_hold_without_rounding, data::xrange(6), seed) {
  const int moving = 3 + static_cast<int>(seed) % 3;
  const fixtures::Tree tree = fixtures::randomTree(moving, seed);
  const fixtures::RationalNumbers number(tree.mechanism);
  crosscheck::SweptMechanism<Q> swept(tree.mechanism, number);
  const auto sides =
      crosscheck::Identities::sides(tree.mechanism, swept.at(fixtures::randomState(moving, seed)));
  const auto words = crosscheck::Identities::words(tree.mechanism);
  BOOST_REQUIRE(sides.size() == words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& both = sides[i];
    BOOST_TEST_CONTEXT(words[i].name << ": " << words[i].statement) {
      BOOST_TEST(mismatch(both.left, both.right) == "");
      // generic: a law between zeros would be no test
      BOOST_TEST(mismatch(both.left,
                          MatrixX<Q>::Constant(both.left.rows(), both.left.cols(), Q(0))) != "");
    }
  }
}
