// SPDX-License-Identifier: GPL-3.0-or-later
// `./dynwitness bench`: runs the benchmarks, prints the tables and keeps what was measured.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/report.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/error.hpp"
#include "tests/benchmarks/benchmark_goals.hpp"
#include "tests/benchmarks/benchmark_parts.hpp"

namespace {

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace fs = std::filesystem;

constexpr const char* kUsage =
    R"(usage: dynwitness bench [--output FOLDER] [--engine COMMAND]... [--benchmark_...=VALUE]

Times inverse dynamics (ID), the mass matrix (M) and forward dynamics (FD) of an arm and a humanoid by
our sweeps and kernels, made by two compilers, beside the engines, all in one run on the same states;
whole steps of trees and of closed loops (step: semi-implicit Euler; RK4 step), beside the engines' own;
first derivatives (dtau, dqdd) by sweeps and by dual numbers, second ones (d2tau); the derivation, with
SymPy's beside it; making a kernel; a whole crosscheck. Counts operations of kernels. Prints ratios to MuJoCo and to Simbody,
and for every goal whether it is reached or by how much it is missed, and how far from what one core of
this machine could do at its best (operations a second, bytes read and written a second, measured in the
same run). Takes some minutes.

Repetitions come in random order, so that a busy moment of the machine does not hit one contender
alone, and the fastest counts.

  --output FOLDER   where files are kept [{}]
                      bench.json             what was measured, ratios, goals
                      bench.csv, bench.gp, bench.svg
                      google_benchmark.json  every repetition
  --engine COMMAND  a program of yours as one more contender: a shell's words, "python3 my_arm.py". It answers
                    lines of JSON (crosscheck/witnesses/engine_protocol.md). Its time is wall time a state
                    in batches of {}, with all that is said and read on both sides; goals are none of its
  --engine-seconds S  time that such a program has for one answer [{}]
  --engine-memory GB  address space that each of its processes may have [{}]
  --help            this text

Options of google-benchmark are passed on; these are the useful ones:
  --benchmark_filter=REGEX     SCENE/FORMULA/CONTENDER, as franka_panda/ID/, /dtau/, step/ or /fast;
                               machine/ is what limits are made of: "machine/|/dtau/"
  --benchmark_list_tests=true  which there are
  --benchmark_repetitions=N    [{}]
  --benchmark_min_time=S       of a repetition [{}]

Exit status: 0 whether goals are reached or missed; 2 bad usage; 3 a benchmark failed.

The report shows the result:
  ./dynwitness crosscheck --bench {}/bench.json
)";
constexpr int kRepetitions = 15;
constexpr const char* kMinTime = "0.02";  // [s]

/// Keeps the fastest of each name; prints nothing.
class Collector : public benchmark::BenchmarkReporter {
 public:
  explicit Collector(BenchResult* result) : result_(result) {}

  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const std::string& name = run.run_name.function_name;
      if (run.error_occurred) {
        if (failed_.insert(name).second) fmt::print(stderr, "{}: {}\n", name, run.error_message);
        continue;
      }
      const std::size_t first = name.find('/'), last = name.rfind('/');
      Measurement m{name.substr(first + 1, last - first - 1), name.substr(0, first),
                    name.substr(last + 1), benchmark::GetTimeUnitString(run.time_unit), 0};
      // "manual_time" or "real_time", else CPU time is meant
      m.value =
          run.run_name.time_type.empty() ? run.GetAdjustedCPUTime() : run.GetAdjustedRealTime();
      for (const auto& [counter, number] : run.counters) {
        if (counter == benchmarks::kStatesCounter)
          m.value /= number.value;
        else
          keep({m.what, m.subject, m.by, counter, number.value});
      }
      keep(m);
      result_->repetitions = std::max(result_->repetitions, static_cast<int>(run.repetitions));
    }
  }
  bool failed() const { return !failed_.empty(); }

 private:
  void keep(const Measurement& m) {
    const double value = std::strtod(fmt::format("{:.5g}", m.value).c_str(), nullptr);
    for (Measurement& known : result_->measured)
      if (known.what == m.what && known.subject == m.subject && known.by == m.by &&
          known.unit == m.unit) {
        known.value = std::min(known.value, value);
        return;
      }
    result_->measured.push_back(m);
    result_->measured.back().value = value;
  }

  BenchResult* result_;
  std::set<std::string> failed_;
};

/// The order of the tables instead of the random one of the run.
void sort(BenchResult* result) {
  const auto place = [&](const Measurement& m) {
    const auto formula =
        std::find(std::begin(kTimed), std::end(kTimed), m.what) - std::begin(kTimed);
    const auto by = std::find_if(result->contenders.begin(), result->contenders.end(),
                                 [&](const Contender& c) { return c.name == m.by; });
    const auto who = by - result->contenders.begin();
    return std::tuple(m.unit != "ns", m.subject, formula, m.what, who, m.unit);
  };
  std::sort(result->measured.begin(), result->measured.end(),
            [&](const Measurement& a, const Measurement& b) { return place(a) < place(b); });
}

