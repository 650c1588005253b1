// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/cell.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/system/children.hpp"
#include "crosscheck/system/leaving.hpp"
#include "crosscheck/system/pipe.hpp"
#include "crosscheck/system/processes.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

/// Anybody but 0, for whom the capabilities end where a program is started.
constexpr int kUser = 1000;
const fs::path kTemporary = "/tmp", kName = "submission";

[[noreturn]] void fail(const std::string& what, int error) {
  throw std::runtime_error(fmt::format("{}: {}", what, std::strerror(error)));
}

/// In one piece, as the kernel wants its own files written.
void tellKernel(const char* file, const std::string& text) {
  const int out = open(file, O_WRONLY | O_CLOEXEC);
  const ssize_t written = out < 0 ? -1 : write(out, text.data(), text.size());
  const int error = errno;
  if (out >= 0) close(out);
  if (written != static_cast<ssize_t>(text.size())) fail(file, error);
}

/// Namespaces for what is forked from here on.
void leaveTheOthers() {
  const unsigned user = geteuid(), group = getegid();
  if (unshare(CLONE_NEWUSER | CLONE_NEWNS | CLONE_NEWPID | CLONE_NEWNET | CLONE_NEWIPC) != 0)
    fail("no namespaces", errno);
  tellKernel("/proc/self/setgroups", "deny");
  tellKernel("/proc/self/uid_map", fmt::format("{} {} 1", kUser, user));
  tellKernel("/proc/self/gid_map", fmt::format("{} {} 1", kUser, group));
}

void mounted(const char* what, const fs::path& where, const char* kind, unsigned long flags,
             const std::string& options = "") {
  if (mount(what, where.c_str(), kind, flags, options.empty() ? nullptr : options.c_str()) != 0)
    fail(fmt::format("cannot mount on {}", where.string()), errno);
}

/// A program that forks without end is stopped by who counts its processes, if that gets a turn.
void limitProcesses(int most) {
  rlimit before{};
  getrlimit(RLIMIT_NPROC, &before);
  const auto count = static_cast<rlim_t>(most);
  const rlimit now{std::min(count, before.rlim_cur), std::min(count, before.rlim_max)};
  const rlimit trial{now.rlim_cur, before.rlim_max};
  setrlimit(RLIMIT_NPROC, &trial);
  const pid_t copy = fork();
  if (copy == 0) _exit(0);
  if (copy > 0) waitpid(copy, nullptr, 0);
  // before Linux 5.14 all processes of the user count, of whatever namespace
  setrlimit(RLIMIT_NPROC, copy < 0 ? &before : &now);
  // root is not bound by that. Before Linux 6.14 this is the whole machine's, and not ours to set
  utsname kernel{};
  int major = 0, minor = 0;
  if (uname(&kernel) != 0 || std::sscanf(kernel.release, "%d.%d", &major, &minor) != 2 ||
      std::make_pair(major, minor) < std::make_pair(6, 14))
    return;
  constexpr int kLeast = 301;  // that the kernel takes
  try {
    tellKernel("/proc/sys/kernel/pid_max", std::to_string(std::max(most, kLeast)));
  } catch (const std::runtime_error&) {  // then who counts must do
  }
}

/// The first process of the namespaces makes them what the cell wants.
void furnish(const Cell& cell) {
  constexpr unsigned long kPlain = MS_NOSUID | MS_NODEV;
  mounted("none", "/", nullptr, MS_REC | MS_PRIVATE);
  mounted("proc", "/proc", "proc", kPlain | MS_NOEXEC);
  limitProcesses(cell.processes);
  std::vector<fs::path> hidden = cell.hidden;
  hidden.emplace_back("/run");
  std::error_code none;
  for (const fs::path& path : hidden)
    if (fs::is_directory(path, none))
      mounted("none", path, "tmpfs", kPlain, "size=4096,mode=755");
    else if (fs::exists(path, none))
      mounted("/dev/null", path, nullptr, MS_BIND);
  mount_attr read_only{};
  read_only.attr_set = MOUNT_ATTR_RDONLY;
  if (mount_setattr(AT_FDCWD, "/", AT_RECURSIVE, &read_only, sizeof read_only) != 0)
    fail("cannot make the disk read-only", errno);
  const std::string size =
      fmt::format("size={},mode=1777", static_cast<long long>(cell.gigabytes * 1e9));
  for (const fs::path& path : {kTemporary, fs::path("/var/tmp"), fs::path("/dev/shm")})
    if (path == kTemporary || fs::is_directory(path, none))
      mounted("none", path, "tmpfs", kPlain, size);
}

