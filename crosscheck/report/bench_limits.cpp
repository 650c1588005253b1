// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/report/bench.hpp"

namespace dynwitness::crosscheck {
namespace {

/// What was measured of reading or writing, and of how many bytes, the fewest first.
std::vector<std::pair<double, const Measurement*>> bySize(const BenchResult& result,
                                                          const char* what) {
  std::vector<std::pair<double, const Measurement*>> all;
  for (const Measurement& m : result.measured)
    if (m.subject == kMachine && m.what == what && m.unit == "ns")
      all.emplace_back(1024 * std::strtod(m.by.c_str(), nullptr), &m);
  std::sort(all.begin(), all.end());
  return all;
}

/// Nanoseconds a byte, of as many bytes as a contender goes through: of the sizes that were
/// measured the largest that is not larger, since a smaller array is never slower; else the
/// smallest.
std::optional<double> perByte(const BenchResult& result, const char* what, double bytes) {
  std::optional<double> best;
  for (const auto& [size, m] : bySize(result, what))
    if (!best || size <= bytes) best = m->value;
  return best;
}

}  // namespace

std::optional<double> BenchResult::perOperation() const {
  std::optional<double> best;
  for (const Measurement& m : measured)
    if (m.subject == kMachine && m.what == kOperation && m.unit == "ns")
      best = std::min(best.value_or(m.value), m.value);
  return best;
}

std::optional<Limit> limitOf(const BenchResult& result, const std::string& what,
                             const std::string& subject, const std::string& by) {
  const auto ns = result.value(what, subject, by, "ns"),
             operations = result.value(what, subject, by, kOperationsWithSines),
             per_operation = result.perOperation();
  if (!ns || !operations || !per_operation) return std::nullopt;
  Limit limit{*operations * *per_operation, "operations"};
  const double extent = result.value(what, subject, by, kBytesAtHand).value_or(0);
  for (const auto& [unit, way] :
       {std::pair(kBytesRead, kMemoryRead), {kBytesWritten, kMemoryWritten}}) {
    const auto bytes = result.value(what, subject, by, unit),
               per_byte = perByte(result, way, extent);
    if (!bytes || !per_byte) return std::nullopt;
    if (*bytes * *per_byte > limit.ns) limit = {*bytes * *per_byte, way};
  }
  if (!(limit.ns > 0)) return std::nullopt;  // nothing is done, which takes no time
  limit.times = *ns / limit.ns;
  return limit;
}

std::string machineText(const BenchResult& result) {
  std::string text;
  for (const Measurement& m : result.measured)
    if (m.subject == kMachine && m.what == kOperation)
      text +=
          fmt::format("{}{:.3g} GFLOP/s {}", text.empty() ? "one core: " : ", ", 1 / m.value, m.by);
  for (const char* way : {kMemoryRead, kMemoryWritten}) {
    std::string sizes;
    for (const auto& [size, m] : bySize(result, way))
      sizes += fmt::format("{}{:.3g} GB/s of {}", sizes.empty() ? "" : ", ", 1 / m->value, m->by);
    if (!sizes.empty()) text += fmt::format("; {} {}", way, sizes);
  }
  return text;
}

}  // namespace dynwitness::crosscheck
