// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/growth/growth.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/growth/ours.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/system/leaving.hpp"
#include "crosscheck/system/pipe.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "scene/families.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr rlim_t kMostMemory = rlim_t{8}
                               << 30;  // of a process [bytes]: before it takes all there is
constexpr long kMostBits = 1 << 16;    // of the certified truth: the balls of a chain take 4 a link

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double heapBytes() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  return kNothing;
#endif
}

/// A line of /proc/self/status [bytes]: "RssAnon:", memory held now; "VmHWM:", with "RssFile:" in
/// it, the most so far.
double processBytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  double kilobytes = 0;
  for (std::string word; status >> word;)
    if (word == key && status >> kilobytes) return 1024 * kilobytes;
  return kNothing;
}

/// Fastest of repeated calls [ns]. Short ones are timed together: asking the clock takes time
/// itself.
template <typename Call>
double fastest(int fewest, double enough, const Call& call) {
  constexpr double kShortest = 1.0 / 5000;  // [s]
  constexpr int kMost = 2000;
  double best = std::numeric_limits<double>::infinity(), spent = 0;
  int together = 1;
  for (int k = 0; k < fewest || (k < kMost && spent < enough); ++k) {
    const double start = cpuSeconds();
    for (int i = 0; i < together; ++i) call();
    const double took = cpuSeconds() - start;
    spent += took;
    if (took < kShortest)
      together *= 2;
    else
      best = std::min(best, took / together);
  }
  return best / 1e-9;
}

/// What a process sends back, as often as it knows more.
struct Numbers {
  double id_ns = kNothing, fd_ns = kNothing, build_ns = kNothing, bytes = kNothing,
         peak_bytes = kNothing, fd_error = kNothing;
};  // bytes: in all, not a link

double errorOf(const Eigen::MatrixXd& value, const MatrixX<Ball>* truth) {
  if (!truth) return kNothing;
  const BallPrecision precision(2 * Truth::kAccuracy);
  double size = 0, error = 0;
  for (Eigen::Index k = 0; k < truth->size(); ++k) {
    const Ball distance = Ball(value.data()[k]) - truth->data()[k];
    if (!distance.isFinite()) return std::numeric_limits<double>::infinity();
    size = std::max(size, truth->data()[k].atLeast());
    error = std::max(error, distance.atMost());
  }
  return error / size;
}

/// An outside engine, through its witness.
class Engine : public GrowthMethod {
 public:
  Engine(const WitnessKind& kind, const scene::Scene& scene) : witness_(kind.make(scene).value()) {}
  bool knowsInverse() const override { return witness_->answers(Quantity::kTau); }
  bool knowsForward() const override { return witness_->answers(Quantity::kQdd); }
  void set(const scene::State<double>& state) override { state_ = &state; }
  void inverseDynamics() override { value_ = witness_->value(Quantity::kTau, *state_); }
  void forwardDynamics() override { value_ = witness_->value(Quantity::kQdd, *state_); }
  const Eigen::MatrixXd& result() const override { return value_; }

 private:
  std::unique_ptr<Witness> witness_;
  const scene::State<double>* state_ = nullptr;
  Eigen::MatrixXd value_;
};

/// How long and how often to measure.
struct Effort {
  int builds, calls;
  double enough;  ///< [s]
};
constexpr Effort kForOurs = {3, 8, 0.15}, kForEngines = {1, 2, 0.1};

/// Builds and asks; `make` returns a GrowthMethod, `told` takes what is known so far.
template <typename Make, typename Told>
void measure(const Make& make, const scene::State<double>& state, const MatrixX<Ball>* truth,
             const Effort& effort, const Told& told) {
  Numbers out;
  std::unique_ptr<GrowthMethod> method;
  const double bytes = heapBytes(), held = processBytes("RssAnon:");
  double fastest_build = std::numeric_limits<double>::infinity(), spent = 0;
  for (int k = 0; k < effort.builds && spent < effort.enough; ++k) {
    method.reset();
    const double start = cpuSeconds();
    method = make();
    const double took = cpuSeconds() - start;
    fastest_build = std::min(fastest_build, took);
    spent += took;
  }
  out.build_ns = fastest_build / 1e-9;
  told(out);
  double of_caller = heapBytes();
  method->set(state);
  of_caller = heapBytes() - of_caller;
  if (method->knowsInverse())
    out.id_ns = fastest(effort.calls, effort.enough, [&] { method->inverseDynamics(); });
  told(out);
  if (method->knowsForward()) {
    out.fd_ns = fastest(effort.calls, effort.enough, [&] { method->forwardDynamics(); });
    out.fd_error = errorOf(method->result(), truth);
  }
  out.bytes = heapBytes() - bytes - of_caller;
  out.peak_bytes = processBytes("VmHWM:") - processBytes("RssFile:") - held;
  told(out);
}

