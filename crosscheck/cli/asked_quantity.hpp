// SPDX-License-Identifier: GPL-3.0-or-later
// What a quantity that evaluate is asked for stands on: of the state, and of the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::cli {

/// Who answers when nobody is named: the sweep made for the quantity.
std::string usualWitness(crosscheck::Quantity quantity);

/// What is formed of tau as inverse dynamics has it, along a motion.
enum class Along {
  kNothing,
  kPower,     ///< tau' qd, of all joint forces together [W]
  kResidual,  ///< tau - the tau that is given: what a motion leaves of its equations [N m, N]
};

inline constexpr const char* kPower = "power";
inline constexpr const char* kResidual = "residual";
std::optional<Along> alongNamed(const std::string& quantity);

/// What a quantity is asked at, beside q and qd.
enum class Needs { kNothing, kQdd, kTau };

/// Whether reactions are those of more than the tree and its drives: then qdd alone does not tell
/// them.
bool hasMoreThanItsTree(const scene::Mechanism& mechanism);

Needs needsOf(const std::string& quantity, const scene::Mechanism& mechanism);

/// Whether a quantity takes the inverse of M of any scene: where a joint moves no inertia there is
/// none.
bool takesInverse(const std::string& quantity);

/// Which row of the table of features a quantity belongs to.
crosscheck::Command commandOf(const std::string& quantity);

/// What of a state the answers hang on.
struct StateUsed {
  bool qdd = false, tau = false;
};

StateUsed usedBy(const std::vector<std::string>& quantities, const scene::Mechanism& mechanism,
                 bool finds_qdd);

/// @throws scene::InputError  it is none of all that can be asked
void requireQuantity(const std::string& text);

}  // namespace dynwitness::cli
