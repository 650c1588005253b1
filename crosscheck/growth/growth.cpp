// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/growth/growth.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/growth/ours.hpp"
#include "crosscheck/report/environment.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/states.hpp"
#include "crosscheck/truth.hpp"
#include "scene/families.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr rlim_t kMostMemory = rlim_t{8} << 30;  // of an engine [bytes]: the machine is shared

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

/// Fastest of repeated calls [ns]; a slow one is called twice.
template <typename Call>
double fastest(const Call& call) {
  constexpr int kFewest = 2, kMost = 2000;
  constexpr double kEnough = 0.1;  // [s]
  double best = std::numeric_limits<double>::infinity(), spent = 0;
  for (int k = 0; k < kFewest || (k < kMost && spent < kEnough); ++k) {
    const double start = cpuSeconds();
    call();
    const double took = cpuSeconds() - start;
    best = std::min(best, took);
    spent += took;
  }
  return best / 1e-9;
}

/// What a process sends back.
struct Numbers {
  double id_ns, fd_ns, build_ns, bytes, fd_error;
};

double errorOf(const Eigen::MatrixXd& value, const MatrixOf<Ball>* truth) {
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

/// Builds and asks; `make` returns a Witness.
template <typename Make>
Numbers measure(const Make& make, const scene::State<double>& state, const MatrixOf<Ball>* truth) {
  Numbers out{kNothing, kNothing, kNothing, kNothing, kNothing};
  const double bytes = heapBytes(), start = cpuSeconds();
  const std::unique_ptr<Witness> witness = make();
  out.build_ns = (cpuSeconds() - start) / 1e-9;
  Eigen::MatrixXd value;
  if (witness->answers(Quantity::kTau))
    out.id_ns = fastest([&] { value = witness->value(Quantity::kTau, state); });
  if (witness->answers(Quantity::kQdd)) {
    out.fd_ns = fastest([&] { value = witness->value(Quantity::kQdd, state); });
    out.fd_error = errorOf(value, truth);
  }
  value.resize(0, 0);
  out.bytes = heapBytes() - bytes;
  return out;
}

/// Runs work() in a copy of this process. @return "", or why it did not come to its end
template <typename Work>
std::string apart(const Work& work, Numbers* out) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    close(ends[0]);
    const rlimit limit = {kMostMemory, kMostMemory};
    setrlimit(RLIMIT_AS, &limit);
    int status = 1;
    try {
      const Numbers numbers = work();
      status = write(ends[1], &numbers, sizeof numbers) == sizeof numbers ? 0 : 1;
    } catch (const std::bad_alloc&) {
      status = 2;
    } catch (const std::exception&) {
    }
    _exit(status);
  }
  close(ends[1]);
  const bool is_there = read(ends[0], out, sizeof *out) == sizeof *out;
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (is_there) return "";
  if (WIFSIGNALED(status)) return fmt::format("died: {}", strsignal(WTERMSIG(status)));
  return WEXITSTATUS(status) == 2 ? "out of memory" : "refused";
}

std::vector<int> sizesUpTo(int most) {
  std::vector<int> sizes;
  for (long n = 1; n < most; n *= 4) sizes.push_back(static_cast<int>(n));
  sizes.push_back(most);
  return sizes;
}

}  // namespace

std::vector<GrowthPoint> growth(const std::vector<WitnessKind>& engines, const GrowthOptions& options,
                                const std::function<void(const std::string&)>& progress) {
  std::vector<GrowthPoint> points;
  for (const std::string& family : options.families) {
    std::set<std::string> given_up;
    for (const int links : sizesUpTo(options.most_links)) {
      if (progress) progress(fmt::format("{}_{}", family, links));
      scene::Scene scene;
      if (!scene::findFamily(fmt::format("{}_{}", family, links), &scene))
        throw std::invalid_argument(fmt::format("growth: no family {}_{}", family, links));
      const scene::State<double> state = drawState(scene.mechanism, scene.name, options.seed, 0);
      Certified truth;
      if (links <= options.most_links_with_truth)
        truth = Truth(scene.mechanism)(Quantity::kQdd, state);
      const auto add = [&](const std::string& method, const auto& make) {
        if (given_up.count(method)) return;
        GrowthPoint point{family, links, method, 0, 0, 0, 0, 0, ""};
        Numbers numbers{};
        timespec begin{}, end{};
        clock_gettime(CLOCK_MONOTONIC, &begin);
        point.failure = apart(
            [&] { return measure(make, state, truth.exists() ? &truth.value : nullptr); }, &numbers);
        clock_gettime(CLOCK_MONOTONIC, &end);
        if (!point.failure.empty()) {
          numbers = {kNothing, kNothing, kNothing, kNothing, kNothing};
          given_up.insert(method);
        }
        point.id_ns = numbers.id_ns / links;
        point.fd_ns = numbers.fd_ns / links;
        point.build_ns = numbers.build_ns / links;
        point.bytes = numbers.bytes / links;
        point.fd_error = numbers.fd_error;
        points.push_back(point);
        const double took = static_cast<double>(end.tv_sec - begin.tv_sec);
        if (took > options.patience && method != kFastMethod && method != kTextbookMethod)
          given_up.insert(method);
      };
      add(kFastMethod, [&] { return fastForGrowth(scene.mechanism); });
      add(kTextbookMethod, [&] { return textbookForGrowth(scene.mechanism); });
      for (const WitnessKind& engine : engines)
        if (engine.info.present) add(engine.info.name, [&] { return engine.make(scene); });
    }
  }
  return points;
}

