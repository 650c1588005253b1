// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/processes.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>

#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crosscheck/system/leaving.hpp"
#include "crosscheck/system/pipe.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace {

/// What a copy writes in front of each answer.
struct Header {
  enum Kind : std::int32_t { kBegun, kAnswer, kBadInput, kFailure };
  std::int32_t index;
  Kind kind;
  std::uint64_t size;
};

/// The next index, in memory that all copies share.
class Counter {
 public:
  Counter() {
    void* page =
        mmap(nullptr, sizeof *next_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) throw std::runtime_error(fmt::format("mmap: {}", std::strerror(errno)));
    next_ = new (page) std::atomic<int>(0);
  }
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;
  ~Counter() { munmap(next_, sizeof *next_); }
  int take() { return next_->fetch_add(1); }

 private:
  std::atomic<int>* next_ = nullptr;
};

void writeAll(int file, const void* data, std::size_t size) {
  const char* from = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = write(file, from, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) _exit(1);  // nobody listens any more
    from += written;
    size -= static_cast<std::size_t>(written);
  }
}

void send(int file, int index, Header::Kind kind, const std::string& text) {
  const Header header{index, kind, text.size()};
  writeAll(file, &header, sizeof header);
  writeAll(file, text.data(), text.size());
}

/// One task, and what came of it.
void sendAnswer(int file, int index, const std::function<std::string(int)>& work) {
  try {
    send(file, index, Header::kAnswer, work(index));
  } catch (const scene::InputError& error) {
    send(file, index, Header::kBadInput, error.what());
  } catch (const std::exception& error) {
    send(file, index, Header::kFailure, error.what());
  }
}

/// One copy, seen from the original.
struct Copy {
  pid_t process = -1;
  int file = -1;       ///< where its answers come from; -1 at their end
  int task = -1;       ///< what it is at; -1: nothing
  std::string unread;  ///< the beginning of what it says next
  EndsWithUs ends_with_us = {};
};

/// Stops what is left of the copies, however this ends.
struct Copies {
  std::vector<Copy> all;
  Copies() = default;
  Copies(const Copies&) = delete;
  Copies& operator=(const Copies&) = delete;
  ~Copies() {
    for (Copy& copy : all) {
      if (copy.file >= 0) close(copy.file);
      if (copy.process < 0) continue;
      endCopy(copy.process);
    }
  }
  static int waitFor(Copy& copy) {
    const int status = reap(copy.process);
    copy.process = -1;
    copy.ends_with_us = {};
    return status;
  }
};

/// @param body  what the copy does; it is given where to write
void start(Copies& copies, const std::function<void(int file)>& body) {
  Pipe answers;
  if (!answers.isOpen()) throw std::runtime_error(fmt::format("pipe: {}", std::strerror(errno)));
  pid_t process;
  EndsWithUs ends_with_us;
  {
    const SignalsHeld held;
    const pid_t self = getpid();
    process = fork();
    if (process == 0)
      endWithParent(self);
    else if (process > 0)
      ends_with_us = EndsWithUs(process, SIGTERM);
  }
  if (process == 0) {
    answers.closeEnd(0);
    for (const Copy& earlier : copies.all)
      if (earlier.file >= 0) close(earlier.file);
    body(answers.ends[1]);
    _exit(0);  // without the destructors and buffers of the original
  }
  copies.all.push_back({process, answers.take(0), -1, {}, std::move(ends_with_us)});
  if (process < 0) throw std::runtime_error(fmt::format("fork: {}", std::strerror(errno)));
}

/// Takes what is whole of what a copy has said.
template <typename Use>
void takeAnswers(Copy& copy, const Use& use) {
  Header header;
  std::size_t at = 0;
  while (copy.unread.size() - at >= sizeof header) {
    std::memcpy(&header, copy.unread.data() + at, sizeof header);
    if (copy.unread.size() - at - sizeof header < header.size) break;
    use(header, copy.unread.substr(at + sizeof header, header.size));
    at += sizeof header + header.size;
  }
  copy.unread.erase(0, at);
}

}  // namespace

int availableProcessors() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

