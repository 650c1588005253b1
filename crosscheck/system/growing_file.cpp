// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/growing_file.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace dynwitness::crosscheck {

GrowingFile::GrowingFile(const std::filesystem::path& file) : file_(file), stream_(stdout) {
  if (file_.empty()) return;
  unfinished_ = file_.string() + fmt::format(".unfinished-{}", ::getpid());
  stream_ = std::fopen(unfinished_.c_str(), "wb");
  if (stream_ == nullptr) fail(errno);
}

GrowingFile::~GrowingFile() {
  if (unfinished_.empty()) return;
  if (stream_ != nullptr) std::fclose(stream_);
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
}

void GrowingFile::write(std::string_view piece) {
  errno = 0;
  if (std::fwrite(piece.data(), 1, piece.size(), stream_) != piece.size()) fail(errno);
}

void GrowingFile::flush() {
  errno = 0;
  if (unfinished_.empty() && std::fflush(stream_) != 0) fail(errno);
}

void GrowingFile::finish() {
  if (unfinished_.empty()) return flush();
  errno = 0;
  const bool whole = std::fclose(stream_) == 0;  // a full disk may show only here
  stream_ = nullptr;
  if (!whole) fail(errno);
  std::error_code error;
  std::filesystem::rename(unfinished_, file_, error);
  if (error) fail(error.value());
  unfinished_.clear();
}

void GrowingFile::fail(int error) const {
  throw std::runtime_error(fmt::format("{}: cannot write: {}",
                                       file_.empty() ? "standard output" : file_.string(),
                                       error != 0 ? std::strerror(error) : "unknown reason"));
}

}  // namespace dynwitness::crosscheck
