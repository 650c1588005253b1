// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse dynamics, mass matrix and forward dynamics: our sweeps and the scene's own kernel beside
// the engines, in one run on the same states. Read the ratios, not the nanoseconds.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "crosscheck/chart/raw_engines.hpp"
#include "crosscheck/chart/raw_simbody.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/many_states.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "recursive/fast/all_cores.hpp"
#include "recursive/rounding_filter.hpp"
#include "tests/benchmarks/benchmark_kernels.hpp"
#include "tests/benchmarks/benchmark_parts.hpp"
#include "tests/benchmarks/fast_by_compiler.hpp"
#ifdef DYNWITNESS_HAS_MUJOCO
#include "crosscheck/chart/raw_mujoco.hpp"
#endif

namespace dynwitness::benchmarks {
namespace {

using namespace crosscheck;
using kernel::Formula;

/// A scene, its model and its states, read once.
struct SceneStates {
  scene::Scene scene;
  recursive::Model<double> model;
  std::vector<scene::State<double>> states;
};

const SceneStates& statesOf(const std::string& name) {
  static std::mutex reading;
  static std::map<std::string, SceneStates> all;
  const std::lock_guard<std::mutex> lock(reading);
  const auto [it, is_new] = all.try_emplace(name);
  SceneStates& read = it->second;
  if (is_new) {
    read.scene = scene::findScene(name);
    const scene::Mechanism& mechanism = read.scene.mechanism;
    read.model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
    for (int k = 0; k < kStates; ++k)
      read.states.push_back(drawState(mechanism, read.scene.name, kSeed, k));
  }
  return read;
}

/// What one contender works on.
struct Arm {
  explicit Arm(const std::string& name)
      : scene(statesOf(name).scene),
        states(statesOf(name).states),
        setup(statesOf(name).model),
        M(setup.model.dof(), setup.model.dof()),
        out(setup.model.dof()) {}
  const scene::State<double>& next() { return states[index = (index + 1) % kStates]; }

