// SPDX-License-Identifier: GPL-3.0-or-later
// --engine and the limits of such a program.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "crosscheck/system/children.hpp"

namespace dynwitness::cli {

/// @return  the option --engine
CLI::Option* addEngineOptions(CLI::App& command, std::vector<std::string>& engines,
                              crosscheck::Limits& limits);

}  // namespace dynwitness::cli
