// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crosscheck/reduction/ladder.hpp"
#include "crosscheck/witnesses/column_names.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double share) {
  if (std::isinf(share)) return "all";
  return share == 0 ? "0" : fmt::format("{:.3g} %", 100 * share);
}

/// "43 % of tau2 (elbow)"
std::string inWords(const ForceGap& gap, const std::vector<std::string>& names) {
  if (gap.joint < 0) return "0";
  return fmt::format("{} of tau{} ({})", percent(gap.share), gap.joint + 1,
                     names[static_cast<std::size_t>(gap.joint)]);
}

std::string motionInWords(const Rung& rung, double duration) {
  if (!rung.motion) return "does not move";
  const RungMotion& m = *rung.motion;
  if (m.position < 0) return "the same";
  const std::string follows = m.follows_s >= duration ? std::string("all the time")
                                                      : fmt::format("for {:.3g} s", m.follows_s);
  return fmt::format("{}; q{} {:.2g} off at {:.3g} s", follows, m.position + 1, m.gap, m.time);
}

std::string countInWords(const Rung& rung) {
  if (!rung.operations) return "-";
  return fmt::format("{}{}", *rung.operations, rung.is_straight_line ? "" : "*");
}

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json jsonOf(const ForceGap& gap, const std::vector<std::string>& units) {
  if (gap.joint < 0) return nullptr;
  return {{"tau", gap.joint + 1},
          {"share", number(gap.share)},
          {"force", gap.force},
          {"unit", units[static_cast<std::size_t>(gap.joint)]},
          {"time_s", gap.time}};
}

bool moves(const Ladder& ladder) {
  return std::any_of(ladder.largest.begin(), ladder.largest.end(), [](double x) { return x > 0; });
}

}  // namespace

std::string ladderText(const scene::Scene& scene, const Ladder& ladder) {
  const std::vector<std::string> names = scene.mechanism.rateLabels();
  std::string text = fmt::format(
      "{}: what its own motion needs, {} s from its start\n"
      "forces: what a rung misses at worst, in % of the largest of M qdd, c, g, friction at that joint\n"
      "follows: so long its own motion keeps within {:.0f} % of each position's travel\n\n",
      scene.name, ladder.duration, 100 * Ladder::kFollows);
  const auto row = [&](const std::string& rung, const std::string& operations,
                       const std::string& above, const std::string& full,
                       const std::string& motion) {
    std::string line =
        fmt::format("{:<27} {:>10}  {:<28} {:<28} {}", rung, operations, above, full, motion);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  };
  row("rung", "operations", "misses of the next rung", "misses of the scene", "follows");
  for (std::size_t r = 0; r < ladder.rungs.size(); ++r) {
    const Rung& rung = ladder.rungs[r];
    const bool is_scene = r + 1 == ladder.rungs.size();
    row((r == 0 ? "" : "+ ") + rung.adds, countInWords(rung),
        is_scene ? "" : inWords(rung.above, names),
        is_scene ? "nothing: it is the scene" : inWords(rung.full, names),
        is_scene ? "" : motionInWords(rung, ladder.duration));
  }
  bool has_sweep = false;
  text += "\n";
  for (const Rung& rung : ladder.rungs) {
    has_sweep = has_sweep || (rung.operations && !rung.is_straight_line);
    if (!rung.motion)
      text += fmt::format("no motion with no more than {}: {}\n", rung.adds, rung.no_motion);
    if (!rung.no_count.empty()) text += fmt::format("- {}: {}\n", rung.adds, rung.no_count);
  }
  if (has_sweep) text += "* by the general sweep: too long for a straight line\n";
  if (!ladder.absent.empty())
    text += fmt::format("not in this scene: {}\n", fmt::join(ladder.absent, ", "));
  if (!moves(ladder))
    text += "no force acts and nothing moves; allowed: another start (--q, --qd)\n";
  return text;
}

std::string ladderJson(const scene::Scene& scene, const Ladder& ladder,
                       const LadderOptions& options, const std::string& version) {
  const std::vector<std::string> units = columnUnits(Quantity::kTau, scene.mechanism);
  Json rungs = Json::array();
  for (const Rung& rung : ladder.rungs) {
    Json motion = nullptr;
    if (rung.motion)
      motion = {
          {"follows_s", rung.motion->follows_s},
          {"gap", rung.motion->gap},
          {"position", rung.motion->position < 0 ? Json(nullptr) : Json(rung.motion->position + 1)},
          {"time_s", rung.motion->time}};
    rungs.push_back({{"adds", rung.adds},
                     {"operations", rung.operations ? Json(*rung.operations) : Json(nullptr)},
                     {"is_straight_line", rung.is_straight_line},
                     {"no_count", rung.no_count},
                     {"misses_of_next_rung", jsonOf(rung.above, units)},
                     {"misses_of_scene", jsonOf(rung.full, units)},
                     {"motion", motion},
                     {"no_motion", rung.no_motion}});
  }
  const Json all = {{"dynwitness", version},
                    {"scene", scene.name},
                    {"duration_s", options.duration},
                    {"compared_times", options.outputs + 1},
                    {"follows_within", Ladder::kFollows},
                    {"largest_forces", ladder.largest},
                    {"rungs", rungs},
                    {"absent", ladder.absent}};
  return all.dump(2) + "\n";
}

std::string ladderCsv(const Ladder& ladder) {
  std::string csv = "rung,operations,error_above,error_full\n";
  for (const Rung& rung : ladder.rungs)
    csv += fmt::format("{},{},{:.6g},{:.6g}\n", rung.adds,
                       rung.operations ? fmt::format("{}", *rung.operations) : "", rung.above.share,
                       rung.full.share);
  return csv;
}

}  // namespace dynwitness::crosscheck