  const scene::Scene& scene;
  const std::vector<scene::State<double>>& states;
  Setup<double> setup;
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

/// @param warns  with the estimate of what rounding did
void textbook(benchmark::State& run, const std::string& scene, Formula formula, bool warns) {
  Arm arm(scene);
  const recursive::Model<double>& model = arm.setup.model;
  recursive::Workspace<double>& ws = arm.setup.ws;
  recursive::RoundingFilter<double> filter(model, 1e-3);
  std::vector<scene::JointPosition<double>> x;
  double lost = 0;
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    positions(s, x);
    if (formula == Formula::kMassMatrix) {
      recursive::massMatrix(model, x, ws, arm.M);
      if (warns) lost += filter.massMatrix(x.data(), [&](int d) { return arm.M(d, d); });
    } else if (formula == Formula::kForwardDynamics) {
      recursive::forwardDynamics(model, x, s.qd, s.tau, ws, arm.out);
      if (warns) lost += filter.forwardDynamics(model, x, s.qd, s.tau, ws, arm.out);
    } else {
      recursive::inverseDynamics(model, x, s.qd, s.qdd, ws, arm.out);
      if (warns)
        lost += filter.inverseDynamics(x.data(), s.qd.data(), s.qdd.data(), arm.out.data());
    }
    benchmark::DoNotOptimize(lost);
    benchmark::DoNotOptimize(arm.out.data());
    benchmark::ClobberMemory();
  }
}

/// Positions alone, as the general sweeps for speed and the kernels take them.
std::vector<std::vector<double>> positionsOf(const Arm& arm) {
  std::vector<std::vector<double>> q(kStates);
  for (int k = 0; k < kStates; ++k)
    for (const scene::JointPosition<double>& x : arm.states[k].x) q[k].push_back(x.q);
  return q;
}

void fast(benchmark::State& run, const std::string& scene, const FastBy* by, Formula formula) {
  Arm arm(scene);
  const std::vector<std::vector<double>> q = positionsOf(arm);
  void* const sweeps = by->make(&arm.setup.model);
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    const double *x = q[arm.index].data(), *qd = s.qd.data();
    if (formula == Formula::kMassMatrix)
      by->massMatrix(sweeps, x, arm.M.data());
    else if (formula == Formula::kForwardDynamics)
      by->forwardDynamics(sweeps, x, qd, s.tau.data(), arm.out.data());
    else
      by->inverseDynamics(sweeps, x, qd, s.qdd.data(), arm.out.data());
    benchmark::DoNotOptimize(arm.out.data());
    benchmark::ClobberMemory();
  }
  by->release(sweeps);
  tellWork(run, arm.scene, arm.setup.model, kernel::name(formula), false);
}

void engine(benchmark::State& run, const std::string& scene, const WitnessKind& kind,
            Quantity quantity) {
  Arm arm(scene);
  const std::unique_ptr<Witness> witness = kind.make(arm.scene).value();
  for (auto _ : run) benchmark::DoNotOptimize(witness->value(quantity, arm.next()));
}

// ---- kernels ------------------------------------------------------------------------------------

/// Made once, one at a time, since GiNaC knows no threads. The formula alone, so that one that
/// takes the compiler long does not hold up the others.
const kernel::Kernel& kernelOf(const scene::Scene& scene, Formula formula,
                               const KernelCompiler& compiler) {
  static std::mutex making;
  static std::map<std::tuple<std::string, Formula, std::string>, std::unique_ptr<kernel::Kernel>>
      made;
  const std::lock_guard<std::mutex> lock(making);
  std::unique_ptr<kernel::Kernel>& kernel = made[{scene.name, formula, compiler.command}];
  if (!kernel) {
    const KernelEnvironment environment(compiler.command);
    kernel::KernelOptions options;
    options.formulas = {formula};
    kernel = std::make_unique<kernel::Kernel>(scene.mechanism, options);
  }
  return *kernel;
}

void call(const kernel::Kernel& kernel, Formula formula, const double* q, const double* qd,
          const scene::State<double>& s, double* out) {
  switch (formula) {
    case Formula::kMassMatrix:
      return kernel.massMatrix(q, out);
    case Formula::kForwardDynamics:
      return kernel.forwardDynamics(q, qd, s.tau.data(), out);
    default:
      return kernel.inverseDynamics(q, qd, s.qdd.data(), out);
  }
}

void kernelOne(benchmark::State& run, const std::string& scene, Formula formula,
               const KernelCompiler& compiler) {
  Arm arm(scene);
  const kernel::Kernel& kernel = kernelOf(arm.scene, formula, compiler);
  const std::vector<std::vector<double>> q = positionsOf(arm);
  std::vector<double> out(static_cast<std::size_t>(kernel.dof()) * kernel.dof());
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    call(kernel, formula, q[arm.index].data(), s.qd.data(), s, out.data());
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  tellWork(run, arm.scene, arm.setup.model, kernel::name(formula), false,
           kernel.road(formula).operations());
  if (!*compiler.suffix)  // the program is the same whoever compiles it
    run.counters["operations"] = kernel.road(formula).operations();
}

Rows rowsOf(const Arm& arm, Formula formula) {
  return {arm.setup.model, arm.states, formula == Formula::kForwardDynamics};
}

/// All states in one call by the general sweeps.
void fastMany(benchmark::State& run, const std::string& scene, Formula formula) {
  Arm arm(scene);
  Rows rows = rowsOf(arm, formula);
  recursive::fast::ManyStates many(arm.setup.model);
  for (auto _ : run) {
    if (formula == Formula::kMassMatrix)
      many.massMatrix(kStates, rows.positions(), rows.answers(rows.n * rows.n));
    else if (formula == Formula::kForwardDynamics)
      many.forwardDynamics(kStates, rows.positions(), rows.rates(), rows.given(),
                           rows.answers(rows.n));
    else
      many.inverseDynamics(kStates, rows.positions(), rows.rates(), rows.given(),
                           rows.answers(rows.n));
    benchmark::DoNotOptimize(rows.out.data());
    benchmark::ClobberMemory();
  }
  run.counters[kStatesCounter] = benchmark::Counter(kStates, benchmark::Counter::kAvgThreads);
  tellWork(run, arm.scene, arm.setup.model, kernel::name(formula), true);
}

/// The same on all cores, by threads that each call starts: with so many states that starting them
/// takes little of it.
void fastOnCores(benchmark::State& run, const std::string& scene, Formula formula, int cores) {
  using recursive::fast::ManyStates;
  Arm arm(scene);
  const bool is_M = formula == Formula::kMassMatrix;
  std::vector<scene::State<double>> states;
  for (int times = is_M ? 4 : 32; times > 0; --times)
    states.insert(states.end(), arm.states.begin(), arm.states.end());
  Rows rows(arm.setup.model, states, formula == Formula::kForwardDynamics, is_M ? 1 : 0);
  recursive::fast::AllCores<ManyStates> many(arm.setup.model, cores);
  for (auto _ : run) {
    if (is_M)
      many.ask(&ManyStates::massMatrix, states.size(), rows.positions(),
               rows.answers(rows.n * rows.n));
    else
      many.ask(formula == Formula::kForwardDynamics ? &ManyStates::forwardDynamics
                                                    : &ManyStates::inverseDynamics,
               states.size(), rows.positions(), rows.rates(), rows.given(), rows.answers(rows.n));
    benchmark::DoNotOptimize(rows.out.data());
    benchmark::ClobberMemory();
  }
  run.counters[kStatesCounter] = static_cast<double>(states.size());
}

/// M as the numbers that say all of it.
void packedMany(benchmark::State& run, const std::string& scene) {
  Arm arm(scene);
  Rows rows = rowsOf(arm, Formula::kMassMatrix);
  recursive::fast::ManyStates many(arm.setup.model);
  const int numbers = static_cast<int>(many.packedEntries().size());
  for (auto _ : run) {
    many.packedMassMatrix(kStates, rows.positions(), rows.answers(numbers));
    benchmark::DoNotOptimize(rows.out.data());
    benchmark::ClobberMemory();
  }
  run.counters[kStatesCounter] = kStates;
}

/// All states in one call, component by component. In several threads each has its own states.
void kernelMany(benchmark::State& run, const std::string& scene, Formula formula,
                const KernelCompiler& compiler) {
  Arm arm(scene);
  const kernel::Kernel& kernel = kernelOf(arm.scene, formula, compiler);
  const std::size_t n = kernel.dof();
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
  run.counters[kStatesCounter] = benchmark::Counter(kStates, benchmark::Counter::kAvgThreads);
  if (run.threads() == 1)  // limits are those of one core
    tellWork(run, arm.scene, arm.setup.model, kernel::name(formula), true,
             kernel.road(formula).operations());
}

// ---- engines, called raw ------------------------------------------------------------------------

#ifdef DYNWITNESS_HAS_MUJOCO
void mujocoRaw(benchmark::State& run, const std::string& scene, Formula formula) {
  Arm arm(scene);
  RawMujoco mujoco(arm.scene);
  mujoco.inverseDynamics(stateForCheck(arm.setup.model, arm.states[0]), arm.out.data());
  requireSameModel(arm.setup.model, arm.states[0], arm.out, "MuJoCo");
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    if (formula == Formula::kMassMatrix)
      mujoco.massMatrix(s);
    else if (formula == Formula::kForwardDynamics)
      mujoco.forwardDynamics(s);
    else
      mujoco.inverseDynamics(s, arm.out.data());
    benchmark::DoNotOptimize(mujoco.results());
    benchmark::ClobberMemory();
  }
}
#endif

