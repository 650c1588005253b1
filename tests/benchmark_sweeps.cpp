// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse dynamics, mass matrix and forward dynamics: our sweeps and the scene's own kernel beside the
// engines, in one run on the same states. Read the ratios, not the nanoseconds.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <mutex>
#include <optional>

#include "benchmark_derivation.hpp"
#include "benchmark_mujoco.hpp"
#include "fast_by_compiler.hpp"
#include "crosscheck/crosscheck.hpp"
#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/processes.hpp"
#include "crosscheck/states.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace {

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using kernel::Formula;

constexpr int kStates = 1000;
constexpr std::uint64_t kSeed = 1;

/// A scene's model and states.
struct Arm {
  explicit Arm(const char* name)
      : scene(scene::findScene(name)),
        setup(recursive::buildModel(scene.mechanism,
                                    scene::RealNumbers<double>(scene.mechanism))),
        M(setup.model.dof(), setup.model.dof()),
        out(setup.model.dof()) {
    for (int k = 0; k < kStates; ++k)
      states.push_back(drawState(scene.mechanism, scene.name, kSeed, k));
  }
  const scene::State<double>& next() { return states[index = (index + 1) % kStates]; }

  scene::Scene scene;
  Setup<double> setup;
  std::vector<scene::State<double>> states;
  recursive::MatrixX<double> M;
  std::vector<double> out;
  int index = 0;
};

/// Sweeps read cos q and sin q, engines compute them: the sweeps pay for them here as well.
const std::vector<scene::JointPosition<double>>& positions(
    const scene::State<double>& state, std::vector<scene::JointPosition<double>>& room) {
  room.resize(state.x.size());
  for (std::size_t i = 0; i < room.size(); ++i) room[i] = scene::jointPosition(state.x[i].q);
  return room;
}

void inverseDynamics(benchmark::State& run, const char* scene) {
  Arm arm(scene);
  std::vector<scene::JointPosition<double>> x;
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    recursive::inverseDynamics(arm.setup.model, positions(s, x), s.qd, s.qdd, arm.setup.ws, arm.out);
    benchmark::DoNotOptimize(arm.out.data());
  }
}

void massMatrix(benchmark::State& run, const char* scene) {
  Arm arm(scene);
  std::vector<scene::JointPosition<double>> x;
  for (auto _ : run) {
    recursive::massMatrix(arm.setup.model, positions(arm.next(), x), arm.setup.ws, arm.M);
    benchmark::DoNotOptimize(arm.M.data());
  }
}

void forwardDynamics(benchmark::State& run, const char* scene) {
  Arm arm(scene);
  std::vector<scene::JointPosition<double>> x;
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    recursive::forwardDynamics(arm.setup.model, positions(s, x), s.qd, s.tau, arm.setup.ws, arm.out);
    benchmark::DoNotOptimize(arm.out.data());
  }
}

/// Positions alone, as the general sweeps for speed and the kernels take them.
std::vector<std::vector<double>> positionsOf(const Arm& arm) {
  std::vector<std::vector<double>> q(kStates);
  for (int k = 0; k < kStates; ++k)
    for (const scene::JointPosition<double>& x : arm.states[k].x) q[k].push_back(x.q);
  return q;
}

void fast(benchmark::State& run, const char* scene, const benchmarks::FastBy* by, Formula formula) {
  Arm arm(scene);
  const std::vector<std::vector<double>> q = positionsOf(arm);
  void* const sweeps = by->make(&arm.setup.model);
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    const double *x = q[arm.index].data(), *qd = s.qd.data();
    if (formula == Formula::kMassMatrix) by->massMatrix(sweeps, x, arm.M.data());
    else if (formula == Formula::kForwardDynamics)
      by->forwardDynamics(sweeps, x, qd, s.tau.data(), arm.out.data());
    else by->inverseDynamics(sweeps, x, qd, s.qdd.data(), arm.out.data());
    benchmark::DoNotOptimize(arm.out.data());
    benchmark::ClobberMemory();
  }
  by->release(sweeps);
}

void engine(benchmark::State& run, const char* scene, const WitnessKind& kind, Quantity quantity) {
  Arm arm(scene);
  const std::unique_ptr<Witness> witness = kind.make(arm.scene);
  for (auto _ : run) benchmark::DoNotOptimize(witness->value(quantity, arm.next()));
}

// ---- kernels ------------------------------------------------------------------------------------

/// The formula alone, so that one that takes the compiler long does not hold up the others.
kernel::Kernel kernelOf(const scene::Scene& scene, Formula formula) {
  kernel::KernelOptions options;
  options.formulas = {formula};
  return kernel::Kernel(scene.mechanism, options);
}

