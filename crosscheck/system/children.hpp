// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs, run so that none of them holds us up, fills our memory, or stays behind.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace dynwitness::crosscheck {

struct ChildOptions {
  std::filesystem::path folder = {};  ///< where it runs; empty: here
  double seconds = 60;                ///< after which it is killed
  std::vector<std::pair<std::string, std::string>> environment = {};  ///< set besides our own
};

/// How a program ended.
struct Ending {
  std::string output;      ///< standard output and standard error together, the first 64 KiB
  std::string problem;     ///< in words, with the first of its own; empty: it exited with status 0
  bool not_found = false;  ///< there is no such program
};

/** A program (found on the PATH when it is named without a slash) in a process group of its own,
    which is killed as a whole when the program ends, takes too long, or this object or this process
    is gone, even by KILL: a keeper between the two sees to that. It reads nothing and writes to us
    alone. */
class Child {
 public:
  /// Starts it. What goes wrong is told by wait().
  explicit Child(const std::vector<std::string>& words, const ChildOptions& options = {});
  ~Child();
  Child(Child&&) noexcept;
  Child& operator=(Child&&) noexcept;

  Ending wait();  ///< once

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

/// What a program may use that somebody else wrote.
struct Limits {
  double seconds = 10;   ///< for one answer
  double gigabytes = 4;  ///< of address space, each of its processes
  int processes = 64;    ///< at a time
};

/** A program of somebody else's (words for a shell) that answers questions, a line each, on its
    standard output. It gets none of our open files. It and all that descend from it are killed when
    this object or this process is gone, those in groups and sessions of their own too: their keeper
    inherits what they leave behind. Only who kills the keeper first is not caught by it; his group
    is. */
class Conversation {
 public:
  Conversation(const std::string& command, const Limits& limits);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /** Its answer to a line (both without the newline).
      @param most  bytes of an answer
      @throws std::runtime_error  what came in place of an answer. The program has been killed then,
                                  and every further question gets the same. */
  std::string ask(const std::string& line, std::size_t most) {
    put(line);
    return take(most);
  }
  /// The same in two steps. Any number of questions may be under way: what the pipe to the program
  /// does not take at once is written while answers are awaited, and answers are read meanwhile, so
  /// that neither waits for the other. Answers come in the order of the questions.
  void put(const std::string& line);
  std::string take(std::size_t most);

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

/** Runs something in a copy of this process, for what may crash or hang.
    @param trial  returns what is wrong, or nothing
    @return       the same, or how the copy ended */
std::string triedInCopy(const std::function<std::string()>& trial, double seconds);

}  // namespace dynwitness::crosscheck
