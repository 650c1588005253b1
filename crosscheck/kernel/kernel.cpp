// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/kernel.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/emit.hpp"
#include "recursive/fast/sine_cosine.hpp"
#include "scene/error.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

constexpr const char* kFunction = "kernel";

/// No operation may be merged with another (-ffp-contract=off): the error bound is that of the
/// program.
std::vector<std::string> flags(int lanes) {
  std::vector<std::string> all = {"-std=gnu11", "-O1",   "-ffp-contract=off",  "-fno-math-errno",
                                  "-shared",    "-fPIC", "-fno-trapping-math", "-Wno-psabi"};
#if defined(__x86_64__) || defined(__i386__)
  if (lanes == 4) all.push_back("-mavx2");
  if (lanes == 8) all.insert(all.end(), {"-mavx512f", "-mavx512dq", "-mprefer-vector-width=512"});
#else
  (void)lanes;
#endif
  return all;
}

struct Code {
  void (*one)(const double*, const double*, const double*, double*) = nullptr;
  void (*many)(const double*, const double*, const double*, double*, long) = nullptr;

  explicit Code(const SharedObject& object)
      : one(reinterpret_cast<decltype(one)>(object.symbol(kFunction))),
        many(reinterpret_cast<decltype(many)>(object.symbol(std::string(kFunction) + "_many"))) {}
};

bool sameBits(const double* a, const double* b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (std::memcmp(a + i, b + i, sizeof *a) != 0 && !(std::isnan(a[i]) && std::isnan(b[i])))
      return false;
  return true;
}

/** Runs compiled code beside the interpreter that knows the program, at a few states.

    cos and sin come from the same text (sine_cosine.inc) as our compiler took it, so that all bits
    are equal when the other compiler has left sums, products and divisions as they stand.
    @return what differs, or nothing */
std::string differenceFrom(const symbolic::Program& program, symbolic::ProgramRun<double>& run,
                           const SharedObject& object, int lanes) {
  const volatile double smallest = std::numeric_limits<double>::min();
  if (smallest / 2 == 0)
    return "it makes this processor flush small numbers to zero (-ffast-math?)";
  const Code code(object);
  int entries = 1;
  for (const symbolic::Program::Load& load : program.loads)
    entries = std::max(entries, load.joint + 1);
  const std::size_t n = entries, outputs = program.outputs.size(), count = 2 * lanes + 1;
  std::uint64_t seed = 1;
  const auto drawn = [&](double most) {  // Knuth's MMIX; the upper bits are good enough here
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return most * (static_cast<double>(seed >> 11) * 0x1p-52 - 1);
  };
  std::vector<double> all[3], expected(outputs * count), many(outputs * count), out(outputs);
  for (std::vector<double>& in : all) in.resize(n * count);
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> in[3];
    for (int a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < n; ++i) {
        in[a].push_back(drawn(a == 0 ? 3.0 : 2.0));
        all[a][i * count + k] = in[a][i];
      }
    scene::State<double> state{std::vector<scene::JointPosition<double>>(n), in[1], in[2], in[2]};
    recursive::fast::jointPositions(in[0].data(), entries, state.x.data());
    const std::vector<double> right = run(state);
    code.one(in[0].data(), in[1].data(), in[2].data(), out.data());
    if (!sameBits(out.data(), right.data(), outputs))
      return "it does not compute what is written, bit for bit (does the compiler reorder or fuse "
             "operations, as "
             "with -ffast-math?)";
    for (std::size_t i = 0; i < outputs; ++i) expected[i * count + k] = right[i];
  }
  code.many(all[0].data(), all[1].data(), all[2].data(), many.data(), static_cast<long>(count));
  return sameBits(many.data(), expected.data(), many.size())
             ? ""
             : "it does not compute what is written in every lane of its vectors, bit for bit";
}

