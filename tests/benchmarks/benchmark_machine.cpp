// SPDX-License-Identifier: GPL-3.0-or-later
// What one core of this machine does at its best: operations on doubles, bytes read and written.
// The measurements of the others are held to it.
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/kernel/general_cost.hpp"
#include "recursive/fast/dispatch.hpp"
#include "recursive/fast/states.hpp"
#include "recursive/fast/vector.hpp"
#include "tests/benchmarks/benchmark_parts.hpp"

namespace dynwitness::benchmarks {
namespace {

using namespace crosscheck;

/// As many chains as hide what an addition or a multiplication takes until the next one can begin,
/// and few enough to stay in sixteen registers.
constexpr int kChains = 6;
constexpr int kRounds = 1000;

/// Chains of multiplications beside chains of additions: none waits for another.
template <typename V>
DYNWITNESS_INLINE void multiplyAndAdd(V* numbers) {
  V products[kChains], sums[kChains];
  for (int k = 0; k < kChains; ++k) products[k] = numbers[0], sums[k] = numbers[1];
  const V factor = numbers[2], term = numbers[3];
  for (int round = 0; round < kRounds; ++round)
    for (int k = 0; k < kChains; ++k) {
      products[k] *= factor;
      sums[k] += term;
    }
  V total = products[0] + sums[0];
  for (int k = 1; k < kChains; ++k) total = total + products[k] + sums[k];
  numbers[4] = total;
}
/// Twice as many of both, each product in the instruction of its sum.
template <typename V>
DYNWITNESS_INLINE void fuse(V* numbers) {
  V sums[2 * kChains];
  for (V& sum : sums) sum = numbers[0];
  const V factor = numbers[2], term = numbers[3];
  for (int round = 0; round < kRounds; ++round)
    for (V& sum : sums) sum = sum * factor + term;
  V total = sums[0];
  for (int k = 1; k < 2 * kChains; ++k) total = total + sums[k];
  numbers[4] = total;
}
/// Eight sums: adding is no limit.
template <typename V>
DYNWITNESS_INLINE void read(const V* from, std::size_t count, V* total) {
  V sums[8] = {};
  for (std::size_t i = 0; i + 8 <= count; i += 8)
    for (int k = 0; k < 8; ++k) sums[k] += from[i + k];
  for (const V& sum : sums) *total += sum;
}
template <typename V>
DYNWITNESS_INLINE void write(V* to, std::size_t count, const V& value) {
  for (std::size_t i = 0; i < count; ++i) to[i] = value;
}

/// What a machine is asked, in vectors of N doubles.
template <int N>
using Vector = typename recursive::fast::detail::Register<N>::Vector;

#define DYNWITNESS_MACHINE(N, TARGET, FUSING)                             \
  TARGET void multiplyAndAdd##N(void* numbers) {                          \
    multiplyAndAdd(static_cast<Vector<N>*>(numbers));                     \
  }                                                                       \
  FUSING void fuse##N(void* numbers) {                                    \
    fuse(static_cast<Vector<N>*>(numbers));                               \
  }                                                                       \
  TARGET void read##N(const void* from, std::size_t bytes, void* total) { \
    read(static_cast<const Vector<N>*>(from), bytes / sizeof(Vector<N>),  \
         static_cast<Vector<N>*>(total));                                 \
  }                                                                       \
  TARGET void write##N(void* to, std::size_t bytes, const void* value) {  \
    write(static_cast<Vector<N>*>(to), bytes / sizeof(Vector<N>),         \
          *static_cast<const Vector<N>*>(value));                         \
  }
DYNWITNESS_MACHINE(2, , )
#ifdef __x86_64__
DYNWITNESS_MACHINE(4, DYNWITNESS_FOR_AVX2, __attribute__((target("avx2,fma"))))
DYNWITNESS_MACHINE(8, __attribute__((target("avx512f"))), __attribute__((target("avx512f,fma"))))
#endif
#undef DYNWITNESS_MACHINE

struct Machine {
  int lanes;
  bool fuses;
  void (*multiplyAndAdd)(void*);
  void (*fuse)(void*);
  void (*read)(const void*, std::size_t, void*);
  void (*write)(void*, std::size_t, const void*);
};
Machine widest() {
#ifdef __x86_64__
  const bool fuses = __builtin_cpu_supports("fma");
  // asked here and not of dispatch.hpp, which leaves AVX-512 to g++
  if (__builtin_cpu_supports("avx512f")) return {8, fuses, multiplyAndAdd8, fuse8, read8, write8};
  if (recursive::fast::kHasAvx2) return {4, fuses, multiplyAndAdd4, fuse4, read4, write4};
#endif
  return {2, false, multiplyAndAdd2, fuse2, read2, write2};
}

