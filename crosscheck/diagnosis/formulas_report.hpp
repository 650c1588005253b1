// SPDX-License-Identifier: GPL-3.0-or-later
// What was found out about formulas, for people and for programs.
#pragma once

#include <string>

#include "crosscheck/diagnosis/judge_formulas.hpp"

namespace dynwitness::crosscheck {

/// One line a formula, its wrong terms below it, and "right" or "WRONG" as the last line.
std::string formulasText(const JudgedFormulas& judged);

/// answers.schema.json
std::string formulasJson(const JudgedFormulas& judged, const std::string& version);

}  // namespace dynwitness::crosscheck
