// SPDX-License-Identifier: GPL-3.0-or-later
// How long a user waits who has nothing yet: for a scene's kernel, and for the first crosscheck;
// and how many operations a kernel takes.
#include "tests/benchmarks/benchmark_parts.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/scene.hpp"
#include "tests/benchmarks/benchmark_kernels.hpp"
#include "tests/fixtures/counted_arms.hpp"
#include "tests/fixtures/files.hpp"

namespace dynwitness::benchmarks {
namespace {

namespace fs = std::filesystem;
using namespace crosscheck;
using files::TemporaryFolder;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// From the scene in memory to its three functions, ready to be called, with nothing in the cache.
void makeKernel(benchmark::State& run, const std::string& name, const KernelCompiler& compiler) {
  const scene::Scene scene = scene::findScene(name), other = scene::findScene("simple_pendulum");
  for (auto _ : run) {
    const TemporaryFolder cache;
    const KernelEnvironment environment(compiler.command, cache.path.string());
    const double start = seconds();
    const kernel::SmallestRoads roads(scene.mechanism);
    for (const kernel::Formula formula : kernel::KernelOptions().formulas) roads(formula);
    const double traced = seconds();
    const kernel::Kernel kernel(roads);
    benchmark::DoNotOptimize(&kernel);
    const double made = seconds();
    run.SetIterationTime(made - start);
    run.counters["s to compile and load"] = made - traced;
  }
}

/// How many operations the smallest program takes, and how long it is looked for.
void countOperations(benchmark::State& run, const counted::Fewest& fewest) {
  const scene::Scene scene = fewest.make();
  for (auto _ : run) {
    const symbolic::Program program = kernel::smallestRoad(scene.mechanism, fewest.formula).program;
    const symbolic::Program::Operations o = program.bodyOperations();
    run.counters["multiplications"] = o.multiplications;
    run.counters["additions"] = o.additions;
    run.counters["operations"] = o.multiplications + o.additions;
  }
}

/// The program from its start to its end, the report written.
void crosscheckOf(benchmark::State& run, const char* scene) {
  const TemporaryFolder folder;
  const std::string report = (folder.path / "report").string(),
                    log = (folder.path / "log").string();
  for (auto _ : run) {
    const double start = seconds();
    const pid_t process = fork();
    if (process == 0) {
      if (std::freopen(log.c_str(), "w", stdout) && std::freopen(log.c_str(), "a", stderr))
        execl(DYNWITNESS_PROGRAM, "dynwitness", "crosscheck", scene, "-o", report.c_str(),
              static_cast<char*>(nullptr));
      _exit(127);
    }
    if (process < 0) return run.SkipWithError("no process");
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    run.SetIterationTime(seconds() - start);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
      return run.SkipWithError("the crosscheck failed");
  }
}

}  // namespace

void registerStarts(BenchResult* result) {
  for (const KernelCompiler& compiler : kernelCompilers())
    benchmark::RegisterBenchmark(
        (std::string("franka_panda/making/kernel") + compiler.suffix).c_str(),
        [=](benchmark::State& run) { makeKernel(run, "franka_panda", compiler); })
        ->Unit(benchmark::kSecond)
        ->UseManualTime()
        ->Iterations(1)
        ->Repetitions(3);
  addContender(result, {"program", "the smallest program", true});
  for (const counted::Fewest& fewest : counted::fewest())
    benchmark::RegisterBenchmark(
        fmt::format("{}/count of {}/program", fewest.arm, kernel::name(fewest.formula)).c_str(),
        [=](benchmark::State& run) { countOperations(run, fewest); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1)
        ->Repetitions(1);
  addContender(result, {"dynwitness", "dynwitness, the whole process", true});
  benchmark::RegisterBenchmark("double pendulum/crosscheck/dynwitness",
                               [](benchmark::State& run) { crosscheckOf(run, "double pendulum"); })
      ->Unit(benchmark::kSecond)
      ->UseManualTime()
      ->Iterations(1);
}

}  // namespace dynwitness::benchmarks