void call(const kernel::Kernel& kernel, Formula formula, const double* q, const double* qd,
          const scene::State<double>& s, double* out) {
  switch (formula) {
    case Formula::kMassMatrix: return kernel.massMatrix(q, out);
    case Formula::kForwardDynamics: return kernel.forwardDynamics(q, qd, s.tau.data(), out);
    default: return kernel.inverseDynamics(q, qd, s.qdd.data(), out);
  }
}

void kernelOne(benchmark::State& run, const char* scene, Formula formula) {
  Arm arm(scene);
  const kernel::Kernel kernel = kernelOf(arm.scene, formula);
  const std::vector<std::vector<double>> q = positionsOf(arm);
  std::vector<double> out(static_cast<std::size_t>(kernel.dof()) * kernel.dof());
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    call(kernel, formula, q[arm.index].data(), s.qd.data(), s, out.data());
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
}

/// All states in one call, component by component; the table divides by their number. In several
/// threads each has its own states; kernels are made one at a time, since GiNaC knows no threads.
void kernelMany(benchmark::State& run, const char* scene, Formula formula) {
  static std::mutex making;
  std::unique_lock<std::mutex> lock(making);
  Arm arm(scene);
  const kernel::Kernel kernel = kernelOf(arm.scene, formula);
  const std::size_t n = kernel.dof();
  lock.unlock();
  std::vector<double> q(arm.states[0].x.size() * kStates), qd(n * kStates), w(qd),
      out(n * n * kStates);
  for (int k = 0; k < kStates; ++k) {
    const scene::State<double>& s = arm.states[k];
    for (std::size_t i = 0; i < s.x.size(); ++i) q[i * kStates + k] = s.x[i].q;
    for (std::size_t i = 0; i < n; ++i) {
      qd[i * kStates + k] = s.qd[i];
      w[i * kStates + k] = formula == Formula::kForwardDynamics ? s.tau[i] : s.qdd[i];
    }
  }
  for (auto _ : run) {
    if (formula == Formula::kMassMatrix)
      kernel.massMatrix(q.data(), out.data(), kStates);
    else if (formula == Formula::kForwardDynamics)
      kernel.forwardDynamics(q.data(), qd.data(), w.data(), out.data(), kStates);
    else
      kernel.inverseDynamics(q.data(), qd.data(), w.data(), out.data(), kStates);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
}

#ifdef DYNWITNESS_HAS_MUJOCO
void mujocoRaw(benchmark::State& run, const char* scene, Formula formula) {
  Arm arm(scene);
  benchmarks::RawMujoco mujoco(arm.scene);
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    if (formula == Formula::kMassMatrix) mujoco.massMatrix(s);
    else if (formula == Formula::kForwardDynamics) mujoco.forwardDynamics(s);
    else mujoco.inverseDynamics(s, arm.out.data());
    benchmark::DoNotOptimize(mujoco.results());
    benchmark::ClobberMemory();
  }
}
#endif

// ---- the table ----------------------------------------------------------------------------------

constexpr const char* kEngine = "mujoco_raw";
constexpr const char* kLanes = "kernel_lanes";
constexpr const char* kAllCores = "kernel_all_cores";
constexpr const char* kSecond = "fast_second";

/// How many times faster than MuJoCo, called raw, something is to be.
struct Goal {
  const char *scene, *formula, *way;
  double times;
};
constexpr Goal kGoals[] = {
    {"franka_panda", "ID", "fast", 5.8},      {"franka_panda", "ID", kSecond, 5.8},
    {"franka_panda", "M", "fast", 5.4},       {"franka_panda", "M", kSecond, 5.4},
    {"franka_panda", "FD", "fast", 3.4},      {"franka_panda", "FD", kSecond, 3.4},
    {"humanoid", "ID", "fast", 4.8},          {"humanoid", "ID", kSecond, 4.8},
    {"humanoid", "M", "fast", 4.4},           {"humanoid", "M", kSecond, 4.4},
    {"humanoid", "FD", "fast", 3.5},          {"humanoid", "FD", kSecond, 3.5},
    {"franka_panda", "ID", "kernel", 12},     {"franka_panda", "M", "kernel", 12},
    {"franka_panda", "FD", "kernel", 8},      {"franka_panda", "ID", kLanes, 50},
    {"franka_panda", "FD", kLanes, 25}};

