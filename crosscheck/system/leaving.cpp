// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/leaving.hpp"

#include <fcntl.h>
#include <limits.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

constexpr int kEnding[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU, SIGABRT};

// ---- what the handler reads: plain memory, each entry valid while its owner is not 0
struct ChildSlot {
  std::atomic<pid_t> owner{0};
  pid_t target = 0;
  int signal = 0;
};
struct PathSlot {
  std::atomic<pid_t> owner{0};
  char path[PATH_MAX] = {};
};
std::array<ChildSlot, 1200> children;  // --processes allows 1024
std::array<PathSlot, 32> paths;
bool is_copy = false;

constexpr pid_t kBeingFilled = -1;

/// A free slot, filled before the handler sees it. -1: none
template <typename Slots, typename Fill>
int take(Slots& slots, const Fill& fill) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    pid_t owner = slots[i].owner.load();
    // one of the process that this one was copied from is free as well; kBeingFilled is another
    // thread's
    if (owner == getpid() || owner == kBeingFilled ||
        !slots[i].owner.compare_exchange_strong(owner, kBeingFilled))
      continue;
    fill(slots[i]);
    slots[i].owner = getpid();
    return static_cast<int>(i);
  }
  return -1;
}

// ---- the handler: calls that are safe there alone (signal-safety(7), and getdents64, which is a
// system call)

/// What getdents64 writes.
struct Entry {
  std::uint64_t inode;
  std::int64_t offset;
  unsigned short size;
  unsigned char kind;
  char name[1];
};

void removeTree(int folder, const char* name, int depth) {
  if (unlinkat(folder, name, 0) == 0 || depth == 0) return;
  const int file = openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return;
  alignas(Entry) char buffer[4096];
  for (bool found = true; found;) {  // from the start again: entries vanish meanwhile
    found = false;
    lseek(file, 0, SEEK_SET);
    for (long got; (got = syscall(SYS_getdents64, file, buffer, sizeof buffer)) > 0;)
      for (long at = 0; at < got;) {
        const Entry* const entry = reinterpret_cast<const Entry*>(buffer + at);
        at += entry->size;
        if (std::strcmp(entry->name, ".") == 0 || std::strcmp(entry->name, "..") == 0) continue;
        struct stat before, after;
        if (fstatat(file, entry->name, &before, AT_SYMLINK_NOFOLLOW) != 0) continue;
        removeTree(file, entry->name, depth - 1);
        found = found || fstatat(file, entry->name, &after, AT_SYMLINK_NOFOLLOW) != 0;
      }
  }
  close(file);
  unlinkat(folder, name, AT_REMOVEDIR);
}

void say(const char* text) {
  if (write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // nobody listens
}

const char* words(int signal) {
  switch (signal) {
    case SIGINT:
      return "dynwitness: interrupted; nothing half done is left\n";
    case SIGTERM:
      return "dynwitness: terminated; nothing half done is left\n";
    case SIGHUP:
      return "dynwitness: hung up; nothing half done is left\n";
    case SIGXCPU:
      return "dynwitness: the limit of processor time is reached; nothing half done is left\n";
    case SIGABRT:
      return "dynwitness: failed: a library gave up, for want of memory or by a fault of ours; "
             "its words, if any, "
             "are above\n";
    default:
      return "";  // QUIT shows itself; of PIPE nobody wants to hear
  }
}

/// Waits for a process that has been sent a signal: copies of this one clean up after themselves.
int awaitEnd(pid_t process) {
  int status = 0;
  for (int i = 0; i < 200; ++i) {
    const pid_t ended = waitpid(process, &status, WNOHANG);
    if (ended == process || (ended < 0 && errno != EINTR)) return status;
    const timespec pause{0, 10'000'000};
    nanosleep(&pause, nullptr);
  }
  kill(process, SIGKILL);
  return reap(process);
}

void endChildren() {
  const pid_t self = getpid();
  const auto forEach = [self](const auto& use) {
    for (ChildSlot& child : children)
      if (child.owner.load() == self) use(child);
  };
  forEach([](ChildSlot& child) { kill(child.target, child.signal); });
  forEach([](ChildSlot& child) { awaitEnd(child.target < 0 ? -child.target : child.target); });
}

void endProcess(int signal) {
  endChildren();
  const pid_t self = getpid();
  for (PathSlot& path : paths)
    if (path.owner.load() == self) removeTree(AT_FDCWD, path.path, 16);
  if (!is_copy) say(words(signal));
  if (signal == SIGABRT) _exit(3);
  ::signal(signal, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  raise(signal);
  sigprocmask(SIG_UNBLOCK, &only, nullptr);
}

sigset_t endingSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kEnding)
    if (signal != SIGABRT) sigaddset(&set, signal);
  return set;
}

}  // namespace