std::string growthCsv(const std::vector<GrowthPoint>& points, const GrowthOptions& options) {
  std::string failures, rows;
  const auto number = [](double x, const char* format) {
    return std::isnan(x) ? std::string() : fmt::format(fmt::runtime(format), x);
  };
  for (const GrowthPoint& p : points) {
    if (!p.failure.empty())
      failures += fmt::format("# {} at {}_{}: {}\n", p.method, p.family, p.links, p.failure);
    rows += fmt::format("{},{},{},{},{},{},{},{}\n", p.family, p.links, p.method, number(p.id_ns, "{:.1f}"),
                        number(p.fd_ns, "{:.1f}"), number(p.build_ns, "{:.0f}"),
                        number(p.bytes, "{:.0f}"), number(p.fd_error, "{:.2e}"));
  }
  return fmt::format(
             "# chains and binary trees of equal links, state 0 of seed {}\n"
             "# time: CPU time of one call a link, cosines and sines included, fastest; engines through "
             "their witness\n"
             "# fd_error: largest |qdd - truth| / largest |truth|, truth certified by ball arithmetic, up to "
             "{} links\n# machine: {}\n",
             options.seed, options.most_links_with_truth, oneLine(thisEnvironment().cpu)) +
         failures +
         "family,links,method,id_ns_per_link,fd_ns_per_link,build_ns_per_link,bytes_per_link,fd_error\n" +
         rows;
}

std::string growthScript(const std::vector<GrowthPoint>& points, const std::string& family,
                         const std::string& style) {
  // colour and marker of a method as in the other charts
  static const std::map<std::string, int> kLines = {{kFastMethod, 1}, {kTextbookMethod, 5}, {"simbody", 11},
                                                    {"mujoco_principal", 12}, {"dart", 13},
                                                    {"kdl", 14}, {"mujoco", 15}};
  std::vector<std::string> methods;
  for (const GrowthPoint& p : points)
    if (p.family == family && std::find(methods.begin(), methods.end(), p.method) == methods.end())
      methods.push_back(p.method);
  const auto plot = [&](int column, bool with_titles) {
    std::string text = "plot ";
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const auto line = kLines.find(methods[i]);
      text += fmt::format(
          "{}'growth.csv' using (strcol(1) eq '{}' && strcol(3) eq {} && strlen(strcol({})) ? $2 : NaN):{} "
          "with linespoints linetype {} {}",
          i == 0 ? "" : ", \\\n     ", family, gnuplotString(methods[i]), column, column == 8 ? "8" : fmt::format("(1e-9 * ${})", column),
          line != kLines.end() ? line->second : 16,
          with_titles ? "title " + gnuplotString(methods[i]) : std::string("notitle"));
    }
    return text + "\n";
  };
  return fmt::format(
             "# Growth of forward dynamics. Draw again with:  gnuplot {0}.gp\n"
             "do for [dark = 0:1] {{\nload '{1}'\n"
             "set terminal svg size 1000,480 noenhanced\n"
             "set output dark ? '{0}_dark.svg' : '{0}.svg'\nset multiplot\n"
             "set label 1 'Forward dynamics of {2}: lower is better' at screen 0.5, screen 0.96 center "
             "textcolor rgb ink font ',15'\n"
             "set tmargin at screen 0.86\nset bmargin at screen 0.28\nset logscale xy\n"
             "set format x '1e%T'\nset micro\nset xlabel 'links'\n"
             "set key at screen 0.5, screen 0.105 center center vertical Left reverse maxrows {3}\n"
             "set lmargin at screen 0.085\nset rmargin at screen 0.47\n"
             "set title 'CPU time a link' textcolor rgb soft\nset format y '%.0s %cs'\n",
             family, style, family == "tree" ? "binary trees" : "chains", (methods.size() + 3) / 4) +
         plot(5, true) +
         "unset label\nset lmargin at screen 0.575\nset rmargin at screen 0.97\nunset key\n"
         "set title 'Error: largest |qdd - truth| / largest |truth|' textcolor rgb soft\n"
         "set format y '1e%T'\n" +
         plot(8, false) + "unset multiplot\nunset output\nreset\n}\n";
}

}  // namespace dynwitness::crosscheck
