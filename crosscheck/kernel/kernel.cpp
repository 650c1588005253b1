// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/kernel.hpp"

#include <cstdlib>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/emit.hpp"
#include "scene/error.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

constexpr const char* kFunction = "kernel";

/// No operation may be merged with another (-ffp-contract=off): the error bound is that of the program.
std::vector<std::string> flags(int lanes) {
  std::vector<std::string> all = {"-std=gnu11", "-O1",           "-ffp-contract=off",   "-fno-math-errno",
                                  "-shared",    "-fPIC",         "-fno-trapping-math", "-Wno-psabi"};
#if defined(__x86_64__) || defined(__i386__)
  if (lanes == 4) all.push_back("-mavx2");
  if (lanes == 8) all.insert(all.end(), {"-mavx512f", "-mavx512dq", "-mprefer-vector-width=512"});
#else
  (void)lanes;
#endif
  return all;
}

}  // namespace

int widestLanes() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return 8;
  if (__builtin_cpu_supports("avx2")) return 4;
#endif
  return 2;
}

int chosenLanes() {
  const char* const wish = std::getenv("DYNWITNESS_LANES");
  const int widest = widestLanes();
  if (!wish || !*wish) return widest;
  for (int lanes = 2; lanes <= widest; lanes *= 2)
    if (fmt::format("{}", lanes) == wish) return lanes;
  throw scene::InputError({}, fmt::format("DYNWITNESS_LANES: got '{}', allowed: 2, 4, 8, and no more "
                                          "than this processor's {}", wish, widest));
}

Kernel::Kernel(const scene::Mechanism& mechanism, const KernelOptions& options)
    : dof_(mechanism.dof()), lanes_(options.lanes) {
  const CompileOptions compile{findCompiler(), flags(lanes_), cacheFolder()};
  const scene::RealNumbers<double> numbers(mechanism);
  std::vector<std::string> sources;
  for (const Formula formula : options.formulas) {
    roads_.emplace_back(formula, smallestRoad(mechanism, formula));
    const symbolic::Program& program = roads_.back().second.program;
    const symbolic::ProgramRun<double> run(program, numbers);
    sources.push_back(emitKernel(program, run, kFunction, lanes_));
  }
  objects_ = compileAndLoad(sources, compile);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Code code;
    code.one = reinterpret_cast<decltype(code.one)>(objects_[i]->symbol(kFunction));
    code.many = reinterpret_cast<decltype(code.many)>(
        objects_[i]->symbol(std::string(kFunction) + "_many"));
    switch (options.formulas[i]) {
      case Formula::kInverseDynamics: id_ = code; break;
      case Formula::kMassMatrix: m_ = code; break;
      case Formula::kForwardDynamics: fd_ = code; break;
      default:
        throw std::invalid_argument(fmt::format(
            "Kernel: formulas: expected ID, M or FD, got {}", name(options.formulas[i])));
    }
  }
}

const Road& Kernel::road(Formula formula) const {
  for (const auto& [of, road] : roads_)
    if (of == formula) return road;
  throw std::invalid_argument(fmt::format("Kernel::road: {} was not asked for", name(formula)));
}

}  // namespace dynwitness::crosscheck::kernel
