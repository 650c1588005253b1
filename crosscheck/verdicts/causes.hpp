// SPDX-License-Identifier: GPL-3.0-or-later
// What many disagreements of a scene have in common.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Disagreements that one cause explains: a witness that stands alone, a number that the scene's
/// file does not say, a law, or a quantity that witnesses dispute among themselves.
struct Cause {
  std::string scene;
  std::string witness;  ///< that stands alone; empty: none does
  /// Quantities in dispute that are no part of another in dispute (tau contains M, c and g; c
  /// contains the derivatives of M), those that contain one, and those of the witness that are
  /// right.
  std::vector<std::string> wrong, following, right;
  std::vector<std::string> joints;         ///< whose own entries are wrong
  std::vector<const CheckResult*> checks;  ///< of the scene, which has to live as long
  const CheckResult::Off* off = nullptr;   ///< a wrong answer in figures, where there is one
  std::string text;                        ///< one line, with all of it
};

/** The causes of a scene's disagreements; every one of these belongs to one of them. A disagreement
    is laid to the witness that stands alone (findOutliers()) and takes part in it, the one with the
    most of them first; to the second reading of the file, with the tables, if that disagrees; or
    else to the law, the table or the quantity that it is of.
    @return  those with the most disagreements first */
std::vector<Cause> causesOf(const SceneResult& scene);

/// "is off by 3.1 N m where 12 N m is right"; beyond ten times what is right, "is 345 N m where 3.1
/// N m is right, 111 times that" (and "the other way", where signs differ).
std::string figures(const CheckResult::Off& off);

}  // namespace dynwitness::crosscheck
