// SPDX-License-Identifier: GPL-3.0-or-later
// What the steps of closed forms and of programs have in common; for the files that make them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "symbolic/derivation.hpp"

namespace dynwitness::symbolic {

/// Longer rows keep the names of what stands in them [characters of plain text].
constexpr std::size_t kLongestRow = 400, kWidestMatrix = 120;
constexpr const char* kPositionsSentence =
    "The centre of mass of each link that moves, in axes of the world; what is not listed is 0.";
constexpr const char* kPositionsCheck =
    "sum of m p over the links that move together is their first moment of mass, of which V is made";
constexpr const char* kVelocitiesSentence =
    "v = dp/dt of the same points, in axes of the world; omega of each link, in its own axes, from "
    "the turn R that takes them to the world's: (R' dR/dt) b = omega x b. What is not listed is 0.";
constexpr const char* kChristoffelSentence =
    "Gamma_ijk = (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i)/2; those that are not listed are 0, and "
    "Gamma_ikj = Gamma_ijk.";
constexpr const char* kLoadsCheck = "without -dR/dqd_i depends on the position alone";

/// "M12", "M10_2": counted from 1.
std::string numbered(const std::string& letter, int i);
std::string numbered(const std::string& letter, int i, int j);
std::string christoffelName(int i, int j, int k);  ///< "Gamma112", "Gamma1_10_2"

std::size_t length(const Formula& f);  ///< of its plain text
bool isZero(const Formula& f);         ///< the number 0
/// A sum, the terms of its terms written one after the other.
Formula flatSum(const std::vector<Formula>& terms);

/// What an entry of M, c or g is shown as: a closed form, 0, or its own name.
using ShownEntry = std::function<Formula(const std::string& name, Node)>;
/// M qdd + c + g = tau (+ Q), row i: written out, or where that is too long by names.
StepEquation equationOfMotion(Equations& e, int i, const ShownEntry& shown);
bool isLoaded(const Equations& e);
const char* loadsSentence(const Equations& e);

/// The steps of a mechanism of many joints: what is short in closed form, the rest as lines.
std::vector<Step> programSteps(Equations& e, const scene::Mechanism& mechanism,
                               const Options& options, int points);

}  // namespace dynwitness::symbolic
