// SPDX-License-Identifier: GPL-3.0-or-later
// Digits of every witness in every scene, on one page to read and to compare.
#pragma once

#include <string>

#include "crosscheck/system/environment.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/** Markdown: a table a quantity, a row a scene, a column a witness and scalar; fewest digits over
    the states, their median in brackets. */
std::string digitsTable(const CrosscheckResult& result, const Environment& environment);

}  // namespace dynwitness::crosscheck
