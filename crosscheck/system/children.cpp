// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/children.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/system/leaving.hpp"
#include "crosscheck/system/pipe.hpp"
#include "crosscheck/system/processes.hpp"

extern char** environ;

namespace dynwitness::crosscheck {
namespace {

constexpr std::size_t kKept = 1 << 16;
using Clock = std::chrono::steady_clock;

/// What a keeper writes: why the program did not start, or how it ended.
struct News {
  enum Kind { kCannotStart, kEnded } kind;
  int value;  ///< errno; status as of waitpid()
};

void everySignalDefault() {
  struct sigaction plain {};
  plain.sa_handler = SIG_DFL;
  for (int signal = 1; signal < 32; ++signal) sigaction(signal, &plain, nullptr);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

void noCore() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
}

void tell(int file, News news) {
  if (write(file, &news, sizeof news) < 0) return;  // then nobody waits for it
}

/// What the two processes between us and the program need, made before fork(): afterwards nothing
/// may allocate.
struct Start {
  std::vector<std::string> words, settings;
  std::vector<char*> arguments, environment;
  std::string file, folder;

  Start(const std::vector<std::string>& words, const ChildOptions& options);
};

/// The file that a shell would run. Empty: none
std::string found(const std::string& command) {
  if (command.find('/') != std::string::npos) return command;
  const char* const path = std::getenv("PATH");
  const std::string folders = path ? path : "/usr/bin:/bin";
  for (std::size_t from = 0; from <= folders.size();) {
    const std::size_t to = std::min(folders.find(':', from), folders.size());
    const std::filesystem::path file =
        std::filesystem::path(folders.substr(from, to - from)) / command;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0)
      return file.string();
    from = to + 1;
  }
  return "";
}

Start::Start(const std::vector<std::string>& all_words, const ChildOptions& options)
    : words(all_words), file(found(words.at(0))), folder(options.folder.string()) {
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  for (const auto& [name, value] : options.environment) settings.push_back(name + "=" + value);
  for (std::string& setting : settings) environment.push_back(setting.data());
  for (char** each = environ; *each; ++each) {
    const std::string setting = *each;
    const bool is_set =
        std::any_of(options.environment.begin(), options.environment.end(),
                    [&](const auto& other) { return setting.rfind(other.first + "=", 0) == 0; });
    if (!is_set) environment.push_back(*each);
  }
  environment.push_back(nullptr);
}

/// What the program has as standard input, output and error.
struct Files {
  int input = -1;  ///< -1: nothing to read
  int output, error;
};

[[noreturn]] void becomeProgram(const Start& start, const Files& files, int news) {
  everySignalDefault();
  const int input = files.input >= 0 ? files.input : open("/dev/null", O_RDONLY);
  if (input >= 0) dup2(input, STDIN_FILENO);
  dup2(files.output, STDOUT_FILENO);
  dup2(files.error, STDERR_FILENO);
  if (start.folder.empty() || chdir(start.folder.c_str()) == 0)
    execve(start.file.c_str(), start.arguments.data(), start.environment.data());
  tell(news, {News::kCannotStart, errno});
  _exit(127);
}

/// Of /proc: all processes that descend from one. What cannot be read has ended meanwhile.
std::vector<pid_t> descendantsOf(pid_t ancestor) {
  std::vector<std::pair<pid_t, pid_t>> all;  // process, parent
  DIR* const folder = opendir("/proc");
  if (!folder) return {};
  while (const dirent* const entry = readdir(folder)) {
    const pid_t process = static_cast<pid_t>(std::strtol(entry->d_name, nullptr, 10));
    if (process <= 0) continue;
    char path[64], text[512];
    std::snprintf(path, sizeof path, "/proc/%d/stat", process);
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    const ssize_t size = file < 0 ? -1 : read(file, text, sizeof text - 1);
    if (file >= 0) close(file);
    if (size <= 0) continue;
    text[size] = '\0';
    int parent = 0;
    // "12 (name, with any character) S 7 ..."
    const char* const name_ends = std::strrchr(text, ')');
    if (name_ends && std::sscanf(name_ends + 1, " %*c %d", &parent) == 1)
      all.emplace_back(process, parent);
  }
  closedir(folder);
  std::vector<pid_t> found = {ancestor};
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const auto& [process, parent] : all)
      if (parent == found[i]) found.push_back(process);
  found.erase(found.begin());
  return found;
}

