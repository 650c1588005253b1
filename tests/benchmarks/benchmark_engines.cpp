// SPDX-License-Identifier: GPL-3.0-or-later
// Programs of the user's beside our sweeps and the engines: what they take with all that is said.
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"
#include "tests/benchmarks/benchmark_parts.hpp"

namespace dynwitness::benchmarks {
namespace {

using namespace crosscheck;

constexpr Quantity kQuantities[] = {Quantity::kTau, Quantity::kM, Quantity::kQdd};  // as kTimed

using States = std::vector<scene::State<double>>;

/// Wall time, since it passes in two processes.
void engineBatch(benchmark::State& run, const scene::Scene& scene, const WitnessKind& kind,
                 Quantity quantity, const States& states) {
  try {
    const std::unique_ptr<Witness> witness = kind.make(scene).value();
    for (auto _ : run) askEngineAhead(*witness, quantity, states);
    benchmark::DoNotOptimize(witness->value(quantity, states.back()));  // or why there is none
  } catch (const std::exception& error) {
    run.SkipWithError(error.what());
  }
  run.counters[kStatesCounter] = static_cast<double>(states.size());
}

}  // namespace

void registerEngines(BenchResult* result, const std::vector<std::string>& commands,
                     const Limits& limits) {
  if (commands.empty()) return;
  for (const char* name : kScenes) {
    const scene::Scene scene = scene::findScene(name);
    States states;
    for (std::size_t k = 0; k < kEngineBatch; ++k)
      states.push_back(drawState(scene.mechanism, scene.name, kSeed, k));
    for (const WitnessKind& kind : engineKinds(commands, limits, scene)) {
      const auto leaveOut = [&](const std::string& why) {
        result->left_out.push_back(fmt::format("{} on {}: {}", kind.info.name, name, why));
      };
      MadeWitness made = kind.make(scene);
      if (made.isRefused()) {
        leaveOut(made.refusal());
        continue;
      }
      const std::unique_ptr<Witness> witness = std::move(made).value();
      for (std::size_t k = 0; k < std::size(kTimed); ++k) {
        const Quantity quantity = kQuantities[k];
        if (!witness->answers(quantity)) {
          leaveOut(fmt::format("it does not know {}", crosscheck::name(quantity)));
          continue;
        }
        try {
          witness->value(quantity, states.front());  // whether it has any
        } catch (const std::exception& error) {
          leaveOut(error.what());
          break;
        }
        addContender(result, {kind.info.name, fmt::format("{} {}, wall time with all that is said",
                                                          kind.info.name, kind.info.version)});
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", name, kTimed[k], kind.info.name).c_str(),
            [=](benchmark::State& run) { engineBatch(run, scene, kind, quantity, states); })
            ->UseRealTime();
      }
    }
  }
}

}  // namespace dynwitness::benchmarks
