// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse dynamics, mass matrix and forward dynamics: our sweeps beside the engines, in one run on the
// same states. Read the ratios, not the nanoseconds.
#include <benchmark/benchmark.h>

#include "crosscheck/crosscheck.hpp"
#include "crosscheck/states.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace {

using namespace dynwitness;
using namespace dynwitness::crosscheck;

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

void engine(benchmark::State& run, const char* scene, const WitnessKind& kind, Quantity quantity) {
  Arm arm(scene);
  const std::unique_ptr<Witness> witness = kind.make(arm.scene);
  for (auto _ : run) benchmark::DoNotOptimize(witness->value(quantity, arm.next()));
}

}  // namespace

int main(int argc, char** argv) {
  for (const char* scene : {"franka_panda", "humanoid"}) {
    const std::string name = scene;
    benchmark::RegisterBenchmark((name + "/ID/recursive").c_str(), inverseDynamics, scene);
    benchmark::RegisterBenchmark((name + "/M/recursive").c_str(), massMatrix, scene);
    benchmark::RegisterBenchmark((name + "/FD/recursive").c_str(), forwardDynamics, scene);
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
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