/// How long a keeper keeps: until its program has ended, or until it is asked to end.
enum class Keeps { kTheProgram, kUntilAsked };

/** The keeper of a program, the first of a group of its own. It inherits the orphans among its
    descendants, so that it finds and ends all of them, those in groups and sessions of their own
    too. SIGTERM asks it to end, which it gets when the parent has gone. */
[[noreturn]] void keep(const Start& start, Keeps keeps, const Limits* limits, pid_t parent,
                       const Files& files, int news) {
  setpgid(0, 0);
  everySignalDefault();
  noCore();
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  sigset_t awaited;  // both wait until they are asked for, so that none is missed
  sigemptyset(&awaited);
  sigaddset(&awaited, SIGTERM);
  sigaddset(&awaited, SIGCHLD);
  sigprocmask(SIG_BLOCK, &awaited, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  const pid_t program = fork();
  if (program == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (limits) {
      const auto bytes = static_cast<rlim_t>(limits->gigabytes * 1e9);
      const rlimit memory{bytes, bytes};
      setrlimit(RLIMIT_AS, &memory);
    }
    close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    becomeProgram(start, files, news);
  }
  // whoever else holds an end of these keeps the others from seeing that it is closed
  close_range(0, static_cast<unsigned>(news) - 1, 0);
  close_range(static_cast<unsigned>(news) + 1, ~0U, 0);
  if (program < 0)
    tell(news, {News::kCannotStart, errno});
  else
    setpgid(program, program);
  int status = 0;
  for (bool is_over = program < 0 && keeps == Keeps::kTheProgram; !is_over;) {
    is_over = sigwaitinfo(&awaited, nullptr) == SIGTERM;
    for (pid_t process; (process = waitpid(-1, &status, WNOHANG)) > 0;) {
      if (process != program) continue;
      tell(news, {News::kEnded, status});
      is_over = is_over || keeps == Keeps::kTheProgram;
    }
  }
  if (program > 0) kill(-program, SIGKILL);
  constexpr int kRounds = 2000;  // one that the system itself holds up stays
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<pid_t> left = descendantsOf(getpid());
    if (left.empty()) break;
    for (const pid_t process : left) kill(process, SIGKILL);
    usleep(1000);
    while (waitpid(-1, &status, WNOHANG) > 0) {
    }
  }
  _exit(0);
}

}  // namespace

struct Child::Running {
  Pipe output, news;
  pid_t keeper = -1;
  int error = 0;  ///< why there is no keeper
  std::string name;
  double seconds = 0;
  EndsWithUs ends_with_us;

  ~Running() {
    if (keeper < 0) return;
    kill(keeper, SIGTERM);
    reap(keeper);
  }
};

Child::Child(const std::vector<std::string>& words, const ChildOptions& options)
    : running_(std::make_unique<Running>()) {
  Running& r = *running_;
  r.name = words.at(0);
  r.seconds = options.seconds;
  const Start start(words, options);
  if (start.file.empty())
    r.error = ENOENT;
  else if (r.output.ends[0] < 0 || r.news.ends[0] < 0)
    r.error = EMFILE;
  if (r.error) return;
  const SignalsHeld held;
  const pid_t self = getpid();
  r.keeper = fork();
  if (r.keeper == 0)
    keep(start, Keeps::kTheProgram, nullptr, self, {-1, r.output.ends[1], r.output.ends[1]},
         r.news.ends[1]);
  if (r.keeper < 0) {
    r.error = errno;
    return;
  }
  setpgid(r.keeper, r.keeper);  // here and there: whoever comes first
  r.ends_with_us = EndsWithUs(r.keeper, SIGTERM);
  r.output.closeEnd(1);
  r.news.closeEnd(1);
}

Child::~Child() = default;
Child::Child(Child&&) noexcept = default;
Child& Child::operator=(Child&&) noexcept = default;

