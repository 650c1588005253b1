// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of `./dynwitness bench`. A benchmark is named SUBJECT/WHAT/BY, as
// "franka_panda/ID/fast"; what it measured becomes a crosscheck::Measurement: its time (CPU time,
// or wall time where it was registered for that; divided by the counter kStatesCounter if there is
// one), and each other counter under the counter's name as unit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "crosscheck/report/bench.hpp"
#include "crosscheck/system/children.hpp"
#include "recursive/fast/strided.hpp"
#include "recursive/model.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::benchmarks {

constexpr int kStates = 1000;  ///< that a benchmark cycles through
constexpr std::uint64_t kSeed = 1;
constexpr const char* kStatesCounter = "states";
constexpr const char* kScenes[] = {"franka_panda", "humanoid", "humanoid_floating"};
constexpr const char* kClosedScenes[] = {"andrews_squeezer", "humanoid_both_feet"};

/// Each adds its benchmarks to google-benchmark's list, and what the table must know of them to the
/// result: contenders, and what is left out here.
void registerMachine();                                     ///< machine/operation, ...
void registerSweeps(crosscheck::BenchResult* result);       ///< SCENE/ID, M, FD/...
void registerSteps(crosscheck::BenchResult* result);        ///< SCENE/step, RK4 step/...
void registerDerivatives(crosscheck::BenchResult* result);  ///< SCENE/dtau, dqdd/...
void registerDerivations(crosscheck::BenchResult* result);  ///< SCENE/derivation/...
void registerStarts(crosscheck::BenchResult* result);       ///< making, crosscheck, counts
/// SCENE/ID, M, FD/NAME of programs that answer lines of JSON; who refuses or fails is left out.
void registerEngines(crosscheck::BenchResult* result, const std::vector<std::string>& commands,
                     const crosscheck::Limits& limits);

/** Counters of what one state takes: what a limit is made of.
    @param what        ID, M, FD, dtau or dqdd
    @param keeps_all   the answers of all states, not the last one's alone
    @param operations  of its program, without sines and cosines; nothing: the fast sweep's */
void tellWork(benchmark::State& run, const scene::Scene& scene,
              const recursive::Model<double>& model, const std::string& what, bool keeps_all,
              std::optional<long> operations = {});

/// States one after the other, as NumPy lays them out, and room for up to `matrices` of dof^2
/// numbers each, a matrix of all states after the other; of none for dof numbers.
struct Rows {
  Rows(const recursive::Model<double>& model, const std::vector<scene::State<double>>& states,
       bool is_tau_given, int matrices = 1);
  recursive::fast::Strided<const double> positions() const { return {q.data(), nq}; }
  recursive::fast::Strided<const double> rates() const { return {qd.data(), n}; }
  recursive::fast::Strided<const double> given() const { return {w.data(), n}; }
  recursive::fast::Strided<double> answers(int numbers, int matrix = 0) {
    return {out.data() + static_cast<std::ptrdiff_t>(matrix) * n * n * count, numbers};
  }

  int n, nq;
  std::ptrdiff_t count;               ///< of states
  std::vector<double> q, qd, w, out;  ///< w: tau or qdd
};

/// A contender that may have been added before.
void addContender(crosscheck::BenchResult* result, const crosscheck::Contender& contender);

std::string fastLanesLabel();  ///< of the contender fast_lanes
/// Of an engine; empty where it was not found when this was built.
std::string versionOf(const char* witness);

}  // namespace dynwitness::benchmarks
