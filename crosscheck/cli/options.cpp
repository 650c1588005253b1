// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/nearest_name.hpp"

namespace dynwitness::cli {
namespace {

/// The text as a number of this type; false where it is none, or out of the type's range.
template <typename T>
bool read(const std::string& text, T* value) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++begin;
  const auto [at, error] = std::from_chars(begin, end, *value);
  return error == std::errc() && at == end;
}

/// @param short_name  as the help shows it behind the type
template <typename T>
CLI::Validator allowed(const std::function<bool(T)>& holds, const std::string& sentence,
                       const std::string& short_name) {
  return CLI::Validator(
      [holds, sentence](std::string& text) {
        T value{};
        if (read(text, &value) && holds(value)) return std::string();
        return fmt::format("read '{}', allowed: {}", text, sentence);
      },
      short_name);
}

CLI::Validator finiteAnd(const std::function<bool(double)>& holds, const std::string& sentence,
                         const std::string& short_name) {
  return allowed<double>([holds](double x) { return std::isfinite(x) && holds(x); }, sentence,
                         short_name);
}

}  // namespace

std::string optionOf(const std::string& word) {
  return word.substr(0, word.find('='));
}

CLI::Validator finite() {
  return finiteAnd([](double) { return true; }, "finite numbers", "finite");
}
CLI::Validator positive() {
  return finiteAnd([](double x) { return x > 0; }, "positive numbers", "> 0");
}
CLI::Validator nonNegative() {
  return finiteAnd([](double x) { return x >= 0; }, "zero or positive numbers", ">= 0");
}
CLI::Validator between(double low, double high) {
  return finiteAnd([low, high](double x) { return x >= low && x <= high; },
                   fmt::format("numbers from {} to {}", low, high),
                   fmt::format("{} to {}", low, high));
}
CLI::Validator whole(std::int64_t low, std::int64_t high) {
  return allowed<std::int64_t>([low, high](std::int64_t x) { return x >= low && x <= high; },
                               fmt::format("whole numbers from {} to {}", low, high),
                               fmt::format("{} to {}", low, high));
}
CLI::Validator seed() {
  return allowed<std::uint64_t>(
      [](std::uint64_t) { return true; },
      fmt::format("whole numbers from 0 to {}", std::numeric_limits<std::uint64_t>::max()),
      "0 to 2^64-1");
}
CLI::Validator oneOf(const std::vector<std::string>& words) {
  return CLI::Validator(
      [words](std::string& text) {
        if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
        return fmt::format("read '{}'{}, allowed: {}", text, scene::didYouMean(text, words),
                           fmt::join(words, ", "));
      },
      fmt::format("{{{}}}", fmt::join(words, ",")));
}

CLI::Option* addRandom(CLI::App& command, int& states, int most, const std::string& what_for) {
  return command.add_option("--random", states, "So many seeded states: " + what_for)
      ->capture_default_str()
      ->check(whole(1, most));
}
CLI::Option* addSeed(CLI::App& command, std::uint64_t& seed_value, const std::string& of_what) {
  return command.add_option("--seed", seed_value, "Seed: " + of_what)
      ->capture_default_str()
      ->check(seed());
}
CLI::Option* addJson(CLI::App& command, std::string& file, const std::string& detail) {
  return command.add_option("--json", file,
                            "The result for programs, into this file (-: standard output)" +
                                (detail.empty() ? "" : ": " + detail));
}
CLI::Option* addOutput(CLI::App& command, std::string& path, const std::string& what) {
  const bool is_file = what.compare(0, 4, "file") == 0;
  return command.add_option("-o,--output", path,
                            "Where to: " + what + (is_file ? "; -: standard output" : ""));
}
CLI::Option* addProcesses(CLI::App& command, int& processes, const std::string& detail) {
  return command
      .add_option("--processes", processes,
                  "How many processes share the work" + (detail.empty() ? "" : ": " + detail))
      ->capture_default_str()
      ->check(whole(1, 1024));
}

}  // namespace dynwitness::cli
