// SPDX-License-Identifier: GPL-3.0-or-later
// What a number on the command line may be. Every option that takes a number has one of these as
// its check: without, CLI11 takes nan, inf, and what is past the range of a type.
#pragma once

#include <cstdint>
#include <limits>

#include <CLI/CLI.hpp>

namespace dynwitness::cli {

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

}  // namespace dynwitness::cli
