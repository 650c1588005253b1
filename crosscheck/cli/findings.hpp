// SPDX-License-Identifier: GPL-3.0-or-later
// How the commands that look at one scene print their checks and write them as JSON.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "crosscheck/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

using Json = nlohmann::ordered_json;

/// One line a check on standard output. @return the exit status: 1 when one disagrees
int printFindings(const std::vector<crosscheck::CheckResult>& checks);

/// {"dynwitness", "command", "scene": {"name", "dof"}, "result", "checks", "verdict"}; checks as in
/// report.json.
std::string findingsJson(const std::string& command, const scene::Scene& scene, const Json& result,
                         const std::vector<crosscheck::CheckResult>& checks);

/// Matrix of numbers as rows.
template <typename Matrix>
Json rows(const Matrix& m) {
  Json all = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(m(i, j));
    all.push_back(row);
  }
  return all;
}

}  // namespace dynwitness::cli