void leaveNothingBehind() {
  struct sigaction action {};
  action.sa_handler = endProcess;
  action.sa_mask = endingSignals();
  for (const int signal : kEnding) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    // what the caller ignores (nohup) stays ignored
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);
}

void endWithParent(pid_t parent) {
  is_copy = true;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
}

SignalsHeld::SignalsHeld() {
  const sigset_t ending = endingSignals();
  sigprocmask(SIG_BLOCK, &ending, &before_);
}
SignalsHeld::~SignalsHeld() {
  sigprocmask(SIG_SETMASK, &before_, nullptr);
}

int endCopy(pid_t copy) {
  kill(copy, SIGTERM);
  return awaitEnd(copy);
}

EndsWithUs::EndsWithUs(pid_t target, int signal)
    : slot_(take(children, [&](ChildSlot& slot) {
        slot.target = target;
        slot.signal = signal;
      })) {}
EndsWithUs::~EndsWithUs() {
  if (slot_ >= 0) children[slot_].owner = 0;
}
EndsWithUs::EndsWithUs(EndsWithUs&& other) noexcept : slot_(std::exchange(other.slot_, -1)) {}
EndsWithUs& EndsWithUs::operator=(EndsWithUs&& other) noexcept {
  std::swap(slot_, other.slot_);
  return *this;
}

RemovedWithUs::RemovedWithUs(const fs::path& path)
    : slot_(take(paths, [text = fs::absolute(path).string()](PathSlot& slot) {
        if (text.size() < sizeof slot.path)
          std::memcpy(slot.path, text.c_str(), text.size() + 1);
        else
          slot.path[0] = '\0';
      })) {}
RemovedWithUs::~RemovedWithUs() {
  if (slot_ >= 0) paths[slot_].owner = 0;
}

WorkLock::WorkLock(const fs::path& path)
    : file_(open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)),
      held_(file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) == 0) {}
WorkLock::~WorkLock() {
  if (file_ >= 0) close(file_);
}

void sweepLeftovers(const fs::path& folder, const std::string& prefix) {
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    if (name.rfind(prefix, 0) != 0) continue;
    // PREFIX<process>...: one that lives may not have taken its lock yet
    const long process = std::strtol(name.c_str() + prefix.size(), nullptr, 10);
    if (process <= 0 || process == getpid() || kill(static_cast<pid_t>(process), 0) == 0 ||
        errno != ESRCH)
      continue;
    if (const WorkLock lock(entry->path()); lock.isHeld()) {
      std::error_code not_ours;
      fs::remove_all(entry->path(), not_ours);
    }
  }
}

namespace {

fs::path makeFolder(const fs::path& parent, const std::string& stem) {
  sweepLeftovers(parent, stem + "-");
  for (int k = 0; k < 1000; ++k) {
    const fs::path path = parent / fmt::format("{}-{}-{}", stem, getpid(), k);
    if (mkdir(path.c_str(), 0777) == 0) return path;
    if (errno != EEXIST)
      throw std::runtime_error(
          fmt::format("{}: cannot create: {}", path.string(), std::strerror(errno)));
  }
  throw std::runtime_error(
      fmt::format("{}: cannot create: {}", (parent / stem).string(), std::strerror(EEXIST)));
}

}  // namespace

int reap(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

DraftFolder::DraftFolder(const fs::path& parent, const std::string& stem)
    : path_(makeFolder(parent, stem)), lock_(path_), removed_(path_) {}
DraftFolder::~DraftFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace dynwitness::crosscheck