std::vector<std::string> inProcesses(int processes, int count,
                                     const std::function<std::string(int)>& work,
                                     const std::function<void(int)>& done) {
  if (processes < 1) throw std::invalid_argument("inProcesses: expected at least one process");
  std::vector<std::string> answers(count);
  if (processes == 1 || count <= 1) {
    for (int index = 0; index < count; ++index) {
      answers[index] = work(index);
      if (done) done(index);
    }
    return answers;
  }
  std::fflush(nullptr);  // or the copies would hold the same unwritten text
  Counter counter;
  Copies copies;
  for (int i = 0; i < std::min(processes, count); ++i)
    start(copies, [&](int file) {
      for (int index; (index = counter.take()) < count;) {
        send(file, index, Header::kBegun, "");
        sendAnswer(file, index, work);
      }
    });

  for (std::size_t listening = copies.all.size(); listening > 0;) {
    std::vector<pollfd> files;
    for (const Copy& copy : copies.all) files.push_back({copy.file, POLLIN, 0});
    if (poll(files.data(), files.size(), -1) < 0 && errno != EINTR)
      throw std::runtime_error(fmt::format("poll: {}", std::strerror(errno)));
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (files[i].revents == 0) continue;
      Copy& copy = copies.all[i];
      char buffer[1 << 16];
      const ssize_t got = read(copy.file, buffer, sizeof buffer);
      if (got > 0) {
        copy.unread.append(buffer, static_cast<std::size_t>(got));
        takeAnswers(copy, [&](const Header& header, std::string text) {
          copy.task = header.kind == Header::kBegun ? header.index : -1;
          if (header.kind == Header::kBadInput) throw scene::InputError({}, text);
          if (header.kind == Header::kFailure) throw std::runtime_error(text);
          if (header.kind != Header::kAnswer) return;
          answers[header.index] = std::move(text);
          if (done) done(header.index);
        });
      } else if (got == 0) {
        close(copy.file);
        copy.file = -1;
        --listening;
        const int status = Copies::waitFor(copy);
        if (copy.task >= 0)
          throw std::runtime_error(fmt::format(
              "task {} of {} ended its process{}", copy.task + 1, count,
              WIFSIGNALED(status) ? fmt::format(": {}", strsignal(WTERMSIG(status)))
                                  : ", for want of memory or by a fault of ours; its words, if "
                                    "any, are above"));
      } else if (errno != EINTR) {
        throw std::runtime_error(fmt::format("read: {}", std::strerror(errno)));
      }
    }
  }
  return answers;
}

void inOwnCopies(int at_a_time, int count, double seconds,
                 const std::function<std::string(int)>& work,
                 const std::function<void(int, const CopyEnded&)>& ended) {
  if (at_a_time < 1) throw std::invalid_argument("inOwnCopies: expected at least one copy");
  using Clock = std::chrono::steady_clock;
  std::fflush(nullptr);  // or the copies would hold the same unwritten text
  Copies copies;
  std::vector<Clock::time_point> ends;
  std::vector<CopyEnded> said(static_cast<std::size_t>(count));
  std::vector<bool> has_said(said.size(), false);
  for (int running = 0, next = 0; running > 0 || next < count;) {
    for (; running < at_a_time && next < count; ++running, ++next) {
      start(copies, [&](int file) { sendAnswer(file, next, work); });
      ends.push_back(Clock::now() + std::chrono::milliseconds(static_cast<long>(1000 * seconds)));
    }
    std::vector<pollfd> files;
    Clock::time_point first = Clock::time_point::max();
    for (std::size_t i = 0; i < copies.all.size(); ++i) {
      files.push_back({copies.all[i].file, POLLIN, 0});
      if (copies.all[i].file >= 0) first = std::min(first, ends[i]);
    }
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(first - Clock::now()).count() + 1;
    if (poll(files.data(), files.size(), static_cast<int>(std::clamp<long>(left, 0, 1 << 30))) <
            0 &&
        errno != EINTR)
      throw std::runtime_error(fmt::format("poll: {}", std::strerror(errno)));
    for (std::size_t i = 0; i < files.size(); ++i) {
      Copy& copy = copies.all[i];
      if (copy.file < 0) continue;
      const bool is_late = Clock::now() >= ends[i];
      if (files[i].revents == 0 && !is_late) continue;
      char buffer[1 << 16];
      const ssize_t got = is_late ? 0 : read(copy.file, buffer, sizeof buffer);
      if (got < 0 && errno == EINTR) continue;
      if (got > 0) {
        copy.unread.append(buffer, static_cast<std::size_t>(got));
        continue;
      }
      takeAnswers(copy, [&](const Header& header, std::string text) {
        has_said[i] = true;
        (header.kind == Header::kAnswer ? said[i].answer : said[i].problem) = std::move(text);
      });
      close(copy.file);
      copy.file = -1;
      std::string().swap(copy.unread);  // with its room: copies are as many as tasks
      --running;
      const int status = is_late ? endCopy(copy.process) : Copies::waitFor(copy);
      copy.process = -1;
      copy.ends_with_us = {};
      if (!has_said[i])
        said[i].problem = is_late ? fmt::format("was not done within {:g} s", seconds)
                                  : "its process " + howItEnded(status);
      const CopyEnded one = std::move(said[i]);  // assigning {} would keep the text's room
      ended(static_cast<int>(i), one);
    }
  }
}

std::string howItEnded(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("was ended by a signal ({})", strsignal(WTERMSIG(status)));
  return fmt::format("failed with status {}", WEXITSTATUS(status));
}

}  // namespace dynwitness::crosscheck
