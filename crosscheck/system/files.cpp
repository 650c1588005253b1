// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

/// Lists the files of the last report in a folder, one a line: only these are ours to replace.
constexpr const char* kContents = "contents.txt";
constexpr const char* kContentsHeading =
    "# Written by dynwitness. A later report replaces these files and leaves all others alone.\n";

/// "a/b/" and "a/./b" are "a/b"; "." stays.
fs::path tidy(const fs::path& folder) {
  fs::path path = folder.lexically_normal();
  if (!path.has_filename() && path.has_relative_path()) path = path.parent_path();
  return path;
}

[[noreturn]] void fail(const fs::path& file, const char* verb, int error) {
  throw std::runtime_error(fmt::format("{}: cannot {}: {}", file.string(), verb,
                                       error != 0 ? std::strerror(error) : "unknown reason"));
}

[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
  throw scene::InputError({file.string(), 0}, what);
}

void writeText(const fs::path& file, std::string_view text) {
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  if (stream == nullptr) fail(file, "write", errno);
  errno = 0;
  bool whole = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  int error = errno;
  // a full disk may show only when the buffer is flushed
  if (std::fclose(stream) != 0) {
    whole = false;
    if (error == 0) error = errno;
  }
  if (!whole) {
    std::remove(file.c_str());
    fail(file, "write", error);
  }
}

void moveTo(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail(to, "put into place", error.value());
}

/// A path of the contents list stays inside the folder.
bool staysInside(const fs::path& relative) {
  if (relative.empty() || relative.is_absolute()) return false;
  return std::none_of(relative.begin(), relative.end(),
                      [](const fs::path& part) { return part == ".." || part == "."; });
}

/// The files of an earlier report, as its contents.txt lists them.
std::set<fs::path> ownFiles(const fs::path& folder) {
  std::set<fs::path> files;
  std::ifstream contents(folder / kContents);
  std::string line;
  // somebody else's contents.txt lists nothing of ours
  if (!std::getline(contents, line) || line + "\n" != kContentsHeading) return files;
  files.insert(kContents);
  while (std::getline(contents, line))
    if (!line.empty() && line.front() != '#' && staysInside(line)) files.insert(line);
  return files;
}

void writeContents(const fs::path& folder, const std::set<fs::path>& files) {
  std::string text = kContentsHeading;
  for (const fs::path& file : files)
    if (file != kContents) text += file.generic_string() + "\n";
  writeWholeFile(folder / kContents, text);
}

/// Refuses when `relative` is in the folder and not ours.
void requireOurs(const fs::path& folder, const fs::path& relative, const std::set<fs::path>& ours) {
  const fs::file_status status = fs::symlink_status(folder / relative);
  if (!fs::exists(status) || ours.count(relative) > 0) return;
  refuse(folder / relative,
         "is in the way, and the last report here did not write it; "
         "choose another folder for the report, or move this aside");
}

fs::path nearestExisting(fs::path path) {
  path = fs::absolute(path);
  while (!fs::exists(fs::symlink_status(path)) && path.has_relative_path())
    path = path.parent_path();
  return path;
}

/// Whether a folder holds nothing but these files.
bool holdsOnly(const fs::path& folder, const std::set<fs::path>& files) {
  const auto is_ours = [&](const fs::directory_entry& entry) {
    return entry.symlink_status().type() == fs::file_type::directory ||
           files.count(entry.path().lexically_relative(folder)) > 0;
  };
  return std::all_of(fs::recursive_directory_iterator(folder), fs::recursive_directory_iterator(),
                     is_ours);
}

/// Whether `path` is `folder` or lies in it.
bool isInside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

/// Whether files can be renamed from one folder to the other, as far as the kernel says.
bool sameMount(const fs::path& a, const fs::path& b) {
  struct statx here, there;
  return statx(AT_FDCWD, a.c_str(), 0, STATX_MNT_ID, &here) == 0 &&
         statx(AT_FDCWD, b.c_str(), 0, STATX_MNT_ID, &there) == 0 &&
         (here.stx_mask & there.stx_mask & STATX_MNT_ID) && here.stx_mnt_id == there.stx_mnt_id;
}

constexpr const char* kUnfinished = "unfinished";

/// Where "-" is written: standard output as it was when that was asked for; -1: nobody did.
int kept_output = -1;

void keepStandardOutput() {
  if (kept_output >= 0) return;
  std::fflush(stdout);
  kept_output = ::dup(STDOUT_FILENO);
  if (kept_output < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    throw std::runtime_error(fmt::format("standard output: {}", std::strerror(errno)));
}

void writeToStandardOutput(std::string_view text) {
  const int output = kept_output >= 0 ? kept_output : STDOUT_FILENO;
  while (!text.empty()) {
    const ssize_t size = ::write(output, text.data(), text.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0)
      throw std::runtime_error(fmt::format("standard output: {}", std::strerror(errno)));
    text.remove_prefix(static_cast<std::size_t>(size));
  }
}

}  // namespace

void writeWholeFile(const fs::path& file, std::string_view text) {
  if (file == kStandardOutput) return writeToStandardOutput(text);
  const std::string prefix = fmt::format("{}.{}-", file.filename().string(), kUnfinished);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  sweepLeftovers(folder, prefix);
  const fs::path unfinished = folder / (prefix + std::to_string(::getpid()));
  const RemovedWithUs removed(unfinished);
  try {
    writeText(unfinished, text);
    moveTo(unfinished, file);
  } catch (...) {
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw;
  }
}