/// Prints what google-benchmark prints, and keeps the fastest time of each name.
class Table : public benchmark::ConsoleReporter {
 public:
  using ConsoleReporter::ConsoleReporter;
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.error_occurred || run.run_type != Run::RT_Iteration) continue;
      if (benchmarks::keepDerivation(run)) continue;
      const std::string name = run.run_name.function_name;
      const std::string way = name.substr(name.rfind('/') + 1);
      // several threads: wall time over the calls of all
      double ns = way == kAllCores ? run.GetAdjustedRealTime() : run.GetAdjustedCPUTime();
      if (way == kLanes || way == kAllCores) ns /= kStates;
      const auto [it, is_new] = ns_.emplace(name, ns);
      if (!is_new) it->second = std::min(it->second, ns);
    }
    ConsoleReporter::ReportRuns(runs);
  }

  void print() const {
    std::printf("\n%-34s %12s %22s\n", "ns a state, fastest", "", "faster than MuJoCo raw");
    for (const auto& [name, ns] : ns_) {
      const std::optional<double> engine = engineFor(name);
      std::printf("%-34s %12.1f", name.c_str(), ns);
      if (engine) std::printf(" %19.1f x", *engine / ns);
      std::printf("\n");
    }
    std::printf("\n%-34s %12s %12s\n", "goals, times MuJoCo raw", "goal", "measured");
    for (const Goal& goal : kGoals) {
      const std::string name = std::string(goal.scene) + "/" + goal.formula + "/" + goal.way;
      const auto it = ns_.find(name);
      const std::optional<double> engine = engineFor(name);
      std::printf("%-34s %12.1f ", name.c_str(), goal.times);
      if (it == ns_.end() || !engine) {
        std::printf("%12s  not measured\n", "-");
        continue;
      }
      const double times = *engine / it->second;
      if (times >= goal.times) std::printf("%12.1f  reached\n", times);
      else std::printf("%12.1f  MISSED: takes %.0f %% too long\n", times, 100 * (goal.times / times - 1));
    }
  }

 private:
  std::optional<double> engineFor(const std::string& name) const {
    const auto it = ns_.find(name.substr(0, name.rfind('/') + 1) + kEngine);
    if (it == ns_.end()) return std::nullopt;
    return it->second;
  }
  std::map<std::string, double> ns_;
};

/// Whether kernels can be made here; if not, the reason is told.
bool kernelsAreThere() {
  try {
    kernel::findCompiler();
    kernel::cacheFolder();
    return true;
  } catch (const kernel::CannotCompile& error) {
    std::fprintf(stderr, "kernels are left out: %s\n", error.what());
    return false;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool with_kernels = kernelsAreThere();
  for (const char* scene : {"franka_panda", "humanoid"}) {
    const std::string name = scene;
    benchmark::RegisterBenchmark((name + "/ID/recursive").c_str(), inverseDynamics, scene);
    benchmark::RegisterBenchmark((name + "/M/recursive").c_str(), massMatrix, scene);
    benchmark::RegisterBenchmark((name + "/FD/recursive").c_str(), forwardDynamics, scene);
    for (const Formula formula :
         {Formula::kInverseDynamics, Formula::kMassMatrix, Formula::kForwardDynamics}) {
      const std::string label = name + "/" + kernel::name(formula) + "/";
#ifdef DYNWITNESS_HAS_MUJOCO
      benchmark::RegisterBenchmark((label + kEngine).c_str(), mujocoRaw, scene, formula);
#endif
      benchmark::RegisterBenchmark((label + "fast").c_str(), fast, scene, &benchmarks::kFastByOwn,
                                   formula);
#ifdef DYNWITNESS_SECOND_COMPILER
      benchmark::RegisterBenchmark((label + kSecond).c_str(), fast, scene,
                                   &benchmarks::kFastBySecond, formula);
#endif
      if (!with_kernels) continue;
      benchmark::RegisterBenchmark((label + "kernel").c_str(), kernelOne, scene, formula);
      benchmark::RegisterBenchmark((label + kLanes).c_str(), kernelMany, scene, formula);
      benchmark::RegisterBenchmark((label + kAllCores).c_str(), kernelMany, scene, formula)
          ->Threads(availableProcessors())
          ->UseRealTime();
    }
    for (const WitnessKind& kind : witnessKinds()) {
      const bool ours = kind.info.version == DYNWITNESS_VERSION;
      if (ours || !kind.info.present) continue;
      const auto add = [&](const char* label, Quantity quantity) {
        if (!kind.make(scene::findScene(scene))->answers(quantity)) return;
        benchmark::RegisterBenchmark((name + "/" + label + "/" + kind.info.name).c_str(), engine,
                                     scene, kind, quantity);
      };
      add("ID", Quantity::kTau);
      add("M", Quantity::kM);
      add("FD", Quantity::kQdd);
    }
  }
  benchmarks::registerDerivations();
  // results are kept unless the caller says where
  std::string file = std::string("--benchmark_out=") + DYNWITNESS_BENCHMARKS_FILE;
  std::vector<char*> arguments = {argv[0], file.data()};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  argc = static_cast<int>(arguments.size());
  argv = arguments.data();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  Table table;
  benchmark::RunSpecifiedBenchmarks(&table);
  table.print();
  benchmarks::printDerivations();
}
