// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/reduction/advice.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 16;  ///< of candidates that are printed; JSON has all

/// Methods whose steps `simulate` chooses itself: `drift` takes any.
bool choosesSteps(const std::string& method) {
  return method == "runge_kutta_fehlberg78" || method == "runge_kutta_dopri5";
}

std::string percent(double share) {
  return share == 0 ? "0" : fmt::format("{:.3g} %", 100 * share);
}

std::string modelsTable(const Advice& advice) {
  std::string text =
      fmt::format("{:<16} {:>12} {:>12} {:>12}\n", "model", "forces off", "end off", "operations");
  for (const AdvisedModel& model : advice.models)
    text += fmt::format("{:<16} {:>12} {:>12.2g} {:>12}  {}\n", model.name(),
                        percent(model.force_error), model.end_error, model.operations,
                        model.why_not.empty() ? "" : "no: " + model.why_not);
  return text;
}

std::string row(const Advice& advice, std::size_t k) {
  const AdvisedCandidate& c = advice.candidates[k];
  const bool is_chosen = advice.chosen == k;
  std::string text = fmt::format("{} {:<16} {:<25} {:<6}", is_chosen ? '*' : ' ',
                                 advice.models[c.model].name(), c.method, name(c.scalar));
  if (c.steps > 0) {
    text += fmt::format(" {:>10.4g} {:>10.3g} {:>9.2g} {:>9.2g} {:>9.2g} {:>9.2g}", c.step,
                        c.operations, c.error(), c.model_error, c.step_error, c.rounding_error);
    if (advice.time_budget > 0) text += fmt::format(" {:>9.2g}", c.seconds);
  }
  if (!c.why_not.empty()) text += "  no: " + c.why_not;
  return text + "\n";
}

/// All up to the chosen one, and some behind it.
std::string candidatesTable(const Advice& advice) {
  std::string text =
      fmt::format("  {:<16} {:<25} {:<6} {:>10} {:>10} {:>9} {:>9} {:>9} {:>9}", "model", "method",
                  "qdd in", "step [s]", "operations", "error", "model", "step", "roundings");
  if (advice.time_budget > 0) text += fmt::format(" {:>9}", "time [s]");
  text += "\n";
  const std::size_t rows =
      std::min(advice.candidates.size(), std::max(kMostRows, advice.chosen.value_or(0) + 1));
  for (std::size_t k = 0; k < rows; ++k) text += row(advice, k);
  if (rows < advice.candidates.size())
    text += fmt::format("  and {} more (--json)\n", advice.candidates.size() - rows);
  return text;
}

std::string aboutForces(const Advice& advice) {
  if (!advice.no_reduction.empty()) return "the full model only: " + advice.no_reduction + "\n";
  std::string text = "forces off: at most this share of each joint's largest, proven in [envelope]";
  if (!advice.leaves.empty())
    text += ",\nwhich this motion leaves with " + advice.leaves + ": not proven along it";
  return text + "\n";
}

/// The nearest to what was asked, where nothing does.
std::string nothingDoes(const Advice& advice) {
  const AdvisedCandidate *fastest = nullptr, *best = nullptr;
  for (const AdvisedCandidate& c : advice.candidates) {
    if (c.steps == 0) continue;
    if (!best || c.error() < best->error()) best = &c;
    if (c.error() <= advice.error && (!fastest || c.seconds < fastest->seconds)) fastest = &c;
  }
  std::string text = "none keeps it";
  if (fastest)
    text +=
        fmt::format(" within {:.3g} s a simulated second: {} in {} takes {:.2g} s",
                    advice.time_budget, fastest->method, name(fastest->scalar), fastest->seconds);
  else if (best)
    text += fmt::format("; nearest: {} in {} with {:.2g}", best->method, name(best->scalar),
                        best->error());
  return text + "; allowed: a larger --error" + (fastest ? " or --time-budget" : "") + "\n";
}

Json numberOrNull(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json jsonOf(const AdvisedModel& model) {
  return {{"name", model.name()},
          {"allowed", model.allowed},
          {"force_error_at_most", model.force_error},
          {"operations", model.operations},
          {"end_error", numberOrNull(model.end_error)},
          {"why_not", model.why_not}};
}

Json jsonOf(const Advice& advice, const AdvisedCandidate& c) {
  Json out = {{"model", advice.models[c.model].name()},
              {"method", c.method},
              {"arithmetic", name(c.scalar)},
              {"steps", c.steps},
              {"step_s", c.step},
              {"calls_per_s", c.calls},
              {"operations_per_s", c.operations},
              {"error", numberOrNull(c.error())},
              {"model_error", numberOrNull(c.model_error)},
              {"step_error", numberOrNull(c.step_error)},
              {"rounding_error", numberOrNull(c.rounding_error)},
              {"why_not", c.why_not}};
  out["cpu_s_per_s"] = advice.time_budget > 0 && c.steps > 0 ? Json(c.seconds) : Json(nullptr);
  return out;
}

}  // namespace

