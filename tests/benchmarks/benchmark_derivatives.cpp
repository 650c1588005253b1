// SPDX-License-Identifier: GPL-3.0-or-later
// First derivatives of tau (by q, qd, qdd) and of qdd (by q, qd, tau), second ones of tau: the fast
// sweeps of their own and the textbook's beside the other sweeps on dual numbers, column by column,
// and MuJoCo's differences of a step, in one run on the same states.
#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/second_derivatives.hpp"
#include "scene/families.hpp"
#include "scene/scene.hpp"
#include "tests/benchmarks/benchmark_parts.hpp"
#include "tests/benchmarks/fast_by_compiler.hpp"
#include "tests/fixtures/lanes/many_derivatives.hpp"
#ifdef DYNWITNESS_HAS_MUJOCO
#include "crosscheck/chart/raw_mujoco.hpp"
#endif

namespace dynwitness::benchmarks {
namespace {

using namespace crosscheck;
using recursive::Model;
using Moving = Dual<double>;

struct Arm {
  explicit Arm(const std::string& name)
      : scene(named(name)),
        model(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))) {
    for (int k = 0; k < kStates; ++k)
      states.push_back(
          drawState(scene.mechanism, scene.name, kSeed, static_cast<std::uint64_t>(k)));
  }
  /// The next state; its cosines and sines are paid for here, as in the other benchmarks.
  const scene::State<double>& next() {
    scene::State<double>& state = states[index = (index + 1) % kStates];
    for (scene::JointPosition<double>& x : state.x) x = scene::jointPosition(x.q);
    return state;
  }

  static scene::Scene named(const std::string& name) {
    scene::Scene scene;
    return scene::findFamily(name, &scene) ? scene : scene::findScene(name);
  }

  scene::Scene scene;
  Model<double> model;
  std::vector<scene::State<double>> states;
  std::size_t index = 0;
};

void swept(benchmark::State& run, const std::string& scene, bool of_accelerations) {
  Arm arm(scene);
  recursive::DerivativesWorkspace<double> room(arm.model);
  recursive::InverseDynamicsDerivatives<double> of_tau(arm.model);
  recursive::ForwardDynamicsDerivatives<double> of_qdd(arm.model);
  std::vector<double> qdd(static_cast<std::size_t>(arm.model.dof()));
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    if (of_accelerations) {
      recursive::forwardDynamics(arm.model, s.x, s.qd, s.tau, room.ws, qdd);
      recursive::forwardDynamicsDerivatives(arm.model, s.x, s.qd, qdd, room, of_tau, of_qdd);
    } else {
      recursive::inverseDynamicsDerivatives(arm.model, s.x, s.qd, s.qdd, room, of_tau);
    }
    benchmark::DoNotOptimize(of_tau.M.data());
    benchmark::ClobberMemory();
  }
}

/// Second derivatives of tau, the first ones on the way.
void sweptTwice(benchmark::State& run, const std::string& scene) {
  Arm arm(scene);
  recursive::SecondDerivativesWorkspace<double> room(arm.model);
  recursive::InverseDynamicsSecondDerivatives<double> of_tau(arm.model);
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    recursive::inverseDynamicsSecondDerivatives(arm.model, s.x, s.qd, s.qdd, room, of_tau);
    benchmark::DoNotOptimize(&of_tau);
    benchmark::ClobberMemory();
  }
}

void fast(benchmark::State& run, const std::string& scene, bool of_accelerations,
          const FastBy* by) {
  Arm arm(scene);
  std::vector<std::vector<double>> q(kStates);
  for (std::size_t k = 0; k < q.size(); ++k)
    for (const scene::JointPosition<double>& x : arm.states[k].x) q[k].push_back(x.q);
  std::vector<double> three(3 * arm.states[0].qd.size() * arm.states[0].qd.size());
  void* const sweeps = by->makeDerivatives(&arm.model);
  std::size_t k = 0;
  for (auto _ : run) {
    k = (k + 1) % kStates;
    const scene::State<double>& s = arm.states[k];
    if (of_accelerations)
      by->ofAccelerations(sweeps, q[k].data(), s.qd.data(), s.tau.data(), three.data());
    else
      by->ofForces(sweeps, q[k].data(), s.qd.data(), s.qdd.data(), three.data());
    benchmark::DoNotOptimize(three.data());
    benchmark::ClobberMemory();
  }
  by->releaseDerivatives(sweeps);
  tellWork(run, arm.scene, arm.model, of_accelerations ? "dqdd" : "dtau", false);
}

/// All states in one call.
void fastMany(benchmark::State& run, const std::string& scene, bool of_accelerations) {
  Arm arm(scene);
  Rows rows(arm.model, arm.states, of_accelerations, 3);
  const int nn = rows.n * rows.n;
  recursive::fast::ManyDerivatives many(arm.model);
  const auto ask = of_accelerations ? &recursive::fast::ManyDerivatives::forwardDynamics
                                    : &recursive::fast::ManyDerivatives::inverseDynamics;
  for (auto _ : run) {
    (many.*ask)(kStates, rows.positions(), rows.rates(), rows.given(), rows.answers(nn, 0),
                rows.answers(nn, 1), rows.answers(nn, 2));
    benchmark::DoNotOptimize(rows.out.data());
    benchmark::ClobberMemory();
  }
  run.counters[kStatesCounter] = kStates;
  tellWork(run, arm.scene, arm.model, of_accelerations ? "dqdd" : "dtau", true);
}

