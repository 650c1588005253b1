// SPDX-License-Identifier: GPL-3.0-or-later
// Progress on standard error: a bar on a terminal, lines otherwise, JSON where that is asked for
// (speech.hpp); what is left of the work, and when it ends.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "crosscheck/cli/speech.hpp"
#include "scene/work.hpp"

namespace dynwitness::cli {

/** Tells how long work takes, from a second after its begin. On a terminal a bar that moves;
    otherwise a line when an estimate can be made, and one at most every 30 s. The estimate is the
    time that went by over the share that is done, as the work itself counts it (scene::Work).
    As JSON a line at the begin, at each stage and once a second. */
class Progress {
 public:
  /// Work without stages, under this name.
  explicit Progress(const std::string& name);
  /// Work in stages: where there is no terminal, each begins with a line.
  /// @param quiet_s  nothing is shown in the first seconds: for work that is mostly short
  /// @param counts   stages are units of about equal cost; otherwise the caller counts its work
  explicit Progress(int stages, double quiet_s = 0, bool counts = true);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void stage(const std::string& what);  ///< begins the next of the stages
  /// What is told beside: "120000 rows, 41000 a second".
  void note(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;
  void startWatching();
  void watch();
  std::string status() const;  ///< "12 %, about 40 s left, M"; needs the lock
  std::string json() const;    ///< progress.schema.json; needs the lock
  void watchAsJson(std::unique_lock<std::mutex>& hold);
  void show(const std::string& line);

  std::unique_ptr<scene::Work> work_;
  std::string name_, note_, stage_;
  const ProgressAs as_ = speech().progressAs();
  int stages_ = 0, begun_ = 0;
  bool terminal_, shown_ = false, over_ = false;
  Clock::time_point begin_, shown_from_;
  mutable std::mutex lock_;
  std::condition_variable ended_;
  std::thread watcher_;
};

/// "40 s", "3.5 min", "7 h", "12 days"
std::string duration(double seconds);

}  // namespace dynwitness::cli
