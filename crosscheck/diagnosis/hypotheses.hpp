// SPDX-License-Identifier: GPL-3.0-or-later
// What may be wrong with somebody's dynamics: each a belief that can be computed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "crosscheck/diagnosis/textbook.hpp"

namespace dynwitness::crosscheck {

/// One mistake: what it makes of a right belief.
struct Hypothesis {
  std::string rule;       ///< for programs: "inertia_about_joint"
  int link = -1;          ///< where it is made, or the link that the joint carries; -1: everywhere
  bool at_joint = false;  ///< it is the joint's
  std::string sentence;   ///< for people: what is done in place of what
  std::function<void(Belief&)> apply;
};

/** All that are tried on a mechanism, the plainer before the more far-fetched: where several
    explain the same answers, the first of them is the finding. Those of a rule that differ in how
    it may have come about are entries of their own. */
std::vector<Hypothesis> hypotheses(const TextbookModel& model);

}  // namespace dynwitness::crosscheck
