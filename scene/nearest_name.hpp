// SPDX-License-Identifier: GPL-3.0-or-later
// What somebody who mistyped a name may have meant.
#pragma once

#include <string>
#include <vector>

namespace dynwitness::scene {

/** Of these names the first that differs in capitals alone; from three letters on that has the same
    letters in another order, begins with the word, or is the shortest that contains it; or the one
    that fewest letters lead to, inserted, deleted or exchanged (Levenshtein), at most a third of
    the word's, or one of a short word's; or "". */
std::string nearestName(const std::string& word, const std::vector<std::string>& names);

/// " (did you mean NAME?)" where one is near, otherwise "".
std::string didYouMean(const std::string& word, const std::vector<std::string>& names);

}  // namespace dynwitness::scene
