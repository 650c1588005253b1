// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of features in the report, and for programs.
#pragma once

#include <string>

#include "crosscheck/inputs/feature_pairs.hpp"

namespace dynwitness::crosscheck {

/// The section "Pairs of features": a table a relation, red where a wanted pair is missing.
std::string pairsSection(const PairTable& pairs);

/// As JSON: which wanted pairs are missing, and for each pair that some mechanism has how many have
/// it, and which is the first.
std::string pairsJson(const PairTable& pairs);

}  // namespace dynwitness::crosscheck