/// Whole files or none.
void write(const BenchResult& result, const fs::path& folder) {
  const UnfinishedFolder work(folder);  // vanishes again
  const std::string style = "dynwitness_style.gp";
  work.write("bench.json", benchJson(result));
  work.write(style, kStyleGnuplot);
  const BenchFiles files = writeBenchChart(result, work, "", style);
  for (const std::string& file :
       {std::string("bench.json"), style, files.csv, files.script, files.picture}) {
    if (file.empty()) continue;
    std::ifstream stream(work.path() / file, std::ios::binary);
    writeWholeFile(folder / file, std::string(std::istreambuf_iterator<char>(stream), {}));
  }
  if (files.picture.empty()) fmt::print(stderr, "no picture: {}\n", files.no_plot_reason);
}

std::vector<Environment::Library> engines() {
  std::vector<Environment::Library> all;
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.version != DYNWITNESS_VERSION)
      all.push_back({kind.info.name, kind.info.present ? kind.info.version : "absent"});
  return all;
}

/// Of an option that is one of ours.
double numberIn(const std::string& option, const std::string& text, double least, double most) {
  char* end = nullptr;
  const double x = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !(x >= least && x <= most))
    throw scene::InputError({}, fmt::format("bench: {}: got '{}', allowed: a number from {} to {}",
                                            option, text, least, most));
  return x;
}

int run(int argc, char** argv) {
  std::string output = DYNWITNESS_BENCH_FOLDER;
  std::vector<std::string> engines_asked;
  Limits limits;
  bool limits_given = false;
  std::vector<std::string> words = {argv[0], "--benchmark_enable_random_interleaving=true",
                                    fmt::format("--benchmark_repetitions={}", kRepetitions),
                                    fmt::format("--benchmark_min_time={}", kMinTime)};
  bool only_lists = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      fmt::print(kUsage, DYNWITNESS_BENCH_FOLDER, kEngineBatch, limits.seconds, limits.gigabytes,
                 kRepetitions, kMinTime, DYNWITNESS_BENCH_FOLDER);
      return 0;
    }
    // "--option=VALUE" or "--option VALUE"
    const auto given = [&](const std::string& option,
                           const char* what) -> std::optional<std::string> {
      if (word.rfind(option + "=", 0) == 0) return word.substr(option.size() + 1);
      if (word != option) return {};
      if (++i == argc)
        throw scene::InputError({}, fmt::format("bench: {}: expected {}", option, what));
      return argv[i];
    };
    if (const auto folder = given("--output", "a folder")) {
      output = *folder;
    } else if (const auto command = given("--engine", "a command")) {
      engines_asked.push_back(*command);
    } else if (const auto seconds = given("--engine-seconds", "a time")) {
      limits.seconds = numberIn("--engine-seconds", *seconds, 0.1, 86400);
      limits_given = true;
    } else if (const auto memory = given("--engine-memory", "a size")) {
      limits.gigabytes = numberIn("--engine-memory", *memory, 0.01, 1000000);
      limits_given = true;
    } else if (word.rfind("--benchmark_", 0) == 0) {
      only_lists = only_lists || word.rfind("--benchmark_list_tests", 0) == 0;
      words.push_back(word);
    } else {
      throw scene::InputError(
          {}, fmt::format("bench: '{}': allowed are --output FOLDER, --engine COMMAND, "
                          "--engine-seconds, --engine-memory, --help and "
                          "google-benchmark's --benchmark_...",
                          word));
    }
  }
  if (limits_given && engines_asked.empty())
    throw scene::InputError({},
                            "bench: --engine-seconds or --engine-memory without a program, "
                            "allowed: with --engine");
  requireWritableFolder(output);

  BenchResult result;
  result.environment = thisEnvironment(engines());
  result.processors = availableProcessors();
  getloadavg(&result.load, 1);
  result.states = benchmarks::kStates;
  result.seed = benchmarks::kSeed;
  result.goals = benchmarks::goals();
  // first: it asks how much memory a derivation takes, before there is some that lies idle
  benchmarks::registerDerivations(&result);
  benchmarks::registerMachine();
  benchmarks::registerSweeps(&result);
  benchmarks::registerSteps(&result);
  benchmarks::registerDerivatives(&result);
  benchmarks::registerStarts(&result);
  benchmarks::registerEngines(&result, engines_asked, limits);

  // every repetition is kept beside our own file, unless the caller says where
  const fs::path raw = fs::path(output) / "google_benchmark.json",
                 unfinished = raw.string() + ".unfinished";
  if (!only_lists) {
    fs::create_directories(output);
    words.insert(words.begin() + 1, "--benchmark_out=" + unfinished.string());
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  Collector collector(&result);
  if (!only_lists)
    fmt::print(stderr, "dynwitness: timing, which takes some minutes (--help says what)\n");
  benchmark::RunSpecifiedBenchmarks(&collector);
  if (only_lists) return 0;
  std::error_code elsewhere;
  if (result.measured.empty()) {
    fs::remove(unfinished, elsewhere);
    fmt::print(stderr, "dynwitness: nothing was measured\n");
    return collector.failed() ? 3 : 2;
  }
  fs::rename(unfinished, raw, elsewhere);
  sort(&result);
  fmt::print("{}", benchText(result));
  write(result, output);
  fmt::print(
      "\nkept in {0}; to see it in a report:\n  ./dynwitness crosscheck --bench {0}/bench.json\n",
      output);
  return collector.failed() ? 3 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const scene::InputError& error) {
    fmt::print(stderr, "dynwitness: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "dynwitness: {}\n", error.what());
    return 3;
  }
}
