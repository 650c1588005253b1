// SPDX-License-Identifier: GPL-3.0-or-later
// Which rates of a joint slide and which turn, written down by hand.
#include "scene/units.hpp"

#include <string>

#include <boost/test/unit_test.hpp>

using namespace dynwitness::scene;

namespace {

/// A letter a rate: s slides, t turns.
std::string rates(JointKind kind) {
  std::string out;
  for (std::size_t k = 0; k < rateNames(kind).size(); ++k) out += slides(kind, k) ? 's' : 't';
  return out;
}
std::string positions(JointKind kind) {
  std::string out;
  for (const SlotKind slot : positionSlots(kind)) out += std::string(unitOf(slot)) + " ";
  return out;
}

}  // namespace

BOOST_AUTO_TEST_CASE(each_rate_slides_or_turns) {
  BOOST_TEST(rates(JointKind::kFixed) == "");
  BOOST_TEST(rates(JointKind::kRevolute) == "t");
  BOOST_TEST(rates(JointKind::kPrismatic) == "s");
  BOOST_TEST(rates(JointKind::kHelical) == "t");
  BOOST_TEST(rates(JointKind::kCylindrical) == "st");
  BOOST_TEST(rates(JointKind::kUniversal) == "tt");
  BOOST_TEST(rates(JointKind::kPlanar) == "sst");
  BOOST_TEST(rates(JointKind::kSpherical) == "ttt");
  BOOST_TEST(rates(JointKind::kFloating) == "sssttt");
}

BOOST_AUTO_TEST_CASE(positions_are_lengths_angles_or_parts_of_a_quaternion) {
  BOOST_TEST(positions(JointKind::kPlanar) == "m m rad ");
  BOOST_TEST(positions(JointKind::kFloating) == "m m m 1 1 1 1 ");
}
