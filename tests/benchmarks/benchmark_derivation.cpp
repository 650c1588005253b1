// SPDX-License-Identifier: GPL-3.0-or-later
// How long the derivation of M, c and g takes, and how much memory, with SymPy's beside it.
#include "tests/benchmarks/benchmark_parts.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "crosscheck/inputs/states.hpp"
#include "scene/scene.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::benchmarks {
namespace {

constexpr int kChain = 50;

/// An arm of revolute joints of which nothing is parallel, centred or symmetric.
scene::Scene chain(int joints) {
  std::string text =
      "title = 'chain'\nsource = 'chosen here'\ngravity = [0, 0, -9.81]\n"
      "[[link]]\nname = 'link_0'\n";
  for (int i = 1; i <= joints; ++i)
    text += fmt::format(
        "[[link]]\nname = 'link_{}'\nparent = 'link_{}'\nmass = 1.5\ncom = [0.1, 0.2, 0.3]\n"
        "inertia = {{ about = 'com', xx = 0.1, yy = 0.2, zz = 0.25, xy = 0.01, xz = 0.02, yz = "
        "0.005 }}\n"
        "[link.joint]\nname = 'joint_{}'\nkind = 'revolute'\nxyz = [0.1, 0, 0.3]\n"
        "rpy = ['pi/2', 0, 'pi/7']\n",
        i, i - 1, i);
  return scene::readSceneToml(text, "chain.toml");
}

symbolic::Program derivedProgram(const scene::Mechanism& mechanism) {
  symbolic::Equations equations = symbolic::derive(mechanism, {});
  return symbolic::compile(equations.graph, symbolic::massCoriolisGravity(equations));
}

/// What the derivation adds to the largest resident memory of a process of its own [MB]. To be
/// asked before this process has memory that it no longer uses, which the other would inherit.
double memoryOf(const scene::Mechanism& mechanism) {
  const auto peak = [&](bool derives) {
    const pid_t process = fork();
    if (process < 0) throw std::runtime_error("no process to measure the derivation's memory in");
    if (process == 0) {
      try {
        if (derives) derivedProgram(mechanism);
        _exit(0);
      } catch (...) {
        _exit(1);
      }
    }
    rusage used{};
    int status = 0;
    while (wait4(process, &status, 0, &used) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
      throw std::runtime_error("the derivation failed where its memory was to be measured");
    return used.ru_maxrss / 1024.0;
  };
  const double before = peak(false);
  return std::max(peak(true) - before, 0.0);
}

void derive(benchmark::State& run, const scene::Scene& scene, double megabytes) {
  run.counters["MB"] = megabytes;
  for (auto _ : run) {
    const symbolic::Program program = derivedProgram(scene.mechanism);
    benchmark::DoNotOptimize(&program);
    run.counters["operations"] =
        program.bodyOperations().multiplications + program.bodyOperations().additions;
  }
}

void sympy(benchmark::State& run, const scene::Scene& scene) {
  const scene::State<double> state = crosscheck::drawState(scene.mechanism, scene.name, 1, 0);
  std::string q, qd;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    q += fmt::format("{}{}", i ? "," : "", state.x[i].q);
    qd += fmt::format("{}{}", i ? "," : "", state.qd[i]);
  }
  const std::string command = fmt::format("{} {} '{}' {} {}", DYNWITNESS_PYTHON,
                                          DYNWITNESS_SYMPY_SCRIPT, scene.file.string(), q, qd);
  for (auto _ : run) {
    std::string text;
    FILE* pipe = popen(command.c_str(), "r");
    for (int c; pipe && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    const int status = pipe ? pclose(pipe) : -1;
    if (status != 0) return run.SkipWithError("SymPy's derivation failed");
    const nlohmann::json said = nlohmann::json::parse(text);
    run.SetIterationTime(said["derivation_s"].get<double>() + said["sharing_s"].get<double>());
    run.counters["operations"] = said["operations"].get<double>();
    // the same equations? the largest difference of an entry of M, c + g, to the largest entry
    const std::vector<double> ours = symbolic::ProgramRun<double>(
        derivedProgram(scene.mechanism), scene::RealNumbers<double>(scene.mechanism))(state);
    const std::size_t n = state.qd.size();
    double difference = 0, largest = 0;
    for (std::size_t i = 0; i < n * n + n; ++i) {
      const double mine = i < n * n ? ours[i] : ours[i] + ours[i + n];
      const double its =
          i < n * n ? said["M"][i].get<double>() : said["bias"][i - n * n].get<double>();
      difference = std::max(difference, std::abs(mine - its));
      largest = std::max(largest, std::abs(mine));
    }
    run.counters["largest difference from ours, of the largest entry"] = difference / largest;
  }
}

}  // namespace

void registerDerivations(crosscheck::BenchResult* result) {
  const auto panda = std::make_shared<const scene::Scene>(scene::findScene("franka_panda"));
  const auto long_chain = std::make_shared<const scene::Scene>(chain(kChain));
  addContender(result, {"lagrange", "dynwitness", true});
  for (const auto& [name, scene] :
       {std::pair("franka_panda", panda), std::pair("chain_50", long_chain)})
    benchmark::RegisterBenchmark((std::string(name) + "/derivation/lagrange").c_str(),
                                 [scene = scene, megabytes = memoryOf(scene->mechanism)](
                                     benchmark::State& run) { derive(run, *scene, megabytes); })
        ->Unit(benchmark::kMillisecond);
  if (std::system(DYNWITNESS_PYTHON " -c 'import sympy' 2>/dev/null") != 0) {
    result->left_out.push_back(
        fmt::format("SymPy: {} has no module sympy (Debian: python3-sympy)", DYNWITNESS_PYTHON));
    return;
  }
  addContender(result, {"sympy", "SymPy, Kane's method", false});
  benchmark::RegisterBenchmark("franka_panda/derivation/sympy",
                               [panda](benchmark::State& run) { sympy(run, *panda); })
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Iterations(1)
      ->Repetitions(1);
}

}  // namespace dynwitness::benchmarks
