// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmark_derivation.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crosscheck/states.hpp"
#include "scene/scene.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::benchmarks {
namespace {

constexpr const char* kPrefix = "derivation/";
constexpr int kChain = 50;

/// An arm of revolute joints of which nothing is parallel, centred or symmetric.
scene::Scene chain(int joints) {
  std::string text = "title = 'chain'\nsource = 'chosen here'\ngravity = [0, 0, -9.81]\n"
                     "[[link]]\nname = 'link_0'\n";
  for (int i = 1; i <= joints; ++i)
    text += fmt::format(
        "[[link]]\nname = 'link_{}'\nparent = 'link_{}'\nmass = 1.5\ncom = [0.1, 0.2, 0.3]\n"
        "inertia = {{ about = 'com', xx = 0.1, yy = 0.2, zz = 0.25, xy = 0.01, xz = 0.02, yz = 0.005 }}\n"
        "[link.joint]\nname = 'joint_{}'\nkind = 'revolute'\nxyz = [0.1, 0, 0.3]\n"
        "rpy = ['pi/2', 0, 'pi/7']\n",
        i, i - 1, i);
  return scene::readSceneToml(text, "chain.toml");
}

symbolic::Program derivedProgram(const scene::Mechanism& mechanism) {
  symbolic::Equations equations = symbolic::derive(mechanism, {});
  return symbolic::compile(equations.graph, symbolic::massCoriolisGravity(equations));
}

/// What the derivation adds to the largest resident memory of a process of its own [MB]. To be asked
/// before this process has memory that it no longer uses, which the other would inherit.
double memoryOf(const scene::Mechanism& mechanism) {
  const auto peak = [&](bool derives) {
    const pid_t process = fork();
    if (process == 0) {
      if (derives) derivedProgram(mechanism);
      _exit(0);
    }
    rusage used{};
    wait4(process, nullptr, 0, &used);
    return used.ru_maxrss / 1024.0;
  };
  const double before = peak(false);
  return peak(true) - before;
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
  const std::string command = fmt::format("{} {} '{}' {} {}", DYNWITNESS_PYTHON, DYNWITNESS_SYMPY_SCRIPT,
                                          scene.file.string(), q, qd);
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
    const std::vector<double> ours =
        symbolic::ProgramRun<double>(derivedProgram(scene.mechanism),
                                     scene::RealNumbers<double>(scene.mechanism))(state);
    const std::size_t n = state.qd.size();
    double difference = 0, largest = 0;
    for (std::size_t i = 0; i < n * n + n; ++i) {
      const double mine = i < n * n ? ours[i] : ours[i] + ours[i + n];
      const double its = i < n * n ? said["M"][i].get<double>() : said["bias"][i - n * n].get<double>();
      difference = std::max(difference, std::abs(mine - its));
      largest = std::max(largest, std::abs(mine));
    }
    run.counters["difference"] = difference / largest;
  }
}

struct Measured {
  double seconds, megabytes, operations, difference;
};
std::map<std::string, Measured>& measured() {
  static std::map<std::string, Measured> all;
  return all;
}

struct Goal {
  const char* name;
  double seconds, megabytes;
};
constexpr Goal kGoals[] = {{"derivation/franka_panda", 0.020, 50}, {"derivation/chain_50", 0.5, 50}};

}  // namespace

void registerDerivations() {
  const auto panda = std::make_shared<const scene::Scene>(scene::findScene("franka_panda"));
  const auto long_chain = std::make_shared<const scene::Scene>(chain(kChain));
  for (const auto& [name, scene] : {std::pair("franka_panda", panda), std::pair("chain_50", long_chain)})
    benchmark::RegisterBenchmark((std::string(kPrefix) + name).c_str(),
                                 [scene = scene, megabytes = memoryOf(scene->mechanism)](
                                     benchmark::State& run) { derive(run, *scene, megabytes); })
        ->Unit(benchmark::kMillisecond);
  if (std::system(DYNWITNESS_PYTHON " -c 'import sympy' 2>/dev/null") != 0) {
    std::fprintf(stderr, "SymPy is left out: %s has no module sympy (install python3-sympy)\n",
                 DYNWITNESS_PYTHON);
    return;
  }
  benchmark::RegisterBenchmark("derivation/franka_panda/sympy",
                               [panda](benchmark::State& run) { sympy(run, *panda); })
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Iterations(1);
}

bool keepDerivation(const benchmark::BenchmarkReporter::Run& run) {
  const std::string& name = run.run_name.function_name;
  if (name.rfind(kPrefix, 0) != 0) return false;
  const auto counter = [&](const char* key) {
    const auto it = run.counters.find(key);
    return it == run.counters.end() ? std::nan("") : it->second.value;
  };
  const double seconds = (name.find("sympy") == std::string::npos ? run.GetAdjustedCPUTime()
                                                                  : run.GetAdjustedRealTime()) / 1e3;
  const auto [it, is_new] = measured().emplace(
      name, Measured{seconds, counter("MB"), counter("operations"), counter("difference")});
  if (!is_new) it->second.seconds = std::min(it->second.seconds, seconds);
  return true;
}

void printDerivations() {
  if (measured().empty()) return;
  std::printf("\n%-34s %12s %12s %12s\n", "derivation of M, c, g", "CPU ms", "MB", "operations");
  for (const auto& [name, run] : measured()) {
    std::printf("%-34s %12.1f ", name.c_str() + std::string(kPrefix).size(), run.seconds * 1e3);
    if (std::isnan(run.megabytes)) std::printf("%12s ", "");
    else std::printf("%12.1f ", run.megabytes);
    std::printf("%12.0f", run.operations);
    for (const Goal& goal : kGoals)
      if (goal.name == name)
        std::printf("  goal %.0f ms, %.0f MB: %s", goal.seconds * 1e3, goal.megabytes,
                    run.seconds <= goal.seconds && run.megabytes <= goal.megabytes ? "reached" : "MISSED");
    if (!std::isnan(run.difference))
      std::printf("  differs from ours by %.1g of the largest entry", run.difference);
    std::printf("\n");
  }
}

}  // namespace dynwitness::benchmarks
