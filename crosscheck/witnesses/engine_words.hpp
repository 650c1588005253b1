// SPDX-License-Identifier: GPL-3.0-or-later
// Words and numbers in what an engine says, as JSON, and what is said where they are others than
// expected. For the protocol of engines (engine_*.cpp) alone.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace dynwitness::crosscheck::engine {

using Json = nlohmann::ordered_json;

/// "M, c, g", or "nothing"
std::string listed(const std::vector<std::string>& words);
/// Text that somebody else wrote, fit for a line of a report.
std::string plain(std::string text);

/// @throws std::runtime_error  always: what was expected where, and what came
[[noreturn]] void expected(const std::string& where, const std::string& what, const Json& came);

// where it is none of these: expected()

/// One JSON object of a line.
Json parsed(const std::string& line);
/// A list of names.
std::vector<std::string> words(const Json& from, const char* key);
std::string textOr(const Json& from, const char* key, const std::string& otherwise);
double number(const Json& from, const char* key, const std::string& where);
/// Three numbers.
Eigen::Vector3d three(const Json& from, const std::string& where);

}  // namespace dynwitness::crosscheck::engine
