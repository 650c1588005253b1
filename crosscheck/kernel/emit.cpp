// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/emit.hpp"

#include <map>
#include <stdexcept>

#include <fmt/format.h>

namespace dynwitness::crosscheck::kernel {
namespace {

using symbolic::Input;
using symbolic::Program;

/// What every kernel starts with; then recursive/fast/sine_cosine.inc as it is.
constexpr const char* kPrelude = R"(#include <math.h>

typedef double V __attribute__((vector_size({bytes})));
typedef long long I __attribute__((vector_size({bytes})));
typedef double Memory __attribute__((vector_size({bytes}), aligned(8), may_alias));
enum {{ LANES = {lanes} }};

)";

std::string number(double x) {
  return x < 0 ? fmt::format("(-{:a})", -x) : fmt::format("{:a}", x);
}

/// Which joints' angles, and in what order, are turned into cosines and sines.
std::vector<int> angles(const Program& program) {
  std::map<int, bool> joints;
  for (const Program::Load& load : program.loads)
    if (load.input == Input::kCos || load.input == Input::kSin) joints[load.joint] = true;
  std::vector<int> order;
  for (const auto& [joint, used] : joints) order.push_back(joint);
  return order;
}

class Emitter {
 public:
  Emitter(const Program& program, const symbolic::ProgramRun<double>& run, std::string name,
          int lanes)
      : program_(program),
        run_(run),
        name_(std::move(name)),
        lanes_(lanes),
        angles_(angles(program)) {
    for (std::size_t k = 0; k < angles_.size(); ++k) place_[angles_[k]] = static_cast<int>(k);
    in_body_.assign(program.slots, 0);
    for (const Program::Load& load : program.loads) in_body_[load.slot] = 1;
    for (const Program::Instruction& i : program.body) in_body_[i.result] = 1;
  }

  std::string one() const {
    std::string out = fmt::format(
        "\nvoid {}(const double* q, const double* u, const double* w, double* out) {{\n", name_);
    const int vectors = (static_cast<int>(angles_.size()) + lanes_ - 1) / lanes_;
    if (vectors > 0) {
      // joints side by side in vectors
      std::string list;
      for (const int joint : angles_)
        list += fmt::format("{}q[{}]", list.empty() ? "" : ", ", joint);
      out += fmt::format("  V x[{0}], sine[{0}], cosine[{0}];\n", vectors);
      out += fmt::format("  const double angles[{}] __attribute__((aligned({}))) = {{{}}};\n",
                         vectors * lanes_, lanes_ * 8, list);
      out += fmt::format(
          "  for (int j = 0; j < {}; ++j) x[j] = *(const Memory*)(angles + j * LANES);\n", vectors);
      out += reduction(vectors);
      out += "  const double* const s = (const double*)sine;\n";
      out += "  const double* const c = (const double*)cosine;\n";
    }
    for (const Program::Load& load : program_.loads)
      out += declare(false, load.slot,
                     isTrig(load) ? fmt::format("{}[{}]", load.input == Input::kCos ? "c" : "s",
                                                place_.at(load.joint))
                                  : fmt::format("{}[{}]", source(load), load.joint));
    out += body(false);
    for (std::size_t i = 0; i < program_.outputs.size(); ++i)
      out += fmt::format("  out[{}] = {};\n", i, operand(program_.outputs[i]));
    return out + unused() + "}\n";
  }

  std::string many() const {
    std::string out = fmt::format(
        "\nstatic void {}_block(const double* q, const double* u, const double* w, double* out,\n"
        "                     long count) {{\n",
        name_);
    const int n = static_cast<int>(angles_.size());
    if (n > 0) {
      out += fmt::format("  V x[{0}], sine[{0}], cosine[{0}];\n", n);
      for (int k = 0; k < n; ++k)
        out += fmt::format("  x[{}] = *(const Memory*)(q + {} * count);\n", k, angles_[k]);
      out += reduction(n);
    }
    for (const Program::Load& load : program_.loads)
      out +=
          declare(true, load.slot,
                  isTrig(load)
                      ? fmt::format("{}[{}]", load.input == Input::kCos ? "cosine" : "sine",
                                    place_.at(load.joint))
                      : fmt::format("*(const Memory*)({} + {} * count)", source(load), load.joint));
    out += body(true);
    for (std::size_t i = 0; i < program_.outputs.size(); ++i) {
      const std::string value = operand(program_.outputs[i]);
      // a number is no vector
      out += in_body_[program_.outputs[i]]
                 ? fmt::format("  *(Memory*)(out + {} * count) = {};\n", i, value)
                 : fmt::format("  *(Memory*)(out + {} * count) = (V){{0}} + {};\n", i, value);
    }
    out += unused() + "}\n";

    std::map<std::string, int> entries = {{"q", 0}, {"u", 0}, {"w", 0}};
    int most = 1;
    for (const Program::Load& load : program_.loads) {
      int& count = entries[source(load)];
      count = std::max(count, load.joint + 1);
      most = std::max(most, count);
    }
    // what does not fill a block is computed in a block of its own, its last state repeated
    out += fmt::format(R"(
void {0}_many(const double* q, const double* u, const double* w, double* out, long count) {{
  long k = 0;
  for (; k + LANES <= count; k += LANES)
    {0}_block(q + k, u ? u + k : u, w ? w + k : w, out + k, count);
  if (k == count) return;
  double rest[3][{1}], result[{2}];
  const double* in[3] = {{q, u, w}};
  const int entries[3] = {{{4}, {5}, {6}}};
  for (int a = 0; a < 3; ++a)
    for (int j = 0; j < entries[a]; ++j)
      for (long i = 0; i < LANES; ++i)
        rest[a][j * LANES + i] = in[a][j * count + (k + i < count ? k + i : count - 1)];
  {0}_block(rest[0], rest[1], rest[2], result, LANES);
  for (int j = 0; j < {3}; ++j)
    for (long i = 0; k + i < count; ++i) out[j * count + k + i] = result[j * LANES + i];
}}
)",
                       name_, most * lanes_, program_.outputs.size() * lanes_,
                       program_.outputs.size(), entries["q"], entries["u"], entries["w"]);
    return out;
  }

