// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/standard_files.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "crosscheck/cli/speech.hpp"

namespace dynwitness::cli {

void occupyStandardFiles() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(file, F_GETFD) < 0 && errno == EBADF)
      // the lowest number that is free is this one; opened the other way round, it refuses as
      // before
      if (open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
}

void tell(std::string_view text) noexcept {
  if (!speech().quiet) tellFailure(text);
}

void tellFailure(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void requireOutputWritten() {
  errno = 0;
  const bool written = std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  const int error = errno;
  if (!written)
    throw std::runtime_error(fmt::format("standard output could not be written{}{}",
                                         error ? ": " : "", error ? std::strerror(error) : ""));
  // closed before we began (then it is read-only here): nobody wants to hear
  const bool is_open = (fcntl(STDERR_FILENO, F_GETFL) & O_ACCMODE) != O_RDONLY;
  if (is_open && (!std::cerr.flush() || std::ferror(stderr)))
    throw std::runtime_error("standard error could not be written: something was not told");
}

}  // namespace dynwitness::cli
