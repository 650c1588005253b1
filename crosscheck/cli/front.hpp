// SPDX-License-Identifier: GPL-3.0-or-later
// What every program of dynwitness does between main() and a command.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "crosscheck/cli/commands.hpp"

namespace dynwitness::cli {

/// A word of the command line. What a first crosscheck does not need is in programs of its own,
/// dynwitness-PROGRAM beside this one, which the wrapper builds when they are first needed.
struct Command {
  std::string name;
  std::function<Run(CLI::App&)> add;  ///< empty: in another program
  std::string program = {};
  std::string description = {};  ///< of one in another program
};

/// Parses, runs the command, tells failures. Returns the exit status (commands.hpp).
int front(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace dynwitness::cli
