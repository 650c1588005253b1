// SPDX-License-Identifier: GPL-3.0-or-later
// What a crosscheck prints on standard output.
#pragma once

#include <map>
#include <string>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::cli {

/** Headline, a line a scene, and what a person should know: a line for each cause of disagreements,
    what was not answered, second readings, published motions, known losses.
    @param page   of the report, where each check stands that a cause explains
    @param asked  options by which `check` asks a program, by witness: --engine "COMMAND" */
void printResult(const crosscheck::CrosscheckResult& result, const std::string& page,
                 const std::map<std::string, std::string>& asked);

}  // namespace dynwitness::cli
