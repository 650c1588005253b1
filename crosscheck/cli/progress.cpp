// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/progress.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace dynwitness::cli {

Progress::Progress(int stages, double quiet_s)
    : stages_(stages),
      terminal_(isatty(STDERR_FILENO) != 0),
      shown_from_(std::chrono::steady_clock::now() +
                  std::chrono::milliseconds(static_cast<long>(1000 * quiet_s))) {}

Progress::~Progress() {
  if (terminal_ && shown_) fmt::print(stderr, "\r\033[K");  // the results take the bar's place
}

void Progress::stage(const std::string& what) {
  ++begun_;
  if (std::chrono::steady_clock::now() < shown_from_) return;
  shown_ = true;
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
