// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of features: what is found in a mechanism, what can occur, and what random mechanisms have.
#include "crosscheck/inputs/feature_pairs.hpp"

#include <algorithm>
#include <cstring>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/random_mechanism.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

std::size_t place(const std::vector<const char*>& names, const char* name) {
  const auto at = std::find_if(names.begin(), names.end(),
                               [&](const char* one) { return std::strcmp(one, name) == 0; });
  BOOST_REQUIRE(at != names.end());
  return static_cast<std::size_t>(at - names.begin());
}
PairNeed need(PairRelation relation, const char* row, const char* column) {
  return PairTable::need(relation, place(PairTable::rows(relation), row),
                         place(PairTable::columns(relation), column));
}
const PairTable::Cell& cell(const PairTable& pairs, PairRelation relation, const char* row,
                            const char* column) {
  return pairs.at(relation, place(PairTable::rows(relation), row),
                  place(PairTable::columns(relation), column));
}

scene::Scene sample() {
  return scene::readSceneToml(R"(
title = "sample"
[[link]]
name = "base"
[[link]]
name = "ball"
parent = "base"
mass = 1
inertia = { xx = 1, yy = 1, zz = 1 }
joint = { kind = "spherical", rpy = [0.1, 0, 0] }
[[link]]
name = "slide"
parent = "ball"
mass = 1
inertia = { xx = 1, yy = 1, zz = 1 }
joint = { kind = "prismatic", xyz = [1, 0, 0], rotor_inertia = 1e-3, gyroscopic = true }
[[link]]
name = "hand"
parent = "slide"
mass = 1
inertia = { xx = 1, yy = 1, zz = 1 }
joint = { kind = "universal", rotors = [{ inertia = 1e-3, ratio = [1, 2], axis = [1, 0, 0] }] }
)",
                              "sample.toml");
}

constexpr PairRelation kJoint = PairRelation::kOneJoint, kNext = PairRelation::kNextOutboard,
                       kWhole = PairRelation::kOneMechanism;

}  // namespace

BOOST_AUTO_TEST_CASE(pairs_of_a_mechanism_are_found_where_they_are) {
  PairTable pairs;
  pairs.add(sample());
  for (const auto& [relation, row, column, count] :
       std::vector<std::tuple<PairRelation, const char*, const char*, int>>{
           {kNext, "spherical", "prismatic", 1},
           {kNext, "prismatic", "spherical", 0},
           {kNext, "turned on the world", "gyroscopic rotor", 1},
           {kNext, "displaced frame", "gyroscopic rotor", 0},
           {kJoint, "prismatic", "gyroscopic rotor", 1},
           {kJoint, "prismatic", "rotor", 0},
           {kJoint, "universal", "gyroscopic, to several rates", 1},
           {kJoint, "universal", "geared to several rates", 0},
           {kNext, "gyroscopic rotor", "gyroscopic, to several rates", 1},
           {kJoint, "spherical", "turned on the world", 1},
           {kJoint, "prismatic", "turned frame", 0},
           {kJoint, "prismatic", "displaced frame", 1},
           {kWhole, "no gravity", "spherical", 1},
           {kWhole, "gravity along z", "spherical", 0},
           {kWhole, "branches", "prismatic", 0}}) {
    BOOST_TEST(cell(pairs, relation, row, column).mechanisms == count, row << "; " << column);
    if (count > 0) BOOST_TEST(cell(pairs, relation, row, column).first == "sample");
  }
  pairs.add(sample());
  BOOST_TEST(cell(pairs, kNext, "spherical", "prismatic").mechanisms == 2);
  BOOST_TEST(pairs.mechanisms() == 2);
}

// Each of these was a fault that passed the crosscheck of all bundled scenes.
BOOST_AUTO_TEST_CASE(pairs_that_once_hid_a_fault_are_wanted) {
  for (const auto& [relation, row, column] :
       std::vector<std::tuple<PairRelation, const char*, const char*>>{
           {kNext, "spherical", "prismatic"},
           {kJoint, "prismatic", "gyroscopic rotor"},
           {kJoint, "floating", "turned on the world"},
           {kNext, "displaced frame", "gyroscopic rotor"},
           {kWhole, "no gravity", "revolute"}})
    BOOST_TEST((need(relation, row, column) == PairNeed::kWanted), row << "; " << column);
}

BOOST_AUTO_TEST_CASE(random_mechanisms_have_every_wanted_pair_between_them) {
  const std::vector<int> indices = randomMechanismsOfPairs(1, 12, 3000);
  PairTable pairs;
  for (const int index : indices)
    pairs.add(randomWholeScene(1, static_cast<std::uint64_t>(index), 12));
  for (const PairTable::Pair& pair : pairs.missing())
    BOOST_ERROR(name(pair.relation) << ": " << pair.row << "; " << pair.column);
  BOOST_TEST(indices.size() < 200u);  // far fewer than the pool
  for (const PairRelation relation : kAllPairRelations)
    BOOST_TEST(pairs.covered(relation) == pairs.wanted(relation));
}

BOOST_AUTO_TEST_CASE(what_is_missing_is_told) {
  PairTable pairs;
  for (std::uint64_t index = 0; index < 200; ++index)
    pairs.add(randomScene(1, index, 12, JointKinds::kPlain));
  const std::vector<PairTable::Pair> missing = pairs.missing();
  const auto has = [&](const char* row, const char* column) {
    return std::any_of(missing.begin(), missing.end(), [&](const PairTable::Pair& pair) {
      return pair.row == row && pair.column == column;
    });
  };
  BOOST_TEST(has("spherical", "prismatic"));
  BOOST_TEST(has("prismatic", "gyroscopic rotor"));
  BOOST_TEST(!has("prismatic", "rotor"));
  int covered = 0, wanted = 0;
  for (const PairRelation relation : kAllPairRelations) {
    covered += pairs.covered(relation);
    wanted += pairs.wanted(relation);
  }
  BOOST_TEST(covered + static_cast<int>(missing.size()) == wanted);
}

// Otherwise a pair that no test asks for would be called impossible.
BOOST_AUTO_TEST_CASE(what_cannot_occur_does_not) {
  PairTable pairs;
  for (const auto& file : scene::bundledScenes()) pairs.add(scene::readScene(file));
  for (std::uint64_t index = 0; index < 1000; ++index) pairs.add(randomScene(2, index, 12));
  for (const PairRelation relation : kAllPairRelations)
    for (std::size_t row = 0; row < PairTable::rows(relation).size(); ++row)
      for (std::size_t column = 0; column < PairTable::columns(relation).size(); ++column)
        if (PairTable::need(relation, row, column) == PairNeed::kCannotOccur)
          BOOST_TEST(pairs.at(relation, row, column).mechanisms == 0,
                     PairTable::rows(relation)[row] << "; " << PairTable::columns(relation)[column]
                                                    << ": "
                                                    << pairs.at(relation, row, column).first);
}