void simbodyRaw(benchmark::State& run, const std::string& scene, Formula formula) {
  Arm arm(scene);
  const std::vector<std::vector<double>> q = positionsOf(arm);
  RawSimbody simbody(arm.setup.model);
  const scene::State<double> check = stateForCheck(arm.setup.model, arm.states[0]);
  std::vector<double> x_check;
  for (const scene::JointPosition<double>& x : check.x) x_check.push_back(x.q);
  simbody.inverseDynamics(x_check.data(), check.qd.data(), check.qdd.data());
  const std::vector<double> tau = simbody.inModelOrder();
  requireSameModel(arm.setup.model, arm.states[0], tau, "Simbody");
  simbody.forwardDynamics(x_check.data(), check.qd.data(), tau.data());
  requireSame(check.qdd, simbody.inModelOrder(), "Simbody", "qdd");
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    const double *x = q[arm.index].data(), *qd = s.qd.data();
    if (formula == Formula::kMassMatrix)
      simbody.massMatrix(x);
    else if (formula == Formula::kForwardDynamics)
      simbody.forwardDynamics(x, qd, s.tau.data());
    else
      simbody.inverseDynamics(x, qd, s.qdd.data());
    benchmark::DoNotOptimize(simbody.results());
    benchmark::ClobberMemory();
  }
}

