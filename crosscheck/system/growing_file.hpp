// SPDX-License-Identifier: GPL-3.0-or-later
// A file that is written piece by piece and is there only when it is whole.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>

namespace dynwitness::crosscheck {

/** Pieces go to a file beside the one that is meant, which they replace at the end; without a name
    they go to standard output as they come. */
class GrowingFile {
 public:
  /// @param file  empty: standard output
  explicit GrowingFile(const std::filesystem::path& file);
  ~GrowingFile();  ///< takes back what is not finished
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// @throws std::runtime_error  the system's reason, such as a full disk
  void write(std::string_view piece);
  /// Standard output has what was written.
  void flush();
  /// Puts the file into place. @throws std::runtime_error  as write() does
  void finish();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_, unfinished_;
  std::FILE* stream_;
};

}  // namespace dynwitness::crosscheck
