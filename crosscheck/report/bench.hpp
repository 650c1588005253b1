// SPDX-License-Identifier: GPL-3.0-or-later
// What `./dynwitness bench` measured, the goals that it is held to, and the file that keeps both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/system/environment.hpp"

namespace dynwitness::crosscheck {

// what is timed of every scene: the time of one evaluation in "ns", cosines and sines included
inline constexpr const char* kTimed[] = {"ID", "M", "FD"};
// the engines that ratios are taken to, called as their users call them, no witness around them
inline constexpr const char *kRawMujoco = "mujoco_raw", *kRawSimbody = "simbody_raw";
// whole steps of time, timed as well: semi-implicit Euler's, the classical Runge and Kutta's
inline constexpr const char *kStep = "step", *kRungeKuttaStep = "RK4 step",
                            *kSteps[] = {kStep, kRungeKuttaStep};
/// Units of goals that are ratios: MuJoCo's time over ours, that of the fastest engine over ours,
/// both of this run.
inline constexpr const char *kTimesMujoco = "times MuJoCo", *kTimesBest = "times the best engine";

/// What the machine itself does, measured in the same run: nanoseconds an operation, by kind of
/// instruction, and a byte, by size of an array ("16 KiB").
inline constexpr const char *kMachine = "machine", *kOperation = "operation",
                            *kMemoryRead = "reading", *kMemoryWritten = "writing";
// what a contender does for one state; the last: what lies there in all, of all states
inline constexpr const char *kOperationsWithSines = "operations with sines",
                            *kBytesRead = "bytes read", *kBytesWritten = "bytes written",
                            *kBytesAtHand = "bytes at hand";

/// Who computes.
struct Contender {
  std::string name;   ///< "fast", "kernel_second", "mujoco_raw"
  std::string label;  ///< for readers: "fast sweeps, g++ 12"
  bool is_ours = false;
};

/// One number: what ("ID", "derivation"), of which scene, by which contender.
struct Measurement {
  std::string what, subject, by, unit;
  double value = 0;

  bool isTime() const;  ///< of kTimed
  bool isStep() const;  ///< the time of one of kSteps
};

struct Goal {
  int number = 0;  ///< goals of one number belong together
  std::string what, subject, by, unit;
  double wanted = 0;
  bool at_least = false;  ///< else: at most
};

struct BenchResult {
  Environment environment;
  int processors = 0;  ///< that the run could use
  double load = 0;     ///< of the machine over the minute before [processes]
  int states = 0;      ///< that are cycled through
  std::uint64_t seed = 0;
  int repetitions = 0;  ///< of which the fastest counts
  std::vector<Contender> contenders;
  std::vector<Measurement> measured;
  std::vector<Goal> goals;
  std::vector<std::string> left_out;  ///< what could not be measured here, and why

  /// A time of kTimed that was measured [ns], or another number.
  std::optional<double> value(const std::string& what, const std::string& subject,
                              const std::string& by, const std::string& unit) const;
  /// How many times faster than an engine, of a time of kTimed; nothing when either is missing.
  std::optional<double> timesFaster(const std::string& engine, const std::string& what,
                                    const std::string& subject, const std::string& by) const;
  /// Than the fastest contender that is not ours.
  std::optional<double> timesFasterThanEngines(const std::string& what, const std::string& subject,
                                               const std::string& by) const;
  std::string label(const std::string& contender) const;
  /// The least that was measured of the machine [ns].
  std::optional<double> perOperation() const;
};

/** What the machine's peak leaves of a contender's time: whichever takes longer, its operations or
    its bytes in or out, each alone and at the best that this run saw of one core. */
struct Limit {
  double ns = 0;
  const char* of = "";  ///< "operations", "reading", "writing"
  double times = 0;     ///< so many times as long it takes
};
/// Nothing where the time, the operations or the machine was not measured.
std::optional<Limit> limitOf(const BenchResult& result, const std::string& what,
                             const std::string& subject, const std::string& by);
/// The machine in one line; empty: it was not measured.
std::string machineText(const BenchResult& result);

struct GoalVerdict {
  std::optional<double> measured;  ///< in the goal's unit; nothing: it was not
  std::optional<double> times_simbody;
  std::optional<Limit> limit;
  bool is_reached = false;
  /// How much more time (or memory, or operations) it takes than the goal grants [%]; 0 when
  /// reached.
  double missed_by = 0;

  /// "reached", "missed", "not measured"
  const char* word() const;
};
GoalVerdict judge(const BenchResult& result, const Goal& goal);

/// Follows bench.schema.json: what was measured, and the ratios and verdicts that follow from it.
std::string benchJson(const BenchResult& result);

/** Reads what benchJson() wrote.
    @throws scene::InputError  the file cannot be read, is no such file, or its ratios and verdicts
                               do not follow from its measurements; with the place in it */
BenchResult readBench(const std::filesystem::path& file);

/// `scene,formula,contender,time_ns,times_mujoco,times_simbody,goal_ns`, under `#` lines.
std::string benchCsv(const BenchResult& result);

/** Draws bench.svg from bench.csv beside it: a row of panels a scene, a panel a
    formula, a line a contender. Empty when no time was measured.
    @param style  the path of style.gp, as seen from the script's folder */
std::string benchScript(const BenchResult& result, const std::string& style);

/// The tables for a terminal: times, other numbers, goals.
std::string benchText(const BenchResult& result);

/// What the section of the report links to, relative to the page.
struct BenchFiles {
  std::string csv, script, picture;  ///< picture: svg; empty: left out, see below
  std::string no_plot_reason;
};

/// The section "Speed" of the report.
std::string benchSection(const BenchResult& result, const BenchFiles& files);

}  // namespace dynwitness::crosscheck
