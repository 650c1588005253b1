// SPDX-License-Identifier: GPL-3.0-or-later
// What every program of dynwitness does between main() and a command.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/cli/commands.hpp"

namespace dynwitness::cli {

/// A word of the command line (commands.txt). What a first crosscheck does not need is in programs
/// of its own beside this one, which the wrapper builds when they are first needed.
struct Command {
  std::string name, program, description;
  Run (*add)(CLI::App* command);  ///< null: in another program
};

/// Parses, runs the command, tells failures. Returns the exit status (commands.hpp).
int front(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace dynwitness::cli
