// SPDX-License-Identifier: GPL-3.0-or-later
// Formulas written by hand against the derived ones: right, or what is wrong with them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crosscheck/diagnosis/stated_formula.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// What a stated formula is to the derived one, the first of these that holds.
enum class FormulaRelation {
  kEqual,            ///< for all values of the scene's parameters
  kForThisScene,     ///< for the scene's numbers, and not for other parameters
  kUpToConstant,     ///< V alone: another height of zero
  kNegative,         ///< minus the derived one
  kMultiple,         ///< a number, times a power of one parameter, times the derived one
  kAnotherQuantity,  ///< another derived quantity, or minus it
  kDifferent
};

/// A term of both formulas, expanded, that has not the same coefficient in both. 0: not there.
struct FormulaGap {
  std::string term;
  scene::Rational derived, stated;
};

struct JudgedFormula {
  std::string text, name;
  FormulaRelation relation = FormulaRelation::kDifferent;
  std::string factor;   ///< kMultiple: stated = factor * derived
  std::string another;  ///< kAnotherQuantity: "M22", "-g1"
  std::vector<FormulaGap> gaps;
  std::string no_gaps;  ///< why terms are not told; empty: they are

  bool isRight() const { return relation <= FormulaRelation::kUpToConstant; }
};

struct JudgedFormulas {
  std::string scene;
  std::vector<JudgedFormula> formulas;
  int points = 0;     ///< random points, each modulo a random prime
  double chance = 0;  ///< that a wrong formula passes as right, at most

  bool isRight() const;
};

/** Decides over the integers modulo random primes, at random values of parameters, positions, rates
    and accelerations, whether each formula is the derived one, and if not, what else it is; and
    names the terms in which both differ, expanded by GiNaC in parameters, q and rates.
    @param seed  of the random points
    @throws scene::InputError  as StatedLanguage */
JudgedFormulas judgeFormulas(const scene::Scene& scene, const std::vector<StatedFormula>& formulas,
                             std::uint64_t seed = 1);

}  // namespace dynwitness::crosscheck