/// Runs work(told) in a copy of this process. @return "", or why it did not come to its end
template <typename Work>
std::string apart(const Work& work, int patience, Numbers* out) {
  Pipe answers;
  if (!answers.isOpen()) throw std::runtime_error("no pipe");
  pid_t child;
  EndsWithUs ends_with_us;
  {
    const SignalsHeld held;
    const pid_t self = getpid();
    child = fork();
    if (child == 0)
      endWithParent(self);
    else if (child > 0)
      ends_with_us = EndsWithUs(child, SIGTERM);
  }
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    answers.closeEnd(0);
    const rlimit memory = {kMostMemory, kMostMemory};
    setrlimit(RLIMIT_AS, &memory);
    const rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    if (patience > 0) {
      const rlimit time = {static_cast<rlim_t>(patience), static_cast<rlim_t>(patience) + 1};
      setrlimit(RLIMIT_CPU, &time);
    }
    int status = 0;
    try {
      work([&](const Numbers& numbers) {
        if (write(answers.ends[1], &numbers, sizeof numbers) != sizeof numbers)
          throw std::runtime_error("no pipe");
      });
    } catch (const std::bad_alloc&) {
      status = 2;
    } catch (const std::exception&) {
      status = 1;
    }
    _exit(status);
  }
  answers.closeEnd(1);
  int stages = 0;
  const auto next = [&](Numbers* numbers) {  // a few doubles: they come in one piece or not at all
    ssize_t count;
    while ((count = read(answers.ends[0], numbers, sizeof *numbers)) < 0 && errno == EINTR) {
    }
    return count == sizeof *numbers;
  };
  for (Numbers numbers; next(&numbers); ++stages) *out = numbers;
  const int status = reap(child);
  constexpr const char* kStages[] = {"building", "inverse dynamics", "forward dynamics", "the end"};
  const std::string at = kStages[std::min(stages, 3)];
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return fmt::format("{}: given up after {} s of CPU time", at, patience);
  if (WIFSIGNALED(status)) return fmt::format("{}: died: {}", at, strsignal(WTERMSIG(status)));
  if (WEXITSTATUS(status) == 2) return at + ": out of memory";
  return WEXITSTATUS(status) == 0 ? "" : at + ": refused";
}

/// One family at one size: what all methods are asked.
struct Question {
  Question(const std::string& family, int links, const GrowthOptions& options) {
    const std::string name = fmt::format("{}_{}", family, links);
    malloc_trim(0);  // what earlier sizes freed would be taken again and not be seen
    scene_bytes = processBytes("RssAnon:");
    scene_ns = fastest(1, kForOurs.enough, [&] {
      scene = {};
      if (!scene::findFamily(name, &scene))
        throw std::invalid_argument("growth: no family " + name);
    });
    state = drawState(scene.mechanism, scene.name, options.seed, 0);
    scene_bytes = processBytes("RssAnon:") - scene_bytes;
    if (links <= options.most_links_with_truth)
      truth = Truth(scene.mechanism, Truth::kAccuracy, kMostBits)(Quantity::kQdd, state);
    malloc_trim(0);
  }
  scene::Scene scene;
  scene::State<double> state;
  Certified truth;
  double scene_ns = 0, scene_bytes = 0;
};

}  // namespace

std::vector<int> growthSizes(int most_links) {
  std::vector<int> sizes;
  for (long n = 1; n < most_links; n *= 4) sizes.push_back(static_cast<int>(n));
  sizes.push_back(most_links);
  return sizes;
}

std::vector<GrowthPoint> growth(const std::vector<WitnessKind>& engines,
                                const GrowthOptions& options,
                                const std::function<void(const std::string&)>& progress) {
  std::vector<GrowthPoint> points;
  for (const std::string& family : options.families) {
    std::set<std::string> given_up;
    for (const int links : growthSizes(options.most_links)) {
      if (progress) progress(fmt::format("{}_{}", family, links));
      const Question question(family, links, options);
      const auto add = [&](const std::string& method, const Effort& effort, int patience,
                           const auto& make) {
        if (given_up.count(method)) return;
        GrowthPoint point{family, links, method};
        Numbers numbers;
        const MatrixX<Ball>* truth = question.truth.exists() ? &question.truth.value : nullptr;
        point.failure =
            apart([&](const auto& told) { measure(make, question.state, truth, effort, told); },
                  patience, &numbers);
        if (!point.failure.empty()) given_up.insert(method);
        point.id_ns = numbers.id_ns / links;
        point.fd_ns = numbers.fd_ns / links;
        point.scene_ns = question.scene_ns / links;
        point.build_ns = numbers.build_ns / links;
        point.bytes = links < kGrowthBytesFrom ? kNothing : numbers.bytes / links;
        point.peak_bytes = links < kGrowthPeakFrom
                               ? kNothing
                               : (numbers.peak_bytes + question.scene_bytes) / links;
        point.fd_error = numbers.fd_error;
        points.push_back(point);
      };
      const scene::Scene& scene = question.scene;
      add(kFastMethod, kForOurs, 0, [&] { return fastForGrowth(scene.mechanism); });
      add(kTextbookMethod, kForOurs, 0, [&] { return textbookForGrowth(scene.mechanism); });
      for (const WitnessKind& engine : engines)
        if (engine.info.present)
          add(engine.info.name, kForEngines, options.patience,
              [&] { return std::make_unique<Engine>(engine, scene); });
    }
  }
  return points;
}

}  // namespace dynwitness::crosscheck