std::vector<std::string> advisedCommands(const scene::Scene& scene, const Advice& advice,
                                         const std::string& words) {
  if (!advice.chosen) return {};
  const AdvisedCandidate& c = advice.candidates[*advice.chosen];
  const AdvisedModel& model = advice.models[c.model];
  std::vector<std::string> out;
  std::string moved = words;
  if (model.allowed > 0) {
    moved = "reduced.toml";
    out.push_back(fmt::format("dynwitness reduce {} --tolerance {:.6g}% --toml {}", words,
                              100 * model.allowed, moved));
  }
  const std::string how = fmt::format("{} --method {} --step {} --duration {}", moved, c.method,
                                      c.step, advice.duration);
  if (!choosesSteps(c.method))
    out.push_back("dynwitness simulate " + how);
  else if (refusals(scene, Command::kDrift).empty())
    out.push_back("dynwitness drift " + how);
  if (c.scalar != AdvisedScalar::kLanes)
    out.push_back(fmt::format("dynwitness derive {} --format c --quantity qdd --scalar {} -o code",
                              moved, name(c.scalar)));
  return out;
}

std::string adviceText(const scene::Scene& scene, const Advice& advice, const std::string& words) {
  std::string text = fmt::format(
      "{}: the end of {} s within {:.3g} [rad, m, rad/s, m/s], measured against\n"
      "runge_kutta_fehlberg78 in long double (known to {:.1g}). What one coordinate of the start "
      "is off by,\nthe end is off by up to {:.2g} times.\n\n{}{}\n",
      scene.name, advice.duration, advice.error, advice.known_to, advice.growth,
      modelsTable(advice), aboutForces(advice));
  text += candidatesTable(advice);
  text +=
      "operations: of qdd, a simulated second; error: of the end, the sum of its measured parts\n";
  if (advice.lanes > 0)
    text += fmt::format(
        "lanes: {} doubles in a vector, a motion in each; of {} motions, operations of each\n",
        advice.lanes, advice.motions);
  if (!advice.no_lanes.empty()) text += "no lanes: " + advice.no_lanes + "\n";
  text += "\n";
  if (!advice.chosen) return text + nothingDoes(advice);
  const AdvisedCandidate& c = advice.candidates[*advice.chosen];
  text +=
      fmt::format("advised: {} model, {} with h = {:.4g} s, qdd in {}: {:.3g} operations",
                  advice.models[c.model].name(), c.method, c.step, name(c.scalar), c.operations);
  if (advice.time_budget > 0) text += fmt::format(" and {:.2g} s of CPU", c.seconds);
  text += fmt::format(" a simulated second, error {:.2g}\n", c.error());
  for (const std::string& command : advisedCommands(scene, advice, words))
    text += "  " + command + "\n";
  if (c.scalar == AdvisedScalar::kLanes)
    text += fmt::format(
        "  dynwitness.load(\"{}\").fd(q, qd, tau)  of {} rows, in Python (./dynwitness python)\n",
        advice.models[c.model].allowed > 0 ? "reduced.toml" : words, advice.motions);
  return text;
}

std::string adviceJson(const scene::Scene& scene, const Advice& advice, const std::string& words,
                       const std::string& version) {
  Json models = Json::array(), candidates = Json::array();
  for (const AdvisedModel& m : advice.models) models.push_back(jsonOf(m));
  for (const AdvisedCandidate& c : advice.candidates) candidates.push_back(jsonOf(advice, c));
  return Json{{"dynwitness", version},
              {"scene", scene.name},
              {"error", advice.error},
              {"duration_s", advice.duration},
              {"time_budget_s_per_s",
               advice.time_budget > 0 ? Json(advice.time_budget) : Json(nullptr)},
              {"motions", advice.motions},
              {"lanes", advice.lanes},
              {"reference_known_to", advice.known_to},
              {"growth", advice.growth},
              {"no_reduction", advice.no_reduction},
              {"leaves_envelope", advice.leaves},
              {"models", models},
              {"candidates", candidates},
              {"chosen", advice.chosen ? Json(*advice.chosen) : Json(nullptr)},
              {"commands", advisedCommands(scene, advice, words)}}
             .dump(2) +
         "\n";
}

std::string curveName(const Advice& advice, const AdvisedCandidate& c) {
  return fmt::format("{}; {}; {}", advice.models[c.model].name(), c.method, name(c.scalar));
}

std::string adviceCsv(const Advice& advice) {
  std::string text =
      "# operations of qdd a simulated second; error of the end [rad, m, rad/s, m/s]\n"
      "curve,operations,error\n";
  for (const AdvisedCurve& curve : advice.curves)
    for (const AdvisedCurve::Point& point : curve.points)
      text +=
          fmt::format("{},{:.6g},{:.6g}\n", curveName(advice, advice.candidates[curve.candidate]),
                      point.operations, point.error);
  if (advice.chosen) {
    const AdvisedCandidate& c = advice.candidates[*advice.chosen];
    text += fmt::format("advised,{:.6g},{:.6g}\n", c.operations, c.error());
  }
  return text;
}

}  // namespace dynwitness::crosscheck