Ending Child::wait() {
  Running& r = *running_;
  Ending ending;
  const auto cannot_start = [&](int error) {
    ending.not_found = error == ENOENT;
    ending.problem = fmt::format("{}: cannot be started: {}", r.name, std::strerror(error));
  };
  if (r.error) {
    cannot_start(r.error);
    return ending;
  }
  const auto end = Clock::now() + std::chrono::milliseconds(static_cast<long>(1000 * r.seconds));
  bool is_over = false;
  for (bool reading = true; !is_over || reading;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0 && !is_over) {
      ending.problem =
          fmt::format("{}: did not end within {:g} s, and was killed", r.name, r.seconds);
      break;
    }
    pollfd files[2] = {{reading ? r.output.ends[0] : -1, POLLIN, 0},
                       {is_over ? -1 : r.news.ends[0], POLLIN, 0}};
    // what has been written when the program ends is there to be read; who writes on is killed
    const int count = poll(files, 2, is_over ? 0 : static_cast<int>(left));
    if (count < 0 && errno != EINTR) break;
    if (count == 0 && is_over) break;
    if (files[0].revents != 0) {
      char buffer[1 << 14];
      const ssize_t size = read(r.output.ends[0], buffer, sizeof buffer);
      if (size == 0 || (size < 0 && errno != EINTR)) reading = false;
      if (size > 0 && ending.output.size() < kKept)
        ending.output.append(buffer, std::min<std::size_t>(size, kKept - ending.output.size()));
      else if (is_over)
        reading = false;
    }
    if (files[1].revents != 0) {
      News news{News::kCannotStart, EPIPE};
      const ssize_t size = read(r.news.ends[0], &news, sizeof news);
      if (size < 0 && errno == EINTR) continue;
      is_over = true;
      if (size != sizeof news)
        ending.problem = r.name + ": its keeper was killed";
      else if (news.kind == News::kCannotStart)
        cannot_start(news.value);
      else if (news.value != 0)
        ending.problem = r.name + " " + howItEnded(news.value);
    }
  }
  if (!ending.problem.empty() && !ending.output.empty())
    ending.problem += ": " + ending.output.substr(0, 600);
  return ending;
}

std::string triedInCopy(const std::function<std::string()>& trial, double seconds) {
  Pipe answer;
  if (!answer.isOpen()) return std::string("pipe: ") + std::strerror(errno);
  pid_t copy;
  EndsWithUs ends_with_us;
  {
    const SignalsHeld held;
    const pid_t self = getpid();
    copy = fork();
    if (copy == 0) {
      everySignalDefault();
      noCore();
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != self) _exit(1);
      std::string said;
      try {
        said = trial();
      } catch (const std::exception& error) {
        said = error.what();
      }
      said = (said.empty() ? "+" : "-") + said.substr(0, 2000);
      _exit(write(answer.ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size())
                ? 0
                : 1);
    }
    if (copy < 0) return std::string("fork: ") + std::strerror(errno);
    ends_with_us = EndsWithUs(copy, SIGKILL);
  }
  answer.closeEnd(1);
  char buffer[2048];
  ssize_t size = -1;
  pollfd file{answer.ends[0], POLLIN, 0};
  const auto end = Clock::now() + std::chrono::milliseconds(static_cast<long>(1000 * seconds));
  int ready = 0;
  do {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    ready = poll(&file, 1, static_cast<int>(std::max<long>(left, 0)));
  } while (ready < 0 && errno == EINTR);
  if (ready > 0) size = read(answer.ends[0], buffer, sizeof buffer);
  kill(copy, SIGKILL);  // it has said what it had to
  const int status = reap(copy);
  if (ready == 0) return fmt::format("did not end within {:g} s", seconds);
  if (size >= 1) return std::string(buffer + 1, static_cast<std::size_t>(size) - 1);
  return howItEnded(status);
}

// ---- conversations

namespace {

/// The start of a text that somebody else wrote, on one line.
std::string quoted(std::string text, std::size_t shown = 80) {
  const bool is_cut = text.size() > shown;
  if (is_cut) text.resize(shown);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  return "'" + text + (is_cut ? "'..." : "'");
}

/// write() to a pipe that may have lost its reader: then EPIPE and no signal.
ssize_t writeQuietly(int file, const char* data, std::size_t size) {
  sigset_t pipe, before;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  sigprocmask(SIG_BLOCK, &pipe, &before);
  const ssize_t written = write(file, data, size);
  const int error = errno;
  if (written < 0 && error == EPIPE) {
    const timespec now{0, 0};
    sigtimedwait(&pipe, nullptr, &now);
  }
  sigprocmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return written;
}

}  // namespace