// ---- who takes part -----------------------------------------------------------------------------

constexpr Formula kFormulas[] = {Formula::kInverseDynamics, Formula::kMassMatrix,
                                 Formula::kForwardDynamics};
Quantity quantityOf(Formula formula) {
  return formula == Formula::kMassMatrix        ? Quantity::kM
         : formula == Formula::kForwardDynamics ? Quantity::kQdd
                                                : Quantity::kTau;
}

/// "SCENE/ID/BY" and so on.
template <typename Function, typename... Arguments>
std::vector<benchmark::internal::Benchmark*> add(BenchResult* result, const Contender& contender,
                                                 const Function& function,
                                                 const Arguments&... arguments) {
  addContender(result, contender);
  std::vector<benchmark::internal::Benchmark*> added;
  for (const char* scene : kScenes)
    for (const Formula formula : kFormulas)
      added.push_back(benchmark::RegisterBenchmark(
          fmt::format("{}/{}/{}", scene, kernel::name(formula), contender.name).c_str(),
          [=](benchmark::State& run) {
            try {
              function(run, scene, formula, arguments...);
            } catch (const std::exception& error) {
              run.SkipWithError(error.what());
            }
          }));
  return added;
}

}  // namespace

void addContender(BenchResult* result, const Contender& contender) {
  for (const Contender& c : result->contenders)
    if (c.name == contender.name) return;
  result->contenders.push_back(contender);
}

Rows::Rows(const recursive::Model<double>& model, const std::vector<scene::State<double>>& states,
           bool is_tau_given, int matrices)
    : n(model.dof()), nq(model.positions), count(static_cast<std::ptrdiff_t>(states.size())) {
  for (const scene::State<double>& s : states) {
    for (const scene::JointPosition<double>& x : s.x) q.push_back(x.q);
    const std::vector<double>& third = is_tau_given ? s.tau : s.qdd;
    qd.insert(qd.end(), s.qd.begin(), s.qd.end());
    w.insert(w.end(), third.begin(), third.end());
  }
  out.resize(static_cast<std::size_t>(std::max(matrices * n * n, n)) * states.size());
}

std::string versionOf(const char* witness) {
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.name == witness) return kind.info.version;
  return "";
}

std::string fastLanesLabel() {
  return fmt::format("fast sweeps, {} states a vector, {}", recursive::fast::widestVectors(),
                     kFastByOwn.compiler());
}

