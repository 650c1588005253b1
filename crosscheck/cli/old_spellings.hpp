// SPDX-License-Identifier: GPL-3.0-or-later
// Options under the names that they had in the last release.
#pragma once

#include <string>
#include <vector>

namespace dynwitness::cli {

/** The words of a command line with today's names for options that are called otherwise since the
    last release; each is told once on standard error. With the next release they go.
    @param words  the command first */
std::vector<std::string> inTodaysSpelling(std::vector<std::string> words);

}  // namespace dynwitness::cli
