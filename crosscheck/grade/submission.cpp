// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/grade/submission.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/system/environment.hpp"
#include "crosscheck/system/hash.hpp"
#include "crosscheck/system/shell.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

/// A folder of sources is far below; one with somebody's whole disk is not read.
constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;
constexpr std::size_t kMostFiles = 10'000;

[[noreturn]] void cannotRead(const fs::path& file, int error) {
  throw std::runtime_error(
      fmt::format("{}: cannot be read: {}", file.string(), std::strerror(error)));
}

/// The bytes of a regular file; a link in its place is not followed, and nothing is waited for.
std::string bytesOf(const fs::path& file, bool& is_executable) {
  const int in = open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (in < 0) cannotRead(file, errno);
  struct stat about {};
  int error = fstat(in, &about) == 0 ? 0 : errno;
  if (error == 0 && !S_ISREG(about.st_mode)) error = EINVAL;
  is_executable = (about.st_mode & S_IXUSR) != 0;
  std::string out;
  char buffer[1 << 16];
  for (ssize_t got; error == 0 && (got = read(in, buffer, sizeof buffer)) != 0;) {
    if (got < 0 && errno != EINTR) error = errno;
    if (got > 0) out.append(buffer, static_cast<std::size_t>(got));
    if (out.size() > kMostBytes) break;
  }
  close(in);
  if (error != 0) cannotRead(file, error);
  return out;
}

class Reader {
 public:
  Reader(Submission& out, const fs::path& root) : out_(out), root_(root) {}

  /// @return false: there is too much of it
  bool add(const fs::path& relative) {
    const fs::path file = relative.empty() ? root_ : root_ / relative;
    struct stat about {};
    if (lstat(file.c_str(), &about) != 0) cannotRead(file, errno);
    if (S_ISDIR(about.st_mode)) {
      std::vector<fs::path> names;
      std::error_code error;
      for (fs::directory_iterator entry(file, error), end; !error && entry != end;
           entry.increment(error)) {
        names.push_back(entry->path().filename());
        if (names.size() > kMostFiles) return tooMuch();
      }
      if (error) cannotRead(file, error.value());
      std::sort(names.begin(), names.end());
      return std::all_of(names.begin(), names.end(),
                         [&](const fs::path& name) { return add(relative / name); });
    }
    if (!S_ISREG(about.st_mode)) {
      out_.remarks.push_back(fmt::format("left out, being no file: {}",
                                         relative.empty() ? out_.name : relative.string()));
      return out_.remarks.size() <= kMostFiles || tooMuch();
    }
    if (static_cast<std::uintmax_t>(about.st_size) > kMostBytes) return tooMuch();
    Submission::File one;
    one.path = relative.empty() ? fs::path(out_.name) : relative;
    one.bytes = bytesOf(file, one.is_executable);
    bytes_ += one.bytes.size();
    out_.files.push_back(std::move(one));
    return (bytes_ <= kMostBytes && out_.files.size() <= kMostFiles) || tooMuch();
  }

 private:
  bool tooMuch() {
    out_.problem = fmt::format("it has more than {} MiB or {} files", kMostBytes >> 20, kMostFiles);
    out_.files.clear();
    out_.remarks.clear();
    return false;
  }

  Submission& out_;
  fs::path root_;
  std::uintmax_t bytes_ = 0;
};

}  // namespace

std::vector<std::string> submissionsIn(const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::string name = entry->path().filename().string();
    if (name[0] != '.') names.push_back(std::move(name));
  }
  if (error)
    throw scene::InputError({folder.string()},
                            fmt::format("cannot be read: {}, allowed: a folder with one submission "
                                        "a file or sub-folder",
                                        error.message()));
  if (names.empty())
    throw scene::InputError({folder.string()},
                            "is empty, allowed: a folder with one submission a file or sub-folder");
  std::sort(names.begin(), names.end());
  return names;
}

Submission readSubmission(const fs::path& folder, const std::string& name, const Rubric& rubric) {
  Submission out;
  out.name = name;
  const fs::path path = folder / name;
  if (!Reader(out, path).add("")) return out;
  if (out.files.empty()) {
    out.problem = "there is no file in it";
  } else if (!fs::is_directory(path)) {
    out.start = name;
  } else if (rubric.main.empty()) {
    out.start = out.files.front().path.string();
    if (out.files.size() > 1)
      out.problem = fmt::format("there are {} files in it, expected one, as the rubric has no main",
                                out.files.size());
  } else {
    out.start = rubric.main;
    const bool is_there =
        std::any_of(out.files.begin(), out.files.end(),
                    [&](const Submission::File& file) { return file.path == rubric.main; });
    if (!is_there && out.files.size() == 1)
      out.start = out.files.front().path.string();
    else if (!is_there)
      out.problem = fmt::format("there is no {} in it, which the rubric starts", rubric.main);
  }
  return out;
}

std::string keyOf(const Submission& submission, const Rubric& rubric) {
  static const Environment here = thisEnvironment({}, "not asked");
  std::string all = fmt::format("{} {}\n{}\n{} {} {}\n", here.version, here.commit, rubric.runKey(),
                                submission.name, submission.start, submission.problem);
  for (const Submission::File& file : submission.files)
    all += fmt::format("{} {} {}\n", file.path.string(), file.bytes.size(), file.is_executable) +
           file.bytes;
  return hashOf(all);
}

void layOut(const Submission& submission, const Rubric& rubric, const fs::path& folder) {
  const auto put = [&](const fs::path& relative, const std::string& bytes, bool is_executable) {
    const fs::path file = folder / relative;
    fs::create_directories(file.parent_path());
    const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                         is_executable ? 0700 : 0600);
    std::size_t at = 0;
    for (ssize_t written; out >= 0 && at < bytes.size(); at += static_cast<std::size_t>(written))
      if ((written = write(out, bytes.data() + at, bytes.size() - at)) < 0) break;
    const int error = errno;
    if (out >= 0) close(out);
    if (out < 0 || at < bytes.size())
      throw std::runtime_error(
          fmt::format("{}: cannot be written: {}", file.string(), std::strerror(error)));
  };
  for (const Submission::File& file : submission.files)
    put(file.path, file.bytes, file.is_executable);
  for (const auto& [name, bytes] : rubric.files)
    if (!fs::exists(folder / name)) put(name, bytes, false);
}

std::string commandFor(const Submission& submission, std::string words) {
  const std::string place = "{file}", file = shellWord("./" + submission.start);
  for (std::size_t at = 0; (at = words.find(place, at)) != std::string::npos; at += file.size())
    words.replace(at, place.size(), file);
  return words;
}

}  // namespace dynwitness::crosscheck