void registerSweeps(BenchResult* result) {
#ifdef DYNWITNESS_HAS_MUJOCO
  add(result, {kRawMujoco, "MuJoCo " + versionOf("mujoco")}, mujocoRaw);
#else
  result->left_out.push_back(
      "MuJoCo, and all ratios to it: it was not found when dynwitness was built");
#endif
  add(result, {kRawSimbody, "Simbody " + versionOf("simbody")}, simbodyRaw);
  for (const WitnessKind& kind : witnessKinds()) {
    // those that are not called raw; their conversions are timed with them
    if (kind.info.version == DYNWITNESS_VERSION || kind.info.name.rfind("mujoco", 0) == 0 ||
        kind.info.name == "simbody")
      continue;
    if (!kind.info.present) {
      result->left_out.push_back(kind.info.name + ": it was not found when dynwitness was built");
      continue;
    }
    const Contender contender{kind.info.name,
                              kind.info.name + " " + kind.info.version + ", by its witness"};
    addContender(result, contender);
    for (const char* scene : kScenes) {
      try {
        const std::unique_ptr<Witness> witness = kind.make(statesOf(scene).scene).value();
        witness->value(Quantity::kTau,
                       statesOf(scene).states[0]);  // whether it takes the scene at all
        for (const Formula formula : kFormulas)
          if (witness->answers(quantityOf(formula)))
            benchmark::RegisterBenchmark(
                fmt::format("{}/{}/{}", scene, kernel::name(formula), kind.info.name).c_str(),
                [=](benchmark::State& run) { engine(run, scene, kind, quantityOf(formula)); });
      } catch (const std::exception& error) {
        result->left_out.push_back(
            fmt::format("{} on {}: {}", kind.info.name, scene, error.what()));
      }
    }
  }
  const std::string own = kFastByOwn.compiler();
  add(result, {"recursive", "textbook sweeps, " + own, true}, textbook, false);
  add(result, {"recursive_warned", "textbook sweeps with estimates of rounding, " + own, true},
      textbook, true);
  add(result, {"fast", "fast sweeps, " + own, true},
      [](benchmark::State& run, const std::string& scene, Formula f) {
        fast(run, scene, &kFastByOwn, f);
      });
  add(result, {"fast_lanes", fastLanesLabel(), true}, fastMany);
  const int cores = availableProcessors();
  for (benchmark::internal::Benchmark* b :
       add(result, {"fast_all_cores", fmt::format("the same on {} cores, {}", cores, own), true},
           fastOnCores, cores))
    b->UseRealTime();
  for (const char* scene : kScenes)
    benchmark::RegisterBenchmark(fmt::format("{}/packed M/fast_lanes", scene).c_str(),
                                 [=](benchmark::State& run) { packedMany(run, scene); });
#ifdef DYNWITNESS_SECOND_COMPILER
  add(result, {"fast_second", std::string("fast sweeps, ") + kFastBySecond.compiler(), true},
      [](benchmark::State& run, const std::string& scene, Formula f) {
        fast(run, scene, &kFastBySecond, f);
      });
#else
  result->left_out.push_back(
      "fast sweeps by a second C++ compiler: it was not found when dynwitness was built");
#endif
  const std::vector<KernelCompiler> compilers = kernelCompilers(&result->left_out);
  for (const KernelCompiler& c : compilers)
    add(result, {std::string("kernel") + c.suffix, "kernel, " + c.label, true}, kernelOne, c);
  const std::string lanes = fmt::format("kernel, {} lanes", kernel::chosenLanes());
  for (const KernelCompiler& c : compilers)
    add(result, {std::string("kernel_lanes") + c.suffix, lanes + ", " + c.label, true}, kernelMany,
        c);
  if (compilers.empty()) return;
  for (benchmark::internal::Benchmark* b :
       add(result,
           {"kernel_all_cores", fmt::format("the same on {} cores, {}", cores, compilers[0].label),
            true},
           kernelMany, compilers[0]))
    b->Threads(cores)->UseRealTime();
}

}  // namespace dynwitness::benchmarks