struct Conversation::Running {
  Limits limits;
  Pipe input, output, error, news;
  pid_t keeper = -1;
  EndsWithUs ends_with_us;
  std::string unsent;    ///< of the questions
  std::size_t sent = 0;  ///< of these
  int awaited = 0;       ///< answers to questions that have been put
  bool hears = true;     ///< it has not closed its standard input
  std::string unread;    ///< of its standard output
  std::string grumble;   ///< the end of its standard error
  std::string failure;   ///< not empty: it is over
  Clock::time_point counted = Clock::now();

  ~Running() { end(); }

  void end() {
    if (keeper < 0) return;
    kill(keeper, SIGTERM);
    reap(keeper);
    keeper = -1;
    ends_with_us = EndsWithUs();
    for (Pipe* pipe : {&input, &output, &error, &news}) pipe->closeEnd(0), pipe->closeEnd(1);
  }

  [[noreturn]] void fail(const std::string& why) {
    readError();
    end();
    failure = why;
    // what a program says last is why it gave up
    std::size_t begin = grumble.find_last_not_of(" \n\r\t");
    grumble.resize(begin == std::string::npos ? 0 : begin + 1);
    begin = grumble.rfind('\n');
    constexpr std::size_t kOfError = 240;  // a path or two, and then what is wrong with it
    if (!grumble.empty())
      failure += "; its standard error ends with " +
                 quoted(grumble.substr(begin == std::string::npos ? 0 : begin + 1), kOfError);
    throw std::runtime_error(failure);
  }

  /// What is there of its standard error, of which the end is kept. false: it is closed
  bool readError() {
    constexpr std::size_t kEnd = 2000;
    char buffer[1 << 16];
    for (int pieces = 0; pieces < 16; ++pieces) {
      const ssize_t size = read(error.ends[0], buffer, sizeof buffer);
      if (size == 0) return false;
      if (size < 0) return errno == EAGAIN || errno == EINTR;
      grumble.append(buffer, static_cast<std::size_t>(size));
      if (grumble.size() > kEnd) grumble.erase(0, grumble.size() - kEnd);
    }
    return true;
  }

  /// As much of the questions as the pipe takes.
  void send() {
    const ssize_t size = writeQuietly(input.ends[1], unsent.data() + sent, unsent.size() - sent);
    if (size > 0) sent += static_cast<std::size_t>(size);
    if (size < 0 && errno == EPIPE) hears = false;
    if (sent < unsent.size()) return;
    unsent.clear();
    sent = 0;
  }

  void countProcesses() {
    const auto now = Clock::now();
    if (now - counted < std::chrono::milliseconds(50)) return;
    counted = now;
    const std::size_t count = descendantsOf(keeper).size();
    if (count > static_cast<std::size_t>(limits.processes))
      fail(fmt::format("it runs too many processes, allowed: {}", limits.processes));
  }

  /// What the keeper has to say, awaited for a moment. Empty: nothing, the program runs
  std::string ended(int milliseconds) {
    pollfd file{news.ends[0], POLLIN, 0};
    if (poll(&file, 1, milliseconds) <= 0) return "";
    News word{News::kCannotStart, EPIPE};
    if (read(news.ends[0], &word, sizeof word) != sizeof word) return "its keeper was killed";
    if (word.kind == News::kCannotStart)
      return fmt::format("it cannot be started: {}", std::strerror(word.value));
    return word.value == 0 ? "it ended (status 0)" : "it " + howItEnded(word.value);
  }
};

