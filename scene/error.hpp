// SPDX-License-Identifier: GPL-3.0-or-later
// The one way in which dynwitness says that what it was given is wrong.
#pragma once

#include <stdexcept>
#include <string>

namespace dynwitness::scene {

/// Where a piece of input was read. line 0: the file as a whole.
struct SourceLocation {
  std::string file;
  int line = 0;

  /// "file:line" (or "file" alone when the line is unknown), as compilers print it.
  std::string text() const { return line > 0 ? file + ":" + std::to_string(line) : file; }
};

/// Bad input: the message starts with `file:line: ` and says what was read and what is allowed.
/// The command line answers it with exit status 2.
class InputError : public std::runtime_error {
 public:
  InputError(const SourceLocation& where, const std::string& what)
      : std::runtime_error(where.file.empty() ? what : where.text() + ": " + what) {}
};

}  // namespace dynwitness::scene