/// Programs as compiled code, each tried against its interpreter.
std::vector<std::shared_ptr<SharedObject>> compiled(
    const std::vector<const symbolic::Program*>& programs,
    const scene::RealNumbers<double>& numbers, int lanes) {
  std::vector<symbolic::ProgramRun<double>> runs;
  std::vector<std::string> sources;
  for (const symbolic::Program* program : programs) {
    runs.emplace_back(*program, numbers);
    sources.push_back(emitKernel(*program, runs.back(), kFunction, lanes));
  }
  return compileAndLoad(sources, {findCompiler(), flags(lanes), cacheFolder()},
                        [&](const SharedObject& object, std::size_t i) {
                          return differenceFrom(*programs[i], runs[i], object, lanes);
                        });
}

/// x + y - x, x y + z, x / y, cos and sin.
symbolic::Program probe() {
  using symbolic::Input;
  symbolic::Graph graph;
  const auto x = graph.input(Input::kVelocity, 0), y = graph.input(Input::kVelocity, 1),
             z = graph.input(Input::kVelocity, 2);
  return symbolic::compile(graph,
                           {graph.subtract(graph.add(x, y), x), graph.add(graph.multiply(x, y), z),
                            graph.multiply(x, graph.inverse(y)), graph.input(Input::kCos, 0),
                            graph.input(Input::kSin, 0)});
}

}  // namespace

void requireCompiler() {
  const int lanes = chosenLanes();
  std::string how = fmt::format("{} {}", cacheFolder().string(), lanes);
  for (const std::string& word : findCompiler()) how += " " + word;
  // what is wrong with each: of this machine and no scene, so of the process; trying costs a second
  static std::map<std::string, std::string> known;
  auto it = known.find(how);
  if (it == known.end()) {
    std::string problem;
    try {
      const symbolic::Program program = probe();
      compiled({&program}, scene::RealNumbers<double>(scene::Mechanism()), lanes);
    } catch (const CannotCompile& error) {
      problem = error.what();
    }
    it = known.emplace(how, problem).first;
  }
  if (!it->second.empty()) throw CannotCompile(it->second);
}

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
  throw scene::InputError({},
                          fmt::format("DYNWITNESS_LANES: got '{}', allowed: 2, 4, 8, and no more "
                                      "than this processor's {}",
                                      wish, widest));
}

Kernel::Kernel(const SmallestRoads& roads, const KernelOptions& options)
    : dof_(roads.mechanism().dof()), lanes_(options.lanes) {
  const scene::RealNumbers<double> numbers(roads.mechanism());
  std::vector<const symbolic::Program*> programs;
  std::vector<Formula> formulas;
  for (const Formula formula : options.formulas) {
    try {
      programs.push_back(&roads_.insert_or_assign(formula, roads(formula)).first->second.program);
      formulas.push_back(formula);
    } catch (const NotUsed& why) {
      not_used_[formula] = why.what();
    }
  }
  if (formulas.empty() && !not_used_.empty()) {
    std::string all;
    for (const auto& [formula, why] : not_used_) all += (all.empty() ? "" : ". ") + why;
    throw NotUsed(all);
  }
  objects_ = compiled(programs, numbers, lanes_);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const kernel::Code loaded(*objects_[i]);
    const Code code{loaded.one, loaded.many};
    switch (formulas[i]) {
      case Formula::kInverseDynamics:
        id_ = code;
        break;
      case Formula::kMassMatrix:
        m_ = code;
        break;
      case Formula::kForwardDynamics:
        fd_ = code;
        break;
      default:
        throw std::invalid_argument(
            fmt::format("Kernel: formulas: expected ID, M or FD, got {}", name(formulas[i])));
    }
  }
}

bool Kernel::has(Formula formula) const {
  return roads_.count(formula) > 0;
}

const Road& Kernel::road(Formula formula) const {
  if (const auto it = roads_.find(formula); it != roads_.end()) return it->second;
  throw std::invalid_argument(fmt::format("Kernel::road: {} has no code", name(formula)));
}

}  // namespace dynwitness::crosscheck::kernel
