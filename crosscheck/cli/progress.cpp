// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/progress.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace dynwitness::cli {

Progress::Progress(int stages) : stages_(stages), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (terminal_ && begun_ > 0) fmt::print(stderr, "\r\033[K");  // the results take the bar's place
}

void Progress::stage(const std::string& what) {
  ++begun_;
  if (!terminal_) {
    fmt::print(stderr, "[{}/{}] {}\n", begun_, stages_, what);
    return;
  }
  constexpr int kWidth = 24;
  const int filled = kWidth * (begun_ - 1) / stages_;
  fmt::print(stderr, "\r\033[K[{}{}] {}/{} {}", std::string(filled, '#'),
             std::string(kWidth - filled, '.'), begun_, stages_, what);
  std::fflush(stderr);
}

}  // namespace dynwitness::cli
