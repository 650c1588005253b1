// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/grade/marks.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/diagnosis/examine.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using Kind = Mark::Kind;
using Judged = QuantityFound::Verdict;

std::string textOr(const Json& from, const char* key, const std::string& otherwise = "") {
  return from.contains(key) ? from.at(key).get<std::string>() : otherwise;
}

/// The first finding, where it explains everything.
const Json* explanationOf(const Json& check) {
  const Json& findings = check.at("findings");
  if (findings.empty() || !findings.front().at("explains").get<bool>()) return nullptr;
  return &findings.front();
}

bool speaksOf(const Json& finding, const std::string& quantity) {
  if (!finding.contains("unexplained")) return true;
  const Json& unasked = finding.at("unexplained");
  return std::find(unasked.begin(), unasked.end(), quantity) == unasked.end();
}

std::string digitsOf(const Json& found) {
  return found.contains("digits")
             ? fmt::format("{:.1f} correct digits", found.at("digits").get<double>())
             : "all zero";
}

/// What a wrong quantity gets, and why.
void judgeWrong(const Json& check, const Json& found, const Rubric& rubric, Mark& mark) {
  mark.kind = Kind::kWrong;
  mark.feedback = fmt::format("wrong: {}, at {}", digitsOf(found), textOr(found, "entry", "state"));
  if (!found.at("rates").empty()) {
    std::vector<std::string> rates;
    for (const Json& rate : found.at("rates")) rates.push_back("'" + rate.get<std::string>() + "'");
    mark.feedback += fmt::format("; joints {}", fmt::join(rates, ", "));
  }
  if (mark.quantity == kJacobian) {  // mistakes on record are of dynamics
    if (const std::string reading = textOr(check, "jacobian_reading"); !reading.empty())
      mark.feedback += "; explained exactly by: it is that " + reading;
    return;
  }
  const Json* why = explanationOf(check);
  if (why == nullptr || !speaksOf(*why, mark.quantity)) {
    mark.feedback += "; no mistake on record explains it";
    return;
  }
  mark.feedback += fmt::format("; explained exactly by: {}", textOr(*why, "sentence"));
  const double share = rubric.share(textOr(*why, "rule"));
  if (why->contains("with") || share == 0) return;
  mark.kind = Kind::kPartial;
  mark.marks = share * mark.out_of;
  mark.feedback += fmt::format("; as the only mistake it costs {:.4g} %", 100 * (1 - share));
}

void judge(const Json& check, const Rubric& rubric, Mark& mark) {
  for (const Json& found : check.at("quantities")) {
    if (found.at("quantity") != mark.quantity) continue;
    const auto verdict = found.at("verdict").get<std::string>();
    if (verdict == name(Judged::kRight)) {
      mark.kind = Kind::kRight;
      mark.marks = mark.out_of;
      mark.feedback =
          fmt::format("right: {}, error {:.3g} ulp, limit {:.3g} ulp", digitsOf(found),
                      found.at("error_ulp").get<double>(), found.at("limit_ulp").get<double>());
    } else if (verdict == name(Judged::kWrong)) {
      judgeWrong(check, found, rubric, mark);
    } else {
      mark.kind = Kind::kNotAnswered;
      mark.feedback = "not answered: " + textOr(found, "reason", "it has no value at any state");
    }
    return;
  }
  throw std::runtime_error("a record without " + mark.quantity);
}

/// What a task has to say beside its quantities.
void remarksOf(const Json& check, const std::string& before, Grade& out) {
  for (const Json& remark : check.at("remarks"))
    out.remarks.push_back(before + remark.get<std::string>());
  if (check.contains("where"))
    for (const Json& sentence : check.at("where").at("growth"))
      out.remarks.push_back(before + sentence.get<std::string>());
  const Json& findings = check.at("findings");
  if (explanationOf(check) != nullptr) {
    const std::size_t others = findings.size() - 1;
    if (others > 0)
      out.remarks.push_back(
          fmt::format("{}{} other mistake{} would answer the same, for instance: {}", before,
                      others, others == 1 ? "" : "s", textOr(findings.at(1), "sentence")));
  } else {
    for (const Json& near : findings)
      out.remarks.push_back(fmt::format("{}nearest, explaining {:.3g} % of what is wrong: {}",
                                        before, 100 * (1 - near.at("left").get<double>()),
                                        textOr(near, "sentence")));
  }
}

}  // namespace

const char* name(Kind kind) {
  switch (kind) {
    case Kind::kRight:
      return "right";
    case Kind::kPartial:
      return "one mistake";
    case Kind::kWrong:
      return "wrong";
    case Kind::kNotAnswered:
      return "not answered";
    case Kind::kNotRun:
      return "could not be run";
  }
  return "";
}

double Grade::total() const {
  double sum = 0;
  for (const Mark& mark : marks) sum += mark.marks;
  return sum;
}
double Grade::outOf() const {
  double sum = 0;
  for (const Mark& mark : marks) sum += mark.out_of;
  return sum;
}

Grade graded(const std::string& record, const Rubric& rubric) {
  const Json all = Json::parse(record);
  Grade out;
  out.submission = all.at("submission").get<std::string>();
  out.hidden = all.at("hidden").get<bool>();
  out.problem = textOr(all, "problem");
  for (const Json& remark : all.at("remarks")) out.remarks.push_back(remark.get<std::string>());
  std::size_t failed = 0;
  for (std::size_t k = 0; k < rubric.tasks.size(); ++k) {
    const RubricTask& task = rubric.tasks[k];
    const Json none = Json::object();
    const Json& said = out.problem.empty() ? all.at("tasks").at(k) : none;
    const Json& check = said.contains("check") ? said.at("check") : none;
    std::string problem = out.problem.empty() ? textOr(said, "problem") : out.problem;
    if (problem.empty()) problem = textOr(check, "failure");
    if (!problem.empty()) ++failed;
    for (const auto& [quantity, marks] : task.marks) {
      Mark mark{task.scene.name, quantity, Kind::kNotRun, 0, marks, problem};
      if (problem.empty()) judge(check, rubric, mark);
      out.marks.push_back(std::move(mark));
    }
    if (problem.empty())
      remarksOf(check, rubric.tasks.size() == 1 ? "" : task.scene.name + ": ", out);
  }
  if (out.problem.empty() && failed == rubric.tasks.size())
    out.problem = out.marks.front().feedback;
  return out;
}

std::string keyOfRecord(const std::string& record) {
  const Json all = Json::parse(record, nullptr, false);
  return all.is_object() && all.contains("key") && all.at("key").is_string()
             ? all.at("key").get<std::string>()
             : "";
}

}  // namespace dynwitness::crosscheck
