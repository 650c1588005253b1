// SPDX-License-Identifier: GPL-3.0-or-later
// Our sweeps as what growth() measures: in double alone, nothing kept that a call does not need.
#pragma once

#include <memory>

#include "crosscheck/witness.hpp"

namespace dynwitness::crosscheck {

inline constexpr const char* kFastMethod = "fast";
inline constexpr const char* kTextbookMethod = "textbook";

std::unique_ptr<Witness> fastForGrowth(const scene::Mechanism& mechanism);
std::unique_ptr<Witness> textbookForGrowth(const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