/// HOME, TMPDIR and what is to stay.
void setEnvironment(const Cell& cell, const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> kept;
  for (const std::string& name : cell.environment)
    if (const char* const value = std::getenv(name.c_str())) kept.emplace_back(name, value);
  clearenv();
  for (const auto& [name, value] : kept) setenv(name.c_str(), value.c_str(), 1);
  for (const char* name : {"HOME", "TMPDIR"}) setenv(name, folder.c_str(), 1);
}

/// Ends with its parent, whose number it may not be able to see.
void endWith(int parents_pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  pollfd file{parents_pipe, 0, 0};
  if (poll(&file, 1, 0) > 0) _exit(1);  // it has gone already
}

/// Whether this process has a namespace of processes below it, and nobody else's.
bool is_first_in_cell = false;

/// In the copy: "+" and what the work returned, or "-" and what was thrown.
std::string outcome(const Cell& cell, bool hides, const fs::path& folder,
                    const std::function<std::string(const fs::path&)>& work) {
  try {
    const rlimit none{0, 0},
        bytes{static_cast<rlim_t>(cell.gigabytes * 1e9), static_cast<rlim_t>(cell.gigabytes * 1e9)};
    setrlimit(RLIMIT_CORE, &none);
    setrlimit(RLIMIT_FSIZE, &bytes);
    if (hides) {
      tellKernel("/proc/self/oom_score_adj", "1000");  // rather than who started all this
      furnish(cell);
      is_first_in_cell = true;
    }
    fs::create_directory(folder);
    if (chdir(folder.c_str()) != 0) fail(folder.string(), errno);
    setEnvironment(cell, folder);
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    prctl(PR_SET_DUMPABLE, 0);  // nobody looks into this process
    return "+" + work(folder);
  } catch (const std::exception& error) {
    return std::string("-") + error.what();
  }
}

}  // namespace

std::string inCell(const Cell& cell, bool hides,
                   const std::function<std::string(const fs::path&)>& work) {
  std::optional<DraftFolder> draft;
  if (hides)
    leaveTheOthers();
  else
    draft.emplace(fs::temp_directory_path(), "dynwitness-cell");
  const fs::path folder = (draft ? draft->path() : kTemporary) / kName;
  Pipe answer, alive;
  if (!answer.isOpen() || !alive.isOpen()) fail("pipe", errno);
  pid_t copy;
  EndsWithUs ends_with_us;
  {
    const SignalsHeld held;
    copy = fork();
    if (copy == 0) {
      alive.closeEnd(1);
      answer.closeEnd(0);
      endWith(alive.ends[0]);
    } else if (copy > 0) {
      ends_with_us = EndsWithUs(copy, hides ? SIGKILL : SIGTERM);
    }
  }
  if (copy < 0) fail("fork", errno);
  if (copy == 0) {
    const std::string text = outcome(cell, hides, folder, work);
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t written = write(answer.ends[1], text.data() + at, text.size() - at);
      if (written < 0 && errno != EINTR) _exit(1);
      if (written > 0) at += static_cast<std::size_t>(written);
    }
    _exit(0);
  }
  answer.closeEnd(1);
  alive.closeEnd(0);
  std::string text;
  char buffer[1 << 16];
  for (ssize_t got; (got = read(answer.ends[0], buffer, sizeof buffer)) != 0;) {
    if (got < 0 && errno != EINTR) fail("read", errno);
    if (got > 0) text.append(buffer, static_cast<std::size_t>(got));
  }
  const int status = reap(copy);
  if (status != 0 || text.empty())
    throw std::runtime_error("the process that listened to it " + howItEnded(status));
  if (text[0] == '-') throw std::runtime_error(text.substr(1));
  return text.substr(1);
}

void endAllInCell() {
  if (!is_first_in_cell || getpid() != 1) return;  // of all that this process may kill
  do kill(-1, SIGKILL);
  while (waitpid(-1, nullptr, 0) > 0 || errno != ECHILD);
}

std::string whyNothingIsHidden() {
  constexpr double kPatience_s = 30;
  return triedInCopy(
      [] {
        const DraftFolder seen(fs::temp_directory_path(), "dynwitness-cell");
        const fs::path secret = fs::absolute(seen.path()) / "secret";
        std::ofstream(secret) << "secret";
        Cell cell;
        cell.hidden = {secret.parent_path()};
        return inCell(cell, true, [&](const fs::path&) -> std::string {
          if (fs::exists(secret)) return "what was hidden is still seen";
          if (getpid() != 1 || fs::read_symlink("/proc/self") != "1")
            return "other processes are still seen";
          return "";
        });
      },
      kPatience_s);
}

}  // namespace dynwitness::crosscheck
