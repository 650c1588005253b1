// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/check_motions.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace dynwitness::crosscheck {

PublishedMotion reenacted(const MotionTable& table, const scene::Scene& reported_in) {
  const SimulateOptions options = optionsFor(table);
  PublishedMotion motion;
  motion.title = table.title;
  motion.source = table.source;
  motion.own = table.own;
  motion.note = table.note;
  if (table.scene.file != reported_in.file) motion.moved = table.scene.file.filename().string();
  motion.method = options.method;
  motion.duration = options.duration;
  motion.step_error = options.step_error;
  try {
    const Simulation simulation = simulate(table.scene, options);
    motion.steps = simulation.steps;
    const MotionVerdict verdict = compareMotion(table.scene, simulation, table);
    motion.values = verdict.values;
    motion.ratio = verdict.ratio;
    for (const MotionVerdict::Entry& entry : verdict.entries) {
      const MotionTable::Column& column = table.columns[entry.column];
      motion.entries.push_back(
          {column.unit.empty() ? column.name : column.name + " [" + column.unit + "]", entry.time,
           entry.printed, entry.simulated, entry.difference(), entry.limit, entry.digits()});
    }
  } catch (const std::runtime_error& error) {
    motion.failure = error.what();
  }
  return motion;
}

std::vector<PublishedMotion> publishedMotions(const scene::Scene& scene) {
  std::vector<PublishedMotion> motions;
  for (const MotionTable& table : reportedMotionTables(scene))
    motions.push_back(reenacted(table, scene));
  return motions;
}

CheckResult checkMotion(const PublishedMotion& motion) {
  CheckResult check;
  check.law = "published motion";
  check.statement = fmt::format("{}: simulated {} s as {}", motion.title, motion.duration,
                                motion.own.empty() ? "printed" : "found by another road");
  check.quantity = "motion";
  check.left = "simulate";
  check.right = motion.own.empty() ? "published" : "reference";
  check.unit = Unit::kStatedAccuracy;
  check.states = motion.values;
  check.limit = 1;
  const PublishedMotion::Entry* closest = nullptr;
  for (const PublishedMotion::Entry& entry : motion.entries)
    if (closest == nullptr ||
        !(entry.difference / entry.limit <= closest->difference / closest->limit))
      closest = &entry;
  if (!motion.failure.empty() || closest == nullptr) {
    check.verdict = Verdict::kDisagree;
    check.ratio = check.worst = std::numeric_limits<double>::infinity();
    check.reason = motion.failure.empty() ? "no value was reached" : motion.failure;
    return check;
  }
  check.ratio = check.worst =
      std::isnan(motion.ratio) ? std::numeric_limits<double>::infinity() : motion.ratio;
  if (check.ratio <= 1) return check;
  check.verdict = Verdict::kDisagree;
  check.reason =
      fmt::format("{}: {} at t = {} s is {:.15g}, simulated {:.15g}, {:.2g} away, limit {:.2g}",
                  motion.title, closest->of, closest->time, closest->published, closest->ours,
                  closest->difference, closest->limit);
  return check;
}

}  // namespace dynwitness::crosscheck