Conversation::Conversation(const std::string& command, const Limits& limits)
    : running_(std::make_unique<Running>()) {
  Running& r = *running_;
  r.limits = limits;
  for (const Pipe* pipe : {&r.input, &r.output, &r.error, &r.news})
    if (!pipe->isOpen()) throw std::runtime_error(std::string("pipe: ") + std::strerror(EMFILE));
  const Start start({"/bin/sh", "-c", command}, {});
  {
    const SignalsHeld held;
    const pid_t self = getpid();
    r.keeper = fork();
    if (r.keeper == 0)
      keep(start, Keeps::kUntilAsked, &limits, self,
           {r.input.ends[0], r.output.ends[1], r.error.ends[1]}, r.news.ends[1]);
    if (r.keeper < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
    setpgid(r.keeper, r.keeper);  // here and there: whoever comes first
    r.ends_with_us = EndsWithUs(r.keeper, SIGTERM);
  }
  r.input.closeEnd(0);
  for (Pipe* pipe : {&r.output, &r.error, &r.news}) pipe->closeEnd(1);
  for (const int file : {r.input.ends[1], r.output.ends[0], r.error.ends[0]})
    fcntl(file, F_SETFL, O_NONBLOCK);
}

Conversation::~Conversation() = default;

void Conversation::put(const std::string& line) {
  Running& r = *running_;
  if (!r.failure.empty()) throw std::runtime_error(r.failure);
  if (r.awaited == 0 && !r.unread.empty())
    r.fail("it said more than was asked, expected one line: " + quoted(r.unread));
  ++r.awaited;
  r.unsent.erase(0, r.sent);
  r.sent = 0;
  r.unsent += line;
  r.unsent += '\n';
  if (r.hears) r.send();
}

std::string Conversation::take(std::size_t most) {
  Running& r = *running_;
  if (!r.failure.empty()) throw std::runtime_error(r.failure);
  if (r.awaited == 0) throw std::logic_error("Conversation::take: expected a question first");
  // an answer that has come with the one before
  const auto whole = [&](std::size_t from) -> std::optional<std::string> {
    const std::size_t newline = r.unread.find('\n', from);
    if (std::min(newline, r.unread.size()) > most)
      r.fail(fmt::format("its answer has more than {} bytes, expected less: {}", most,
                         quoted(r.unread)));
    if (newline == std::string::npos) return {};
    std::string answer = r.unread.substr(0, newline);
    r.unread.erase(0, newline + 1);
    --r.awaited;
    return answer;
  };
  if (std::optional<std::string> answer = whole(0)) return *std::move(answer);
  bool speaks = true, grumbles = true;
  const auto end =
      Clock::now() + std::chrono::milliseconds(static_cast<long>(1000 * r.limits.seconds));
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0)
      r.fail(fmt::format("it did not answer within {:g} s and still runs{}{}", r.limits.seconds,
                         !r.hears ? ", and has closed its standard input"
                         : r.sent < r.unsent.size()
                             ? fmt::format(", and has read {} of {} bytes", r.sent, r.unsent.size())
                             : "",
                         r.unread.empty()
                             ? ""
                             : ", and has said " + quoted(r.unread) + " and no end of the line"));
    r.countProcesses();
    pollfd files[4] = {
        {r.hears ? r.input.ends[1] : -1, static_cast<short>(r.unsent.empty() ? 0 : POLLOUT), 0},
        {r.output.ends[0], POLLIN, 0},
        {grumbles ? r.error.ends[0] : -1, POLLIN, 0},
        {r.news.ends[0], POLLIN, 0}};
    constexpr long kTick = 50;  // [ms] between counts of its processes
    if (poll(files, 4, static_cast<int>(std::min<long>(left, kTick))) < 0 && errno != EINTR)
      r.fail(std::string("poll: ") + std::strerror(errno));
    if ((files[0].revents & POLLERR) != 0)
      r.hears = false;
    else if (files[0].revents != 0)
      r.send();
    if (files[2].revents != 0) grumbles = r.readError();
    // what it said before it ended is there to be read; a child of its own may hold the pipe open
    if (files[1].revents == 0 && files[3].revents != 0) speaks = false;
    if (files[1].revents == 0 && speaks) continue;
    char buffer[1 << 16];
    const ssize_t size = read(r.output.ends[0], buffer, sizeof buffer);
    if (size == 0) speaks = false;
    if (size > 0) {
      speaks = true;
      const std::size_t before = r.unread.size();
      r.unread.append(buffer, static_cast<std::size_t>(size));
      if (std::optional<std::string> answer = whole(before)) return *std::move(answer);
    }
    if (!speaks) {
      constexpr int kMoment = 500;  // [ms] from closing a file to the end of the program
      const std::string how = r.ended(kMoment);
      const std::string said = r.unread.empty() ? "" : ", in the middle of " + quoted(r.unread);
      r.fail((how.empty() ? "it closed its standard output" : how) + said + ", expected an answer");
    }
  }
}

}  // namespace dynwitness::crosscheck
