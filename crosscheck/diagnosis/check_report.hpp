// SPDX-License-Identifier: GPL-3.0-or-later
// What an examination found, for people and for programs.
#pragma once

#include <string>

#include "crosscheck/diagnosis/examine.hpp"

namespace dynwitness::crosscheck {

/// What is done in place of what; of a pair both.
std::string sentenceOf(const CheckFinding& finding);

/// For a terminal.
std::string checkText(const Examination& examination);

/// As check.schema.json describes it.
std::string checkJson(const Examination& examination, const std::string& version);

}  // namespace dynwitness::crosscheck