#ifdef DYNWITNESS_HAS_MUJOCO
/// What MuJoCo has of the kind: one-sided differences of its step by q, qd (and no force, since the
/// model has no actuators).
void mujocoDifferences(benchmark::State& run, const std::string& scene) {
  Arm arm(scene);
  RawMujoco mujoco(arm.scene);
  const std::size_t n = arm.states[0].qd.size();
  std::vector<double> A(4 * n * n);
  for (auto _ : run) {
    mujoco.stepDifferences(arm.next(), 1e-6, A.data());  // as its own examples
    benchmark::DoNotOptimize(A.data());
    benchmark::ClobberMemory();
  }
}
#endif

/// Each column a sweep: of M and of 1/M as well.
void byDuals(benchmark::State& run, const std::string& scene, bool of_accelerations) {
  Arm arm(scene);
  const Model<Moving> model = lifted<Moving>(arm.model);
  recursive::Workspace<Moving> ws(model);
  const int n = model.dof();
  std::vector<Moving> out(static_cast<std::size_t>(n), Moving(0.0));
  Eigen::MatrixXd columns(n, 3 * n);
  using Part = std::vector<double> Direction<double>::*;
  const Part parts[] = {&Direction<double>::q, &Direction<double>::qd,
                        of_accelerations ? &Direction<double>::tau : &Direction<double>::qdd};
  for (auto _ : run) {
    const scene::State<double>& s = arm.next();
    for (int part = 0; part < 3; ++part)
      for (int k = 0; k < n; ++k) {
        Direction<double> unit;
        (unit.*parts[part]).assign(static_cast<std::size_t>(n), 0.0);
        (unit.*parts[part])[static_cast<std::size_t>(k)] = 1;
        const scene::State<Moving> at = moving(arm.model, s, unit);
        if (of_accelerations)
          recursive::forwardDynamics(model, at.x, at.qd, at.tau, ws, out);
        else
          recursive::inverseDynamics(model, at.x, at.qd, at.qdd, ws, out);
        for (int i = 0; i < n; ++i)
          columns(i, part * n + k) = out[static_cast<std::size_t>(i)].derivative;
      }
    benchmark::DoNotOptimize(columns.data());
    benchmark::ClobberMemory();
  }
}

}  // namespace

void registerDerivatives(BenchResult* result) {
  const std::string own = kFastByOwn.compiler();
  addContender(result, {"recursive", "textbook sweeps, " + own, true});
  addContender(result, {"duals", "textbook sweeps on dual numbers, " + own, true});
  addContender(result, {"fast", "fast sweeps, " + own, true});
  std::vector<std::pair<const char*, const FastBy*>> compilers = {{"fast", &kFastByOwn}};
#ifdef DYNWITNESS_SECOND_COMPILER
  addContender(result,
               {"fast_second", std::string("fast sweeps, ") + kFastBySecond.compiler(), true});
  compilers.emplace_back("fast_second", &kFastBySecond);
#endif
  addContender(result, {"fast_lanes", fastLanesLabel(), true});
#ifdef DYNWITNESS_HAS_MUJOCO
  addContender(result, {"mujoco_differences", "MuJoCo, differences of a step"});
#endif
  result->left_out.push_back(
      "Pinocchio and RBDL: no package of this system has them; data/engines/ has adapters for "
      "who does (--engine)");
  for (const char* scene : {"franka_panda", "humanoid", "humanoid_floating", "chain_64"}) {
    benchmark::RegisterBenchmark(fmt::format("{}/d2tau/recursive", scene).c_str(),
                                 [=](benchmark::State& run) { sweptTwice(run, scene); });
    for (const auto& [name, by] : compilers)
      for (const auto& [what, of_accelerations] : {std::pair("dtau", false), {"dqdd", true}})
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", scene, what, name).c_str(),
            [=, by = by, of_accelerations = of_accelerations](benchmark::State& run) {
              fast(run, scene, of_accelerations, by);
            });
#ifdef DYNWITNESS_HAS_MUJOCO
    benchmark::RegisterBenchmark(fmt::format("{}/dqdd/mujoco_differences", scene).c_str(),
                                 [=](benchmark::State& run) { mujocoDifferences(run, scene); });
#endif
    for (const auto& [what, of_accelerations] : {std::pair("dtau", false), {"dqdd", true}})
      for (const auto& [by, function] :
           {std::pair("recursive", swept), {"duals", byDuals}, {"fast_lanes", fastMany}})
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", scene, what, by).c_str(),
            [=, function = function, of_accelerations = of_accelerations](benchmark::State& run) {
              function(run, scene, of_accelerations);
            });
  }
}

}  // namespace dynwitness::benchmarks
