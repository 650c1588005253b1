// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/progress.hpp"

#include <algorithm>
#include <csignal>
#include <new>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

namespace dynwitness::cli {
namespace {

constexpr double kQuiet_s = 1, kBetweenLines_s = 30, kBetweenBars_s = 0.25, kBetweenObjects_s = 1;
constexpr int kWidth = 24;
/// What comes first is not like the rest: of 2 s for the first 0.1 % no end can be told. After so
/// many seconds a rough end is worth more than none: hours or days, then.
constexpr double kWorthExtrapolating = 0.01, kAnyEnd_s = 10;

bool hasEnd(double fraction, double elapsed_s) {
  return fraction >= kWorthExtrapolating || (fraction > 0 && elapsed_s >= kAnyEnd_s);
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<long>(1000 * seconds));
}

}  // namespace

std::string duration(double seconds) {
  if (seconds < 100) return fmt::format("{:.0f} s", std::max(1.0, seconds));
  if (seconds < 6000) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 48 * 3600) return fmt::format("{:.0f} h", seconds / 3600);
  return fmt::format("{:.0f} days", seconds / 86400);
}

Progress::Progress(const std::string& name) : name_(name), terminal_(isatty(STDERR_FILENO) != 0) {
  startWatching();
}

Progress::Progress(int stages, double quiet_s, bool counts)
    : stages_(stages), terminal_(isatty(STDERR_FILENO) != 0) {
  if (counts) work_ = std::make_unique<scene::Work>("", stages);
  startWatching();
  shown_from_ = begin_ + milliseconds(quiet_s);
}

void Progress::startWatching() {
  begin_ = shown_from_ = Clock::now();
  if (as_ == ProgressAs::kOff) return;
  // signals are for the thread that does the work
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    watcher_ = std::thread([this] {
      try {
        watch();
      } catch (const std::bad_alloc&) {  // the work will tell, which wants more
      }
    });
  } catch (const std::system_error&) {  // no memory for a thread: stages are still told
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Progress::~Progress() {
  {
    const std::lock_guard<std::mutex> hold(lock_);
    over_ = true;
  }
  ended_.notify_all();
  if (watcher_.joinable()) watcher_.join();
  if (terminal_ && shown_) show("\r\033[K");  // the results take the bar's place
}

/// In one piece, and not through a stream, whose lock a copy of this process would inherit.
void Progress::show(const std::string& line) {
  for (std::size_t at = 0; at < line.size();) {
    const ssize_t written = write(STDERR_FILENO, line.data() + at, line.size() - at);
    if (written <= 0) return;  // nobody is there to read it
    at += static_cast<std::size_t>(written);
  }
}

std::string Progress::status() const {
  const scene::WorkSeen seen = scene::seenWork();
  const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
  const int digits = seen.fraction < 0.001 ? 4 : seen.fraction < 0.1 ? 1 : 0;
  std::string text = hasEnd(seen.fraction, elapsed)
                         ? fmt::format("{:.{}f} %, {} of about {}", 100 * seen.fraction, digits,
                                       duration(elapsed), duration(elapsed / seen.fraction))
                         : fmt::format("{}, the end is not known yet", duration(elapsed));
  for (const std::string& more : {seen.what, note_})
    if (!more.empty()) text += ", " + more;
  return text;
}

std::string Progress::json() const {
  const scene::WorkSeen seen = scene::seenWork();
  const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
  const double done = std::clamp(seen.fraction, 0.0, 1.0);
  nlohmann::ordered_json line{{"progress", stages_ > 0 ? stage_ : name_}};
  if (!seen.what.empty()) line["what"] = seen.what;
  if (!note_.empty()) line["note"] = note_;
  if (stages_ > 0 && begun_ > 0) {
    line["stage"] = begun_;
    line["stages"] = stages_;
  }
  line["done"] = done;
  line["total"] = 1;
  line["seconds"] = elapsed;
  line["seconds_left"] = nullptr;
  if (hasEnd(done, elapsed)) line["seconds_left"] = elapsed / done - elapsed;
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void Progress::watchAsJson(std::unique_lock<std::mutex>& hold) {
  do show(json());
  while (!ended_.wait_for(hold, milliseconds(kBetweenObjects_s), [this] { return over_; }));
}

void Progress::watch() {
  std::unique_lock<std::mutex> hold(lock_);
  if (as_ == ProgressAs::kJson) return watchAsJson(hold);
  const auto ended = [this] { return over_; };
  if (ended_.wait_for(hold, milliseconds(kQuiet_s), ended)) return;
  bool estimated = false;
  for (Clock::time_point next = Clock::now();;) {
    const double fraction = scene::seenWork().fraction;
    const bool has_end =
        hasEnd(fraction, std::chrono::duration<double>(Clock::now() - begin_).count());
    if (terminal_) {
      const int filled = static_cast<int>(kWidth * std::max(0.0, fraction));
      show(fmt::format("\r\033[K[{}{}] {} {}", std::string(filled, '#'),
                       std::string(kWidth - filled, '.'), name_, status()));
      shown_ = true;
    } else if (Clock::now() >= next || (!estimated && has_end)) {
      show(fmt::format("{}{}{}\n", name_, name_.empty() ? "" : ": ", status()));
      estimated = has_end;
      next = Clock::now() + milliseconds(kBetweenLines_s);
    }
    if (ended_.wait_for(hold, milliseconds(kBetweenBars_s), ended)) return;
  }
}

void Progress::stage(const std::string& what) {
  const std::lock_guard<std::mutex> hold(lock_);
  if (begun_ > 0 && work_) work_->done();
  ++begun_;
  stage_ = what;
  name_ = fmt::format("[{}/{}] {}", begun_, stages_, what);
  if (as_ == ProgressAs::kJson) show(json());
  if (as_ != ProgressAs::kAuto || Clock::now() < shown_from_) return;
  shown_ = true;
  if (terminal_)
    show(fmt::format("\r\033[K{}", name_));
  else
    show(name_ + "\n");
}

void Progress::note(const std::string& text) {
  const std::lock_guard<std::mutex> hold(lock_);
  note_ = text;
}

}  // namespace dynwitness::cli