/// A multiplication by 1 and an addition of 0 take as long as any other, and never overflow.
struct alignas(64) Numbers {
  std::array<double, 40> all;  // products from, sums from, factor, term; what comes out
  explicit Numbers(int lanes) : all{} {
    for (int k = 0; k < lanes; ++k) all[k] = 1, all[2 * lanes + k] = 1;
  }
};

void operations(benchmark::State& run, int lanes, int a_round, void (*function)(void*)) {
  Numbers numbers(lanes);
  for (auto _ : run) {
    function(numbers.all.data());
    benchmark::ClobberMemory();
  }
  run.counters[kStatesCounter] = static_cast<double>(a_round) * kRounds * lanes;
}

/// So many passes that a short array is not timed by the clock that times it.
template <typename Pass>
void bytes(benchmark::State& run, std::size_t size, const Pass& pass) {
  const std::size_t passes = std::max<std::size_t>(1, (1 << 20) / size);
  struct alignas(64) Line {
    double numbers[8];
  };
  std::vector<Line> array(size / sizeof(Line), Line{});
  for (auto _ : run)
    for (std::size_t k = 0; k < passes; ++k) {
      pass(array.data(), size);
      benchmark::ClobberMemory();
    }
  run.counters[kStatesCounter] = static_cast<double>(passes * size);
}

/// Of the fast sweeps, without sines and cosines; counted once a scene and formula.
long generalOperationsOf(const scene::Scene& scene, const std::string& what) {
  static std::mutex counting;
  static std::map<std::pair<std::string, std::string>, long> counted;
  const std::lock_guard<std::mutex> lock(counting);
  const auto [it, is_new] = counted.try_emplace({scene.name, what});
  if (!is_new) return it->second;
  using kernel::Formula;
  for (const Formula formula :
       {Formula::kInverseDynamics, Formula::kMassMatrix, Formula::kForwardDynamics})
    if (what == kernel::name(formula))
      return it->second = kernel::generalOperations(scene.mechanism, formula);
  return it->second = kernel::generalDerivativeOperations(scene.mechanism, what == "dqdd");
}

}  // namespace

void tellWork(benchmark::State& run, const scene::Scene& scene,
              const recursive::Model<double>& model, const std::string& what, bool keeps_all,
              std::optional<long> operations) {
  long angles = 0;
  for (const auto& link : model.links)
    angles +=
        link.kind == recursive::JointKind::kRevolute || link.kind == recursive::JointKind::kHelical;
  const double n = model.dof(), nn = n * n;
  const double in = model.positions + (what == "M" ? 0 : 2 * n), out = what == "M"      ? nn
                                                                       : what[0] == 'd' ? 3 * nn
                                                                                        : n;
  const auto put = [&](const char* unit, double value) {
    run.counters[unit] = benchmark::Counter(value, benchmark::Counter::kAvgThreads);
  };
  put(kOperationsWithSines,
      static_cast<double>((operations ? *operations : generalOperationsOf(scene, what)) +
                          angles * kernel::sineCosineOperations()));
  put(kBytesRead, 8 * in);
  put(kBytesWritten, 8 * out);
  put(kBytesAtHand, 8 * (in * kStates + out * (keeps_all ? kStates : 1)));
}

void registerMachine() {
  const Machine machine = widest();
  const auto name = [](const char* what, const std::string& by) {
    return fmt::format("{}/{}/{}", kMachine, what, by);
  };
  const auto add = [&](const char* how, int a_round, void (*function)(void*)) {
    benchmark::RegisterBenchmark(
        name(kOperation, fmt::format("{}, {} a vector", how, machine.lanes)).c_str(),
        [=](benchmark::State& run) { operations(run, machine.lanes, a_round, function); });
  };
  add("unfused", 2 * kChains, machine.multiplyAndAdd);
  if (machine.fuses) add("fused", 4 * kChains, machine.fuse);
  for (const int kib : {16, 256, 2048, 16384, 131072}) {
    const std::size_t size = static_cast<std::size_t>(kib) * 1024;
    const std::string by = fmt::format("{} KiB", kib);
    benchmark::RegisterBenchmark(name(kMemoryRead, by).c_str(), [=](benchmark::State& run) {
      Numbers total(8);
      bytes(run, size, [&](const void* from, std::size_t n) {
        machine.read(from, n, total.all.data());
        benchmark::DoNotOptimize(total);
      });
    });
    benchmark::RegisterBenchmark(name(kMemoryWritten, by).c_str(), [=](benchmark::State& run) {
      const Numbers value(8);
      bytes(run, size, [&](void* to, std::size_t n) { machine.write(to, n, value.all.data()); });
    });
  }
}

}  // namespace dynwitness::benchmarks
