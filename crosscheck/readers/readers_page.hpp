// SPDX-License-Identifier: GPL-3.0-or-later
// What readers made of a file, as a page.
#pragma once

#include <string>

#include "crosscheck/readers/compare.hpp"
#include "crosscheck/system/environment.hpp"

namespace dynwitness::crosscheck {

/// One HTML page: who has another robot, a table (a row a link, a column a reader), the findings,
/// and what is told besides. One file, no scripts and no network.
std::string readersPage(const ReadersResult& result, const Environment& environment);

}  // namespace dynwitness::crosscheck