void requireWritableFile(const fs::path& file) {
  if (file.empty()) return;
  if (file == kStandardOutput) return keepStandardOutput();
  try {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    if (!fs::is_directory(folder))
      refuse(file, fmt::format("cannot be written: there is no folder {}", folder.string()));
    // a file is replaced by renaming another to its name, which would do away with a device
    if (!file.has_filename() || (fs::exists(file) && !fs::is_regular_file(file)))
      refuse(file, "cannot be written: expected the name of a file, new or to be replaced");
    DraftFolder(folder, ".dynwitness-try");
  } catch (const scene::InputError&) {
    throw;
  } catch (const std::exception& e) {
    refuse(file, fmt::format("cannot be written ({})", e.what()));
  }
}

void requireWritableFolder(const fs::path& given) {
  if (given.empty()) refuse("output folder", "expected a folder, got an empty name");
  try {
    const fs::path existing = nearestExisting(tidy(given));
    if (!fs::is_directory(existing))
      refuse(given,
             fmt::format("cannot be a folder to write to: {} is not a folder", existing.string()));
    // asking the system to do it is the only answer that holds for root and read-only disks too
    DraftFolder(existing, ".dynwitness-try");
  } catch (const scene::InputError&) {
    throw;
  } catch (const std::exception& e) {
    refuse(given, fmt::format("cannot be written to ({})", e.what()));
  }
}

void requireWritable(const fs::path& given) {
  requireWritableFolder(given);
  const fs::path folder = tidy(given);
  if (!fs::exists(folder)) return;
  const std::set<fs::path> ours = ownFiles(folder);
  for (const char* file : {"index.html", "report.json", "junit.xml", "digits.md", kContents})
    requireOurs(folder, file, ours);
  if (fs::exists(folder / "scenes") && !fs::is_directory(folder / "scenes"))
    refuse(folder / "scenes", "is in the way: the report has a folder of this name");
}

UnfinishedFolder::UnfinishedFolder(const fs::path& folder) : folder_(tidy(folder)) {
  existed_ = fs::is_directory(folder_);
  if (existed_) folder_ = fs::canonical(folder_);
  const fs::path absolute = fs::absolute(folder_), parent = absolute.parent_path();
  for (fs::path p = parent; !fs::exists(p); p = p.parent_path()) first_created_ = p;
  fs::create_directories(parent);
  if (existed_) sweepLeftovers(folder_, fmt::format(".{}-", kUnfinished));
  try {
    draft_.emplace(parent, fmt::format(".{}-{}", absolute.filename().string(), kUnfinished));
    if (!existed_ || sameMount(path(), folder_)) return;
  } catch (const std::runtime_error&) {
    if (!existed_) throw;
  }
  // inside: the same disk even when the folder is a mount point
  draft_.emplace(folder_, fmt::format(".{}", kUnfinished));
}

UnfinishedFolder::~UnfinishedFolder() {
  draft_.reset();
  if (moved_ || first_created_.empty()) return;
  // take back the parent folders that we made, as long as they are empty
  std::error_code ignored;
  for (fs::path p = fs::absolute(folder_).parent_path();; p = p.parent_path()) {
    if (!fs::remove(p, ignored) || p == first_created_) break;
  }
}

void UnfinishedFolder::write(const fs::path& relative, std::string_view text) const {
  const fs::path file = path() / relative;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) fail(file.parent_path(), "create", error.value());
  writeText(file, text);
}

bool UnfinishedFolder::exchange() {
  if (path().parent_path() != folder_.parent_path() || isInside(fs::current_path(), folder_))
    return false;
  struct stat there;
  if (stat(folder_.c_str(), &there) != 0 || there.st_uid != geteuid()) return false;
  chmod(path().c_str(), there.st_mode & 07777);
  return renameat2(AT_FDCWD, path().c_str(), AT_FDCWD, folder_.c_str(), RENAME_EXCHANGE) == 0;
}

void UnfinishedFolder::moveIntoPlace(const fs::path& last) {
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path()))
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(path()));

  if (!existed_) {
    writeContents(path(), files);
    moveTo(path(), folder_);
    moved_ = true;
    return;
  }

  const std::set<fs::path> before = ownFiles(folder_);
  for (const fs::path& file : files) requireOurs(folder_, file, before);
  requireOurs(folder_, kContents, before);

  if (holdsOnly(folder_, before)) {
    writeContents(path(), files);
    if (exchange()) {
      moved_ = true;
      return;  // what was the earlier report is the draft now, and goes with it
    }
    fs::remove(path() / kContents);
  }

  const SignalsHeld held;
  // cut off half-way, the list still names everything that is ours
  std::set<fs::path> both = before;
  both.insert(files.begin(), files.end());
  writeContents(folder_, both);

  std::vector<fs::path> order(files.begin(), files.end());
  std::stable_partition(order.begin(), order.end(), [&](const fs::path& f) { return f != last; });
  for (const fs::path& file : order) {
    std::error_code error;
    fs::create_directories((folder_ / file).parent_path(), error);
    if (error) fail((folder_ / file).parent_path(), "create", error.value());
    moveTo(path() / file, folder_ / file);
  }

  // what only the earlier report had, and the folders that this leaves empty
  for (const fs::path& file : before) {
    if (files.count(file) > 0 || file == kContents) continue;
    std::error_code ignored;
    fs::remove(folder_ / file, ignored);
    for (fs::path p = file.parent_path(); !p.empty(); p = p.parent_path())
      if (!fs::remove(folder_ / p, ignored)) break;
  }
  writeContents(folder_, files);
  moved_ = true;
}

}  // namespace dynwitness::crosscheck
