// SPDX-License-Identifier: GPL-3.0-or-later
// What must not outlive this process, however it ends: its children and its unfinished files.
#pragma once

#include <csignal>
#include <filesystem>
#include <string>

#include <sys/types.h>

namespace dynwitness::crosscheck {

/** From now on INT, TERM, HUP, QUIT, PIPE and XCPU kill the children that are registered, remove
    the unfinished files, say so on standard error, and end this process as they would have done (a
    shell sees 128 + the signal). ABRT, with which GMP and FLINT answer a lack of memory, ends it
    with status 3. XFSZ is ignored, so that a file that becomes too large is an error of write(). */
void leaveNothingBehind();

/// Of a copy that fork() has just made: it ends when its parent does, and leaves the talking to it.
void endWithParent(pid_t parent);

/// No signal that ends the process is taken while this exists: for a few steps that belong
/// together.
class SignalsHeld {
 public:
  SignalsHeld();
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

/// Waits for a child that has ended or is about to. @return its status
int reap(pid_t child);

/// Asks a copy of this process to end, and waits for it; after two seconds it is killed.
/// @return its status
int endCopy(pid_t copy);

/// A child (or a process group, with a minus sign) that gets `signal` when one ends this process.
class EndsWithUs {
 public:
  EndsWithUs() = default;
  EndsWithUs(pid_t target, int signal);
  ~EndsWithUs();
  EndsWithUs(EndsWithUs&& other) noexcept;
  EndsWithUs& operator=(EndsWithUs&& other) noexcept;

 private:
  int slot_ = -1;
};

/// A file, or a folder with all that is in it, which a signal to this process removes.
class RemovedWithUs {
 public:
  explicit RemovedWithUs(const std::filesystem::path& path);
  ~RemovedWithUs();
  RemovedWithUs(const RemovedWithUs&) = delete;
  RemovedWithUs& operator=(const RemovedWithUs&) = delete;

 private:
  int slot_;
};

/// Holds a lock on a file or a folder for as long as it exists: "somebody is at work here".
class WorkLock {
 public:
  explicit WorkLock(const std::filesystem::path& path);
  ~WorkLock();
  WorkLock(const WorkLock&) = delete;
  WorkLock& operator=(const WorkLock&) = delete;
  bool isHeld() const { return held_; }

 private:
  int file_ = -1;
  bool held_ = false;
};

/// Removes what processes that were killed have left in a folder: entries called
/// PREFIX<process>..., of a process that is no more, on which nobody (on another machine, or in
/// another container) holds a WorkLock.
void sweepLeftovers(const std::filesystem::path& folder, const std::string& prefix);

/** A new folder PARENT/STEM-..., which goes with this object, with a signal (RemovedWithUs), or,
    when this process is killed, with the next of the same stem in the same place.
    @throws std::runtime_error  the system's reason */
class DraftFolder {
 public:
  DraftFolder(const std::filesystem::path& parent, const std::string& stem);
  ~DraftFolder();
  DraftFolder(const DraftFolder&) = delete;
  DraftFolder& operator=(const DraftFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  WorkLock lock_;
  RemovedWithUs removed_;
};

}  // namespace dynwitness::crosscheck
