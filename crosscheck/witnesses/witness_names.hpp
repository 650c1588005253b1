// SPDX-License-Identifier: GPL-3.0-or-later
// What the witnesses that witnessKinds() lists are called; no engine is loaded for it.
#pragma once

#include <string>
#include <vector>

namespace dynwitness::crosscheck {

/// In the order of the reports, absent ones among them.
std::vector<std::string> witnessNames();

}  // namespace dynwitness::crosscheck
