// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "crosscheck/growth/growth.hpp"
#include "crosscheck/growth/ours.hpp"
#include "scene/families.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr int kDigitsAt = 4096;
constexpr double kWithin = 1.5, kBeyond = 3;  // times what it takes at kGrowthFrom links
constexpr double kMostBytes = 1500;           // a link
constexpr double kMostOfAll = 4e9;            // [bytes] at kMostFamilyLinks
constexpr double kDigits = 14;
constexpr double kCallersArrays =
    5 * sizeof(double);  // q, qd, qdd, tau and what is returned, a link

using Value = double GrowthPoint::*;

/// The points of the fast sweeps, by links.
std::vector<GrowthPoint> fastOf(const std::vector<GrowthPoint>& points, const std::string& family) {
  std::vector<GrowthPoint> out;
  for (const GrowthPoint& p : points)
    if (p.family == family && p.method == kFastMethod) out.push_back(p);
  return out;
}

/// The largest of value(point), with least <= links <= most; not-a-number where one is missing.
template <typename Of>
void takeLargest(const std::vector<GrowthPoint>& points, double least, double most, const Of& value,
                 GrowthGoal* goal) {
  goal->measured = kNothing;
  bool is_first = true;
  for (const GrowthPoint& p : points) {
    if (p.links < least || p.links > most) continue;
    const double x = value(p);
    if (!is_first && !std::isnan(x) && !(x > goal->measured)) continue;
    goal->measured = x;
    goal->links = p.links;
    is_first = false;
    if (std::isnan(x)) return;
  }
}

}  // namespace

double lastLevelCache() {
  namespace fs = std::filesystem;
  double bytes = 0;
  int highest = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/sys/devices/system/cpu/cpu0/cache", error)) {
    std::ifstream level_file(entry.path() / "level"), size_file(entry.path() / "size");
    int level = 0;
    double size = 0;
    char unit = ' ';
    if (!(level_file >> level) || !(size_file >> size >> unit) || level < highest) continue;
    highest = level;
    bytes = size * (unit == 'K' ? 1 << 10 : unit == 'M' ? 1 << 20 : 1);
  }
#ifdef _SC_LEVEL3_CACHE_SIZE
  if (bytes == 0) bytes = std::max(0.0, static_cast<double>(sysconf(_SC_LEVEL3_CACHE_SIZE)));
#endif
  return bytes;
}

int linksInCache(const std::vector<GrowthPoint>& points, const std::string& family, double cache) {
  const std::vector<GrowthPoint> fast = fastOf(points, family);
  for (auto p = fast.rbegin(); p != fast.rend(); ++p)
    if (p->links >= kGrowthFrom && !std::isnan(p->bytes))
      return static_cast<int>(cache / (p->bytes + kCallersArrays));
  return 0;
}

bool GrowthGoal::isMeasured() const {
  return !std::isnan(measured);
}
bool GrowthGoal::isReached() const {
  return is_least ? measured >= limit : measured <= limit;
}

std::vector<GrowthGoal> growthGoals(const std::vector<GrowthPoint>& points, double cache) {
  std::vector<GrowthGoal> goals;
  std::vector<std::string> families;
  for (const GrowthPoint& p : points)
    if (std::find(families.begin(), families.end(), p.family) == families.end())
      families.push_back(p.family);
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  for (const std::string& family : families) {
    const std::vector<GrowthPoint> fast = fastOf(points, family);
    const auto begin = [&](const std::string& name, const std::string& unit,
                           double limit) -> GrowthGoal& {
      goals.push_back({name, unit, family, limit});
      goals.back().measured = kNothing;
      return goals.back();
    };
    const int fit = linksInCache(points, family, cache);
    for (const auto& [name, ns] : {std::pair<const char*, Value>{"ID", &GrowthPoint::id_ns},
                                   std::pair<const char*, Value>{"FD", &GrowthPoint::fd_ns}}) {
      double first = kNothing;
      for (const GrowthPoint& p : fast)
        if (p.links == kGrowthFrom) first = p.*ns;
      const auto ratio = [&, value = ns](const GrowthPoint& p) { return p.*value / first; };
      GrowthGoal& within =
          begin(name + std::string(" a link, within the last-level cache"), "times", kWithin);
      within.is_time = true;
      if (fit > 0) takeLargest(fast, kGrowthFrom, fit, ratio, &within);
      GrowthGoal& beyond =
          begin(name + std::string(" a link, beyond that cache"), "times", kBeyond);
      beyond.is_time = true;
      if (fit > 0) takeLargest(fast, fit + 1.0, kNoEnd, ratio, &beyond);
    }
    double least_build = kNothing;
    const auto build = [](const GrowthPoint& p) { return p.scene_ns + p.build_ns; };
    for (const GrowthPoint& p : fast)
      if (p.links >= kGrowthFrom && p.links <= kGrowthBuildTo)
        least_build = std::fmin(least_build, build(p));
    GrowthGoal& built = begin("scene and model a link, beyond 4096 links", "times", kBeyond);
    built.is_time = true;
    takeLargest(
        fast, kGrowthBuildTo + 1, kNoEnd,
        [&](const GrowthPoint& p) { return build(p) / least_build; }, &built);
    takeLargest(
        fast, kGrowthFrom, kNoEnd, [](const GrowthPoint& p) { return p.bytes; },
        &begin("kept for ID, M and FD", "bytes a link", kMostBytes));
    takeLargest(
        fast, scene::kMostFamilyLinks, kNoEnd,
        [](const GrowthPoint& p) { return p.links * p.peak_bytes; },
        &begin("the whole process, at its largest", "bytes", kMostOfAll));
    GrowthGoal& digits = begin("certified digits of FD", "digits", kDigits);
    digits.is_least = true;
    for (const GrowthPoint& p : fast)
      if (p.links <= kDigitsAt && !std::isnan(p.fd_error)) {
        digits.measured = -std::log10(p.fd_error);
        digits.links = p.links;
      }
  }
  return goals;
}

}  // namespace dynwitness::crosscheck
