// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/system/children.hpp"

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
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "crosscheck/system/leaving.hpp"

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

struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) ends[0] = ends[1] = -1;
  }
  void closeEnd(int i) {
    if (ends[i] >= 0) close(ends[i]);
    ends[i] = -1;
  }
  ~Pipe() { closeEnd(0), closeEnd(1); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
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
};

[[noreturn]] void becomeProgram(const Start& start, int output, int news) {
  everySignalDefault();
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  if (start.folder.empty() || chdir(start.folder.c_str()) == 0)
    execve(start.file.c_str(), start.arguments.data(), start.environment.data());
  tell(news, {News::kCannotStart, errno});
  _exit(127);
}

/// The keeper: the first of its group. All of the group goes when the parent does, or when the
/// program ends.
[[noreturn]] void keep(const Start& start, pid_t parent, int output, int news) {
  setpgid(0, 0);
  everySignalDefault();
  noCore();
  struct sigaction kill_group {};
  kill_group.sa_handler = [](int) { kill(0, SIGKILL); };
  sigaction(SIGTERM, &kill_group, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  const pid_t program = fork();
  if (program == 0) becomeProgram(start, output, news);
  int status = 0;
  if (program < 0)
    tell(news, {News::kCannotStart, errno});
  else if (waitpid(program, &status, 0) == program)
    tell(news, {News::kEnded, status});
  kill(0, SIGKILL);
  _exit(1);
}

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

std::string howItEnded(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("was ended by a signal ({})", strsignal(WTERMSIG(status)));
  return fmt::format("failed with status {}", WEXITSTATUS(status));
}

/// Waits for a child of ours, which is about to end.
int reap(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
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
    kill(-keeper, SIGKILL);
    reap(keeper);
  }
};

Child::Child(const std::vector<std::string>& words, const ChildOptions& options)
    : running_(std::make_unique<Running>()) {
  Running& r = *running_;
  r.name = words.at(0);
  r.seconds = options.seconds;
  Start start;
  start.words = words;
  start.file = found(words.at(0));
  start.folder = options.folder.string();
  for (std::string& word : start.words) start.arguments.push_back(word.data());
  start.arguments.push_back(nullptr);
  for (const auto& [name, value] : options.environment)
    start.settings.push_back(name + "=" + value);
  for (std::string& setting : start.settings) start.environment.push_back(setting.data());
  for (char** each = environ; *each; ++each) {
    const std::string setting = *each;
    const bool is_set =
        std::any_of(options.environment.begin(), options.environment.end(),
                    [&](const auto& other) { return setting.rfind(other.first + "=", 0) == 0; });
    if (!is_set) start.environment.push_back(*each);
  }
  start.environment.push_back(nullptr);
  if (start.file.empty())
    r.error = ENOENT;
  else if (r.output.ends[0] < 0 || r.news.ends[0] < 0)
    r.error = EMFILE;
  if (r.error) return;
  const SignalsHeld held;
  const pid_t self = getpid();
  r.keeper = fork();
  if (r.keeper == 0) keep(start, self, r.output.ends[1], r.news.ends[1]);
  if (r.keeper < 0) {
    r.error = errno;
    return;
  }
  setpgid(r.keeper, r.keeper);  // here and there: whoever comes first
  r.ends_with_us = EndsWithUs(-r.keeper, SIGKILL);
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
  if (answer.ends[0] < 0) return std::string("pipe: ") + std::strerror(errno);
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

}  // namespace dynwitness::crosscheck
