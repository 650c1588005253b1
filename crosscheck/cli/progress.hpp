// SPDX-License-Identifier: GPL-3.0-or-later
// Progress on standard error: a bar on a terminal, one line a stage otherwise.
#pragma once

#include <string>

namespace dynwitness::cli {

class Progress {
 public:
  explicit Progress(int stages);
  ~Progress();
  void stage(const std::string& what);  ///< begins the next of the stages

 private:
  int stages_, begun_ = 0;
  bool terminal_;
};

}  // namespace dynwitness::cli
