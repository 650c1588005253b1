// SPDX-License-Identifier: GPL-3.0-or-later
// What every program of dynwitness does between main() and a command.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "crosscheck/cli/commands.hpp"

namespace dynwitness::cli {

/// A word of the command line. One that takes long to compile and is rarely asked for is a program
/// of its own, dynwitness-NAME beside this one, which the wrapper builds when it is first needed.
struct Command {
  std::string name;
  std::function<Run(CLI::App&)> add;  ///< empty: a program of its own
  std::string description = {};       ///< of a program of its own
};

/// Parses, runs the command, tells failures. Returns the exit status (commands.hpp).
int front(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace dynwitness::cli
