// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel in whole numbers: as C, and run beside the sweep in double.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/reduction/envelope_sampler.hpp"
#include "crosscheck/reduction/fixed_point.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

using symbolic::Input;
using symbolic::Program;
using Code = Program::Code;

constexpr const char* kName = "inverse_dynamics_fixed";
constexpr int kStates = 100000;
constexpr int kShort = 32;  ///< bits of int32_t

/// 0.123 as the integer of its signal, cosines as cosines.
std::int64_t quantized(double x, int fraction) {
  return std::llround(std::ldexp(x, fraction));
}

class Writer {
 public:
  explicit Writer(const FixedPoint& fixed) : fixed_(fixed) {
    for (const Program::Load& load : fixed.program.loads) is_short_ = is_short_ && fits(load.slot);
    for (const int output : fixed.program.outputs) is_short_ = is_short_ && fits(output);
  }

  /// int32_t or int64_t: of all inputs and outputs.
  const char* portType() const { return is_short_ ? "int32_t" : "int64_t"; }

  std::string body() const {
    std::string text;
    const Program& p = fixed_.program;
    for (std::size_t k = 0; k < p.loads.size(); ++k)
      text += declare(p.loads[k].slot, fmt::format("in[{}]", k));
    for (const Program::Instruction& i : p.body) text += declare(i.result, expression(i));
    for (std::size_t i = 0; i < p.outputs.size(); ++i)
      text += fmt::format("  tau[{}] = {};\n", i, operand(p.outputs[i]));
    return text;
  }

 private:
  const FixedSignal& at(int slot) const { return fixed_.signals[static_cast<std::size_t>(slot)]; }
  bool fits(int slot) const { return at(slot).word() <= kShort; }

  std::string declare(int slot, const std::string& value) const {
    const char* const type = fits(slot) ? "int32_t" : "int64_t";
    return fmt::format("  const {0} t{1} = ({0})({2});\n", type, slot, value);
  }
  std::string operand(int slot) const {
    const FixedSignal& signal = at(slot);
    return signal.kind == FixedSignal::Kind::kConstant
               ? fmt::format("INT64_C({})", quantized(signal.value, signal.fraction))
               : fmt::format("t{}", slot);
  }

  std::string expression(const Program::Instruction& i) const {
    const int there = i.code == Code::kMultiply ? at(i.a).fraction + at(i.b).fraction
                                                : std::max(at(i.a).fraction, at(i.b).fraction);
    std::string exact;
    switch (i.code) {
      case Code::kNegate:
        return "-" + operand(i.a);
      case Code::kMultiply:
        exact = fmt::format("(int64_t){} * {}", operand(i.a), operand(i.b));
        break;
      default:
        exact = fmt::format("{} {} {}", raised(i.a, there), i.code == Code::kAdd ? "+" : "-",
                            raised(i.b, there));
    }
    const int dropped = there - at(i.result).fraction;
    if (dropped == 0) return exact;
    // of more bits than an int64_t has nothing is left
    return dropped < 63 ? fmt::format("rounded({}, {})", exact, dropped) : "0";
  }
  std::string raised(int slot, int fraction) const {
    const int by = fraction - at(slot).fraction;
    if (by >= 63) return "0";  // what is not 0 would be of more bits than were held to fit
    return by == 0 ? "(int64_t)" + operand(slot)
                   : fmt::format("(int64_t){} * (INT64_C(1) << {})", operand(slot), by);
  }

  const FixedPoint& fixed_;
  bool is_short_ = true;
};

/// One number of a state as the program reads it.
double inputOf(const Program::Load& load, const scene::State<double>& state) {
  const auto joint = static_cast<std::size_t>(load.joint);
  switch (load.input) {
    case Input::kCos:
      return state.x[joint].c;
    case Input::kSin:
      return state.x[joint].s;
    case Input::kPosition:
      return state.x[joint].q;
    case Input::kVelocity:
      return state.qd[joint];
    default:
      return state.qdd[joint];
  }
}

/// Compiled, and asked in numbers as they are.
class Compiled {
 public:
  explicit Compiled(const FixedPoint& fixed)
      : fixed_(fixed),
        object_(kernel::compileAndLoad({fixed.code}, {kernel::findCompiler(),
                                                      {"-std=c99", "-O1", "-shared", "-fPIC"},
                                                      kernel::cacheFolder()})
                    .front()),
        function_(object_->symbol(kName)),
        is_short_(std::string(Writer(fixed).portType()) == "int32_t") {}