 private:
  static bool isTrig(const Program::Load& load) {
    return load.input == Input::kCos || load.input == Input::kSin;
  }
  static const char* source(const Program::Load& load) {
    switch (load.input) {
      case Input::kPosition:
      case Input::kCos:
      case Input::kSin:
        return "q";
      case Input::kRotation:
        throw std::logic_error("emitKernel: no kernel reads a rotation matrix");
      case Input::kVelocity:
        return "u";
      default:
        return "w";
    }
  }
  static std::string unused() { return "  (void)q, (void)u, (void)w;\n"; }

  std::string reduction(int vectors) const {
    return fmt::format(
        "  I reducible = small(x[0]);\n"
        "  for (int j = 1; j < {0}; ++j) reducible &= small(x[j]);\n"
        "  if (__builtin_expect(all(reducible), 1))\n"
        "    for (int j = 0; j < {0}; ++j) sineCosine(x[j], sine + j, cosine + j);\n"
        "  else /* lane by lane: what stands beside an angle changes none of its bits */\n"
        "    for (int j = 0; j < {0}; ++j) {{\n"
        "      V beyond_sine, beyond_cosine;\n"
        "      const I near = small(x[j]);\n"
        "      sineCosine(x[j], sine + j, cosine + j);\n"
        "      libraryOf(x + j, &beyond_sine, &beyond_cosine, 1);\n"
        "      sine[j] = (V)((near & (I)sine[j]) | (~near & (I)beyond_sine));\n"
        "      cosine[j] = (V)((near & (I)cosine[j]) | (~near & (I)beyond_cosine));\n"
        "    }}\n",
        vectors);
  }
  std::string operand(int slot) const {
    return in_body_[slot] ? fmt::format("t{}", slot) : number(run_.slot(slot));
  }
  static std::string declare(bool lanes, int slot, const std::string& value) {
    return fmt::format("  const {} t{} = {};\n", lanes ? "V" : "double", slot, value);
  }
  std::string body(bool lanes) const {
    std::string out;
    for (const Program::Instruction& i : program_.body) {
      const std::string a = operand(i.a), b = operand(i.b);
      switch (i.code) {
        case Program::Code::kAdd:
          out += declare(lanes, i.result, a + " + " + b);
          break;
        case Program::Code::kSubtract:
          out += declare(lanes, i.result, a + " - " + b);
          break;
        case Program::Code::kMultiply:
          out += declare(lanes, i.result, a + " * " + b);
          break;
        case Program::Code::kNegate:
          out += declare(lanes, i.result, "-" + a);
          break;
        case Program::Code::kInverse:
          out += declare(lanes, i.result, "1.0 / " + a);
          break;
      }
    }
    return out;
  }

  const Program& program_;
  const symbolic::ProgramRun<double>& run_;
  std::string name_;
  int lanes_;
  std::vector<int> angles_;
  std::map<int, int> place_;  ///< of a joint among the angles
  std::vector<char> in_body_;
};

}  // namespace

std::string emitKernel(const Program& program, const symbolic::ProgramRun<double>& run,
                       const std::string& name, int lanes) {
  if (lanes != 2 && lanes != 4 && lanes != 8)
    throw std::invalid_argument(
        fmt::format("emitKernel: lanes: expected 2, 4 or 8, got {}", lanes));
  const Emitter emitter(program, run, name, lanes);
  using fmt::arg;
  return fmt::format(kPrelude, arg("bytes", lanes * 8), arg("lanes", lanes)) + kSineCosine +
         emitter.one() + emitter.many();
}

}  // namespace dynwitness::crosscheck::kernel
