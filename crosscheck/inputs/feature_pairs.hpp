// SPDX-License-Identifier: GPL-3.0-or-later
// Which pairs of features the mechanisms of a run have: a fault in a rare pair is seen by nobody
// who does not ask about that pair.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** How two features stand to each other:
      kOneJoint      both are of one joint, or of the link that it moves; row before column
      kNextOutboard  the row's is of a joint, the column's of a joint on the link that it moves
      kOneMechanism  the row's is of the mechanism, the column's of any of its joints */
enum class PairRelation { kOneJoint, kNextOutboard, kOneMechanism };
inline constexpr PairRelation kAllPairRelations[] = {
    PairRelation::kOneJoint, PairRelation::kNextOutboard, PairRelation::kOneMechanism};
/// "on one joint"
const char* name(PairRelation relation);

/// kCannotOccur: no scene file has it. kNotDrawn: random mechanisms do not draw it, so that it is
/// asked for nowhere. kWanted: some mechanism must have it.
enum class PairNeed { kCannotOccur, kNotDrawn, kWanted };

/// The pairs of features of a set of mechanisms, and which of them has each first.
class PairTable {
 public:
  struct Cell {
    int mechanisms = 0;
    std::string first;  ///< name of the first that has it
  };
  struct Pair {
    PairRelation relation;
    std::string row, column;
  };

  PairTable();
  void add(const scene::Scene& scene);
  /// One that has these pairs (pairsOf()).
  void add(const std::string& mechanism, const std::vector<int>& pairs);

  static const std::vector<const char*>& rows(PairRelation relation);
  static const std::vector<const char*>& columns(PairRelation relation);
  static PairNeed need(PairRelation relation, std::size_t row, std::size_t column);
  const Cell& at(PairRelation relation, std::size_t row, std::size_t column) const;

  int mechanisms() const { return mechanisms_; }
  int wanted(PairRelation relation) const;   ///< of the table, whatever was added
  int covered(PairRelation relation) const;  ///< wanted ones that a mechanism has
  /// Wanted ones that none has.
  std::vector<Pair> missing() const;

 private:
  std::vector<std::vector<Cell>> cells_;  ///< by relation, row by row
  int mechanisms_ = 0;
};

/// How many pairs there are, those that cannot occur among them.
int pairCount();
/// Numbers of the pairs that a mechanism has, each once, in ascending order: what tables are added
/// up from.
std::vector<int> pairsOf(const scene::Mechanism& mechanism);

/** Random mechanisms (randomWholeScene) that have every wanted pair between them, as far as the
    first `pool` have it: again and again the one that has most of what is still missing.
    @return  their indices, in ascending order */
std::vector<int> randomMechanismsOfPairs(std::uint64_t seed, int max_joints, int pool);

}  // namespace dynwitness::crosscheck
