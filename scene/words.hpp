// SPDX-License-Identifier: GPL-3.0-or-later
// Text in pieces.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dynwitness::scene {

/// Without blanks, tabs and carriage returns at its ends.
std::string_view trimmed(std::string_view text);

/// "hand,0,,l/2" as hand, 0, nothing and l/2: one more than there are commas, as they stand.
std::vector<std::string> splitAtCommas(std::string_view list);

}  // namespace dynwitness::scene
