// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "scene/error.hpp"

namespace dynwitness::scene {
namespace {

const char* whatItIs(mode_t mode) {
  if (S_ISDIR(mode)) return "is a folder";
  if (S_ISFIFO(mode)) return "is a FIFO";
  if (S_ISSOCK(mode)) return "is a socket";
  return "is a device";
}

struct Descriptor {
  int number;
  ~Descriptor() { close(number); }
};

}  // namespace

bool looksLikeXml(const std::string& text) {
  const std::size_t start = text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;  // byte order mark
  const std::size_t first = text.find_first_not_of(" \t\r\n", start);
  return first != std::string::npos && text[first] == '<';
}

int openRegularFile(const std::filesystem::path& file, const std::string& allowed) {
  const auto refuse = [&](const std::string& what) {
    throw InputError({file.string(), 0}, what + ", allowed: " + allowed);
  };
  // looked at first, because opening a device may do something; and again once it is open, because
  // names can be given to other files in between
  struct stat status;
  if (stat(file.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    refuse(whatItIs(status.st_mode));
  const int descriptor = open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) refuse("cannot be read: " + std::string(std::strerror(errno)));
  if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) return descriptor;
  close(descriptor);
  refuse(whatItIs(status.st_mode));
  return -1;
}

std::string readTextFile(const std::filesystem::path& file, const std::string& allowed) {
  const Descriptor opened{openRegularFile(file, allowed)};
  std::string text;
  char buffer[1 << 16];
  while (text.size() <= kMostTextBytes) {  // counted while reading: a file can grow
    const ssize_t got = read(opened.number, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw InputError({file.string(), 0}, "cannot be read: " + std::string(std::strerror(errno)));
    if (got == 0) break;
    text.append(buffer, static_cast<std::size_t>(got));
  }
  if (text.size() > kMostTextBytes)
    throw InputError({file.string(), 0}, "is longer than " + std::to_string(kMostTextBytes >> 20) +
                                             " MiB, allowed: " + allowed + " of at most that");
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(zero);
    throw InputError({file.string(), 1 + static_cast<int>(std::count(text.begin(), end, '\n'))},
                     "has a zero byte, allowed: " + allowed);
  }
  return text;
}

}  // namespace dynwitness::scene
