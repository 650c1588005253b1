// SPDX-License-Identifier: GPL-3.0-or-later
// The subcommands. Each is a function  Run addNAME(CLI::App* command)  that adds options to its
// word of the command line. What it returns runs when it was asked for, and returns the exit
// status: 0 all agree (or done), 1 a disagreement was found. Bad input is thrown. commands.txt
// lists them; their declarations are made of it.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace dynwitness::cli {

using Run = std::function<int()>;

}  // namespace dynwitness::cli
