// SPDX-License-Identifier: GPL-3.0-or-later
// Findings while they are looked for. For the search of explanations (explain.cpp and what it
// includes) alone.
#pragma once

#include <vector>

#include "crosscheck/diagnosis/compared_answers.hpp"
#include "crosscheck/diagnosis/hypotheses.hpp"
#include "crosscheck/diagnosis/suspects.hpp"

namespace dynwitness::crosscheck::explaining {

/// A finding, and what it believes.
struct Found {
  CheckFinding finding;
  Belief belief;
};
struct Search {
  std::vector<Found> found;
  long tried = 0, pairs_tried = 0, pairs = 0;
};

Explanation wordsOf(const Hypothesis& h);
/// @param uncertainty  of what is added to its numbers
Explanation wordsOf(const Suspect& suspect, const VectorXd& added, const VectorXd& uncertainty);

Found findingOf(const Case& all, const Belief& belief, std::vector<Explanation> parts,
                const Misfit& misfit);

}  // namespace dynwitness::crosscheck::explaining
