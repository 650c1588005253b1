// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/findings.hpp"

#include <cmath>

#include <fmt/format.h>

#include "crosscheck/cli/speech.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/report/json.hpp"

namespace dynwitness::cli {

using crosscheck::CheckResult;
using crosscheck::Verdict;

namespace {

std::string evidence(const CheckResult& check) {
  if (check.verdict != Verdict::kAgree) return check.reason;
  if (check.exact) return describeExact(*check.exact);
  if (check.limit == 0) return fmt::format("{:g} {}", check.worst, check.unitName());
  return fmt::format("{:.3g} {}, limit {:.3g}", check.worst, check.unitName(), check.limit);
}

}  // namespace

int printFindings(const std::vector<CheckResult>& checks) {
  bool agree = true;
  for (const CheckResult& check : checks) {
    agree = agree && check.verdict != Verdict::kDisagree;
    fmt::print("{}{}: {}, by {}{}{}\n               {}\n",
               tonedVerdict(fmt::format("{:<15}", name(check.verdict))), check.name(),
               check.statement, check.left, check.right.empty() ? "" : " and ", check.right,
               evidence(check));
  }
  return agree ? 0 : 1;
}

std::string findingsJson(const std::string& command, const scene::Scene& scene, const Json& result,
                         const std::vector<CheckResult>& checks) {
  Json json{{"dynwitness", DYNWITNESS_VERSION},
            {"command", command},
            {"scene", {{"name", scene.name}, {"dof", scene.mechanism.dof()}}},
            {"result", result},
            {"checks", Json::array()}};
  bool agree = true;
  for (const CheckResult& check : checks) {
    json["checks"].push_back(Json::parse(crosscheck::checkJson(check)));
    agree = agree && check.verdict != Verdict::kDisagree;
  }
  json["verdict"] = agree ? "agree" : "disagree";
  return json.dump(2) + "\n";
}

void requireFinite(const char* what, const Eigen::MatrixXd& values) {
  if (!values.allFinite())
    throw scene::InputError({},
                            std::string(what) +
                                " would not be finite: M is singular at this state, or numbers are "
                                "too large; allowed: states and numbers that have an answer");
}

std::string boundText(double bound) {
  return std::isfinite(bound) ? fmt::format("+- {:.2g}", bound) : "+- unknown";
}

Json toJson(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      row.push_back(std::isfinite(m(i, j)) ? Json(m(i, j)) : Json("inf"));
    rows.push_back(row);
  }
  return rows;
}

Json toJson(const crosscheck::Bounded& m) {
  return {{"value", toJson(m.value)}, {"bound", toJson(m.bound)}};
}

}  // namespace dynwitness::cli
