// SPDX-License-Identifier: GPL-3.0-or-later
// Both ends of a pipe, closed when nobody needs them any more.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace dynwitness::crosscheck {

/// End 0 is read from, end 1 written to; programs that are started do not inherit them.
struct Pipe {
  int ends[2] = {-1, -1};  ///< -1: closed, or there was no pipe to be had (errno)

  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) ends[0] = ends[1] = -1;
  }
  ~Pipe() { closeEnd(0), closeEnd(1); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  bool isOpen() const { return ends[0] >= 0; }
  void closeEnd(int i) {
    if (ends[i] >= 0) close(ends[i]);
    ends[i] = -1;
  }
  /// Hands this end over, to be closed by somebody else.
  int take(int i) { return std::exchange(ends[i], -1); }
};

}  // namespace dynwitness::crosscheck
