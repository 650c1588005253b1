// SPDX-License-Identifier: GPL-3.0-or-later
// What is remarkable in the file that a command was given (scene/remarks.hpp).
#pragma once

#include <string>
#include <vector>

#include "crosscheck/cli/door.hpp"

namespace dynwitness::cli {

std::vector<std::string> remarksOn(const GivenScene& given, const scene::Scene& scene);

/// Tells it on standard error, each line once a run: commands may read a file twice.
void remark(const std::vector<std::string>& remarks);

}  // namespace dynwitness::cli
