// SPDX-License-Identifier: GPL-3.0-or-later
// Progress on standard error: a bar on a terminal, one line a stage otherwise.
#pragma once

#include <chrono>
#include <string>

namespace dynwitness::cli {

class Progress {
 public:
  /// @param quiet_s  nothing is shown in the first seconds: for work that is mostly short
  explicit Progress(int stages, double quiet_s = 0);
  ~Progress();
  void stage(const std::string& what);  ///< begins the next of the stages

 private:
  int stages_, begun_ = 0;
  bool terminal_, shown_ = false;
  std::chrono::steady_clock::time_point shown_from_;
};

}  // namespace dynwitness::cli
