// SPDX-License-Identifier: GPL-3.0-or-later
// How the commands that look at one scene print their checks and write them as JSON.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/error.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

using Json = nlohmann::ordered_json;

/// One line a check on standard output. @return the exit status: 1 when one disagrees
int printFindings(const std::vector<crosscheck::CheckResult>& checks);

/// {"dynwitness", "command", "scene": {"name", "dof"}, "result", "checks", "verdict"}; checks as in
/// report.json.
std::string findingsJson(const std::string& command, const scene::Scene& scene, const Json& result,
                         const std::vector<crosscheck::CheckResult>& checks);

/// A matrix, row by row; a number that is none is the string "inf".
Json toJson(const Eigen::MatrixXd& m);
/// A matrix with its bounds.
Json toJson(const crosscheck::Bounded& m);

/// @throws scene::InputError naming the numbers that are not finite
void requireFinite(const char* what, const Eigen::MatrixXd& values);
template <typename Values>
void requireFinite(const char* what, const Values& values) {
  requireFinite(what, Eigen::MatrixXd(Eigen::Map<const Eigen::VectorXd>(
                          values.data(), static_cast<Eigen::Index>(values.size()))));
}

/// "+- 1e-16", or that no bound is known.
std::string boundText(double bound);

/// The numbers of an option, as many as `to` has; none: `to` stays.
/// @throws scene::InputError naming the option, on another count
template <std::size_t kCount>
void put(const char* option, const std::vector<double>& from, std::array<double, kCount>* to) {
  if (from.empty()) return;
  if (from.size() != kCount)
    throw scene::InputError({}, std::string(option) + ": " + std::to_string(from.size()) +
                                    " values, allowed: " + std::to_string(kCount));
  std::copy(from.begin(), from.end(), to->begin());
}

}  // namespace dynwitness::cli
