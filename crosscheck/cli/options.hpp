// SPDX-License-Identifier: GPL-3.0-or-later
// What an option of the command line may be given, and the options that several commands have: one
// meaning a name. Every option that takes a number has one of these checks: without, CLI11 takes
// nan, inf, and what is past the range of a type.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace dynwitness::cli {

/// The option that a word of a command line is: "--states" of "--states=3".
std::string optionOf(const std::string& word);

/// A finite number of double precision.
CLI::Validator finite();
/// A finite number above zero.
CLI::Validator positive();
/// A finite number, zero or more.
CLI::Validator nonNegative();
/// A number from `low` to `high`.
CLI::Validator between(double low, double high);
/// A whole number from `low` to `high`, in digits.
CLI::Validator whole(std::int64_t low, std::int64_t high);
/// A whole number that 64 bits hold without a sign.
CLI::Validator seed();
/// One of these words.
CLI::Validator oneOf(const std::vector<std::string>& words);

// Each of the following adds one option. What it is for in this command stands behind the meaning
// in --help, after a colon.

/// --random N: so many seeded states.
CLI::Option* addRandom(CLI::App& command, int& states, int most, const std::string& what_for);
/// --seed S
CLI::Option* addSeed(CLI::App& command, std::uint64_t& seed, const std::string& of_what);
/// --json FILE
CLI::Option* addJson(CLI::App& command, std::string& file, const std::string& detail = "");
/// -o, --output PATH
CLI::Option* addOutput(CLI::App& command, std::string& path, const std::string& what);
/// --processes N
CLI::Option* addProcesses(CLI::App& command, int& processes, const std::string& detail = "");

}  // namespace dynwitness::cli