  std::vector<double> operator()(const scene::State<double>& state) const {
    return is_short_ ? called<std::int32_t>(state) : called<std::int64_t>(state);
  }

 private:
  template <typename Word>
  std::vector<double> called(const scene::State<double>& state) const {
    using Function = void (*)(const Word*, Word*);
    const Program& p = fixed_.program;
    std::vector<Word> in, out(p.outputs.size());
    for (const Program::Load& load : p.loads)
      in.push_back(static_cast<Word>(quantized(
          inputOf(load, state), fixed_.signals[static_cast<std::size_t>(load.slot)].fraction)));
    reinterpret_cast<Function>(function_)(in.data(), out.data());
    std::vector<double> tau;
    for (std::size_t i = 0; i < out.size(); ++i)
      tau.push_back(std::ldexp(static_cast<double>(out[i]),
                               -fixed_.signals[static_cast<std::size_t>(p.outputs[i])].fraction));
    return tau;
  }

  const FixedPoint& fixed_;
  std::shared_ptr<kernel::SharedObject> object_;
  void* function_;
  bool is_short_;
};

}  // namespace

std::string fixedPointC(const scene::Scene& scene, const FixedPoint& fixed) {
  const Writer writer(fixed);
  const auto format = [&](int slot) {
    const FixedSignal& s = fixed.signals[static_cast<std::size_t>(slot)];
    return fmt::format("{:<8} unit 2^-{:<3} {} bits", s.name, s.fraction, s.word());
  };
  std::string text = fmt::format(
      "// tau of {} in whole numbers. Each input is the integer nearest to it in its unit, each tau is\n"
      "// an integer in its unit; SI units. In the scene's [envelope] tau is off by at most, proven:\n",
      scene.name);
  for (std::size_t i = 0; i < fixed.forces.size(); ++i)
    text += fmt::format("//   tau_{}: {:.3g}\n", i + 1,
                        fixed.forces[i].certified * (1 + 0.01));  // upwards
  text += "//\n";
  for (std::size_t k = 0; k < fixed.program.loads.size(); ++k)
    text += fmt::format("//   in[{}]  {}\n", k, format(fixed.program.loads[k].slot));
  for (std::size_t i = 0; i < fixed.program.outputs.size(); ++i)
    text += fmt::format("//   tau[{}]  {}\n", i, format(fixed.program.outputs[i]));
  text += fmt::format(
      "//\n// No word, product or sum is wider than {} bits. >> of a negative number has to shift in its\n"
      "// sign, as it does in gcc, clang and all compilers for microcontrollers that are known here.\n"
      "#include <stdint.h>\n\n"
      "/* to the nearest, halves upwards */\n"
      "static int64_t rounded(int64_t x, int bits) {{\n"
      "  return (x + (INT64_C(1) << (bits - 1))) >> bits;\n}}\n\n"
      "void {}(const {}* in, {}* tau) {{\n{}  (void)rounded;\n}}\n",
      fixed.widestProduct(), kName, writer.portType(), writer.portType(), writer.body());
  return text;
}

void runFixedPoint(const scene::Scene& scene, const std::vector<scene::JointRanges>& ranges,
                   FixedPoint* fixed) {
  std::unique_ptr<Compiled> code;
  try {
    code = std::make_unique<Compiled>(*fixed);
  } catch (const kernel::CannotCompile& error) {
    throw scene::InputError({}, std::string("the code is not compiled: ") + error.what());
  }
  const auto model =
      recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
  recursive::Workspace<double> ws(model);
  EnvelopeSampler sampler(ranges, 63);
  std::vector<double> swept(fixed->forces.size());
  for (fixed->states = 0; fixed->states < kStates; ++fixed->states) {
    const EnvelopeState at = sampler.next();
    scene::State<double> state{{}, at.qd, at.qdd, {}};
    for (const double q : at.q) state.x.push_back(scene::jointPosition(q));
    recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, swept);
    const std::vector<double> tau = (*code)(state);
    for (std::size_t i = 0; i < tau.size(); ++i)
      if (const double off = std::abs(tau[i] - swept[i]); off > fixed->forces[i].measured) {
        fixed->forces[i].measured = off;
        fixed->forces[i].worst = at;
      }
  }
}

}  // namespace dynwitness::crosscheck
