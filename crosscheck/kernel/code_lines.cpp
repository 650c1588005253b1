// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/code_lines.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/error.hpp"

namespace dynwitness::crosscheck::kernel {

using symbolic::Input;
using symbolic::Program;

namespace {

bool isBinary(Program::Code code) {
  return code != Program::Code::kNegate && code != Program::Code::kInverse;
}

const char* sign(Program::Code code) {
  return code == Program::Code::kAdd ? " + " : code == Program::Code::kSubtract ? " - " : " * ";
}

void countOne(Program::Code code, CodeCount& count) {
  if (code == Program::Code::kMultiply) ++count.multiplications;
  if (code == Program::Code::kAdd || code == Program::Code::kSubtract) ++count.additions;
  if (code == Program::Code::kInverse) ++count.divisions;
}

}  // namespace

const char* word(CodeQuantity quantity) {
  return quantity == CodeQuantity::kC ? "coriolis_matrix" : name(quantity);
}

/// A function as far as it is written.
struct CodeLines::Writing {
  const CodeFunction& function;
  LiteralValues literals;
  Constants constants;
  std::vector<int> uses, in_sums;
  std::map<int, std::string> text;  ///< of slots
  std::string zero, one;
  int temporaries = 0;
  Body out;
};

CodeLines::CodeLines(const ControllerCode& code, CodeLanguage language, CodeScalar scalar)
    : code_(code), language_(language), scalar_(scalar) {
  if (scalar == CodeScalar::kFloat && language != CodeLanguage::kC)
    throw scene::InputError({},
                            "--scalar float: single precision is written in C, allowed: "
                            "--format c, or --scalar double");
}

std::string CodeLines::number(double x) const {
  std::string text = fmt::format("{}", x);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return x < 0 || std::signbit(x) ? "(" + text + ")" : text;
}

std::string CodeLines::literal(const Digits50& exact) const {
  if (scalar_ == CodeScalar::kDouble) return number(static_cast<double>(exact.value()));
  const float x = static_cast<float>(exact.value());
  if (!std::isfinite(x) || (x == 0 && !(exact == Digits50(0))))
    throw scene::InputError(
        {}, fmt::format("--scalar float: the scene's number {} is no float, allowed: double",
                        static_cast<double>(exact.value())));
  std::string text = fmt::format("{}", x);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return x < 0 ? "(" + text + "f)" : text + "f";
}

std::string CodeLines::element(const std::string& array, int i) const {
  switch (language_) {
    case CodeLanguage::kMatlab:
      return fmt::format("{}({})", array, i + 1);
    case CodeLanguage::kJulia:
      return fmt::format("{}[{}]", array, i + 1);
    default:
      return fmt::format("{}[{}]", array, i);
  }
}

std::string CodeLines::member(const std::string& of, const std::string& name) const {
  return of + (language_ == CodeLanguage::kC ? "->" : ".") + name;
}

std::string CodeLines::math(const char* function) const {
  if (language_ == CodeLanguage::kC && scalar_ == CodeScalar::kFloat)
    return std::string(function) + "f";
  return function;
}

std::string CodeLines::let(const std::string& variable, const std::string& value) const {
  switch (language_) {
    case CodeLanguage::kC:
      return "  const " + type() + " " + variable + " = " + value + ";\n";
    case CodeLanguage::kMatlab:
      return "  " + variable + " = " + value + ";\n";
    case CodeLanguage::kPython:
    case CodeLanguage::kJulia:
      return "    " + variable + " = " + value + "\n";
  }
  return "";
}

/// What a joint's friction takes at its rate.
std::string CodeLines::friction(int i, Body& body) const {
  const ControllerCode::JointFriction& f = code_.friction_[i];
  CodeCount& count = body.count;
  const std::string rate = element("qd", i);
  const Program& program = code_.friction_program_;
  const Constants constants = constantsOf(program);
  const LiteralValues literals(program, code_.scene_.mechanism);
  // viscous, positive, -negative of the joint
  const auto value = [&](int which, double folded) {
    const int slot = code_.isFolded() ? -1 : program.outputs[3 * i + which];
    const auto at = constants.index.find(slot);
    if (at != constants.index.end()) {
      body.reads_friction = true;
      return (which == 2 ? "-" : "") + element("friction", at->second);
    }
    return literal(Digits50(which == 2 ? -folded : folded));
  };
  std::string text;
  if (f.is_viscous) {
    text = value(0, f.viscous) + " * " + rate;
    ++count.multiplications;
  }
  if (!f.is_coulomb) return text;
  const std::string zero = literal(Digits50(0)), forward = value(1, f.positive),
                    back = value(2, f.negative);
  std::string coulomb;
  if (language_ == CodeLanguage::kPython)
    coulomb =
        fmt::format("({} if {} > 0.0 else ({} if {} < 0.0 else 0.0))", forward, rate, back, rate);
  else if (language_ == CodeLanguage::kMatlab)
    coulomb = fmt::format("({0} * ({1} > 0.0) + {2} * ({1} < 0.0))", forward, rate, back);
  else
    coulomb =
        fmt::format("(({0} > {3}) ? {1} : (({0} < {3}) ? {2} : {3}))", rate, forward, back, zero);
  count.comparisons += 2;
  if (language_ == CodeLanguage::kMatlab) {
    count.multiplications += 2;
    ++count.additions;
  }
  if (text.empty()) return coulomb;
  ++count.additions;
  return "(" + text + ") + " + coulomb;
}

/// The variable of a joint's friction, "" where it has none.
std::string CodeLines::frictionVariable(int i, Writing& w) const {
  if (!code_.hasFriction(w.function) || code_.friction_[i].isNone()) return "";
  w.out.reads.insert("qd");
  std::string variable = fmt::format("friction{}", i + 1);
  w.out.lines += let(variable, friction(i, w.out));
  return variable;
}

void CodeLines::load(const Program::Load& load, Writing& w) const {
  const auto reads = [&](const char* argument) {
    w.out.reads.insert(argument);
    return element(argument, load.joint);
  };
  std::string& here = w.text[load.slot];
  switch (load.input) {
    case Input::kPosition:
      here = reads("q");
      break;
    case Input::kCos:
    case Input::kSin: {
      const bool is_cos = load.input == Input::kCos;
      here = fmt::format("{}{}", is_cos ? "c" : "s", load.joint + 1);
      w.out.lines += let(here, math(is_cos ? "cos" : "sin") + "(" + reads("q") + ")");
      ++w.out.count.trigonometric;
      break;
    }
    case Input::kVelocity:
      here = reads("qd");
      break;
    case Input::kAcceleration:
      here = reads("qdd");
      break;
    case Input::kForce: {
      here = reads("tau");
      const std::string friction = frictionVariable(load.joint, w);
      if (friction.empty()) break;
      const std::string free = fmt::format("free{}", load.joint + 1);
      w.out.lines += let(free, here + " - " + friction);
      ++w.out.count.additions;
      here = free;
      break;
    }
    default:
      throw std::logic_error("CodeLines: no program reads this input");
  }
}

namespace {

/// Whether a text has an element of k, the only name that ends so.
bool readsConstants(const std::string& text) {
  return text.find("k[") != std::string::npos || text.find("k(") != std::string::npos;
}

/// A slot as an operand: what was written, a constant of the parameters, or a literal.
template <typename Writing, typename Literal, typename Element>
std::string operandOf(Writing& w, int slot, const Literal& literal, const Element& element) {
  if (const auto it = w.text.find(slot); it != w.text.end()) return it->second;
  if (const auto it = w.constants.index.find(slot); it != w.constants.index.end()) {
    return element("k", it->second);
  }
  return literal(w.literals.exact(slot));
}

}  // namespace

/// Numbers that are 0 or 1 by what irrational ones of the scene make together.
bool CodeLines::writeTrivial(const Program::Instruction& i, Writing& w) const {
  if (!isBinary(i.code)) return false;
  const auto operand = [&](int slot) {
    return operandOf(
        w, slot, [&](const Digits50& x) { return literal(x); },
        [&](const char* array, int k) { return element(array, k); });
  };
  const std::string a = operand(i.a), b = operand(i.b);
  const bool multiplies = i.code == Program::Code::kMultiply;
  if (multiplies && (a == w.zero || b == w.zero)) {
    w.text[i.result] = w.zero;
    return true;
  }
  const std::string& neutral = multiplies ? w.one : w.zero;
  if (b != neutral && (a != neutral || i.code == Program::Code::kSubtract)) return false;
  std::string same = b == neutral ? a : b;
  if (same.find(" * ") != std::string::npos) {  // a product that stood in this sum alone
    const std::string variable = fmt::format("t{}", ++w.temporaries);
    w.out.lines += let(variable, same);
    same = variable;
  }
  w.text[i.result] = same;
  return true;
}

void CodeLines::write(const Program::Instruction& i, Writing& w) const {
  if (writeTrivial(i, w)) return;
  const auto operand = [&](int slot) {
    return operandOf(
        w, slot, [&](const Digits50& x) { return literal(x); },
        [&](const char* array, int k) { return element(array, k); });
  };
  countOne(i.code, w.out.count);
  std::string value;
  if (isBinary(i.code))
    value = operand(i.a) + sign(i.code) + operand(i.b);
  else
    value = (i.code == Program::Code::kNegate ? "-" : w.one + " / ") + operand(i.a);
  // a product that one sum alone takes stands in it
  if (i.code == Program::Code::kMultiply && w.uses[i.result] == 1 && w.in_sums[i.result] == 1) {
    w.text[i.result] = "(" + value + ")";
    return;
  }
  const std::string variable = fmt::format("t{}", ++w.temporaries);
  w.out.lines += let(variable, value);
  w.text[i.result] = variable;
}

CodeLines::Body CodeLines::body(const CodeFunction& function) const {
  const Program& program = function.program;
  Writing w{function,
            LiteralValues(program, code_.scene_.mechanism),
            constantsOf(program),
            std::vector<int>(program.slots, 0),
            std::vector<int>(program.slots, 0),
            {},
            literal(Digits50(0)),
            literal(Digits50(1)),
            0,
            {}};
  for (const Program::Instruction& i : program.body) {
    const bool sums = i.code == Program::Code::kAdd || i.code == Program::Code::kSubtract;
    ++w.uses[i.a];
    w.in_sums[i.a] += sums ? 1 : 0;
    if (!isBinary(i.code)) continue;
    ++w.uses[i.b];
    w.in_sums[i.b] += sums ? 1 : 0;
  }
  for (const int slot : program.outputs) w.uses[slot] += 2;
  for (const Program::Load& one : program.loads)
    if (w.uses[one.slot] > 0) load(one, w);
  for (const Program::Instruction& i : program.body) write(i, w);
  for (std::size_t i = 0; i < program.outputs.size(); ++i) {
    std::string result = operandOf(
        w, program.outputs[i], [&](const Digits50& x) { return literal(x); },
        [&](const char* array, int k) { return element(array, k); });
    if (function.quantity == CodeQuantity::kTau) {
      const std::string friction = frictionVariable(static_cast<int>(i), w);
      if (!friction.empty()) {
        result += " + " + friction;
        ++w.out.count.additions;
      }
    }
    w.out.results.push_back(result);
  }
  for (const std::string& text : w.out.results) w.out.reads_constants |= readsConstants(text);
  w.out.reads_constants |= readsConstants(w.out.lines);
  return w.out;
}

// ---- what depends on the parameters alone ------------------------------------------------------

std::vector<std::pair<std::string, int>> CodeLines::constantArrays() const {
  std::vector<std::pair<std::string, int>> arrays;
  const auto add = [&](const std::string& name, const Program& program) {
    const Constants constants = constantsOf(program);
    if (!constants.slots.empty())
      arrays.emplace_back(name, static_cast<int>(constants.slots.size()));
  };
  for (const CodeFunction& function : code_.functions_)
    add(word(function.quantity), function.program);
  if (code_.needsFriction()) add("friction", code_.friction_program_);
  return arrays;
}

/// @param known  variables by what they are: functions share them
void CodeLines::initProgram(const Program& program, const std::string& array,
                            std::map<std::string, std::string>& known, Init& init) const {
  const Constants constants = constantsOf(program);
  if (constants.slots.empty()) return;
  const LiteralValues literals(program, code_.scene_.mechanism);
  std::map<int, std::string> text;
  const auto operand = [&](int slot) {
    const auto it = text.find(slot);
    return it != text.end() ? it->second : literal(literals.exact(slot));
  };
  for (std::size_t i = 0; i < program.atoms.size(); ++i) {
    const int slot = static_cast<int>(program.constants.size() + i);
    if (!constants.is_parametric[slot]) continue;
    text[slot] = member("parameters", program.atoms[i].number.parameter());
    init.reads_parameters = true;
  }
  for (const Program::Instruction& i : program.prologue) {
    if (!constants.is_parametric[i.result]) continue;
    std::string value;
    if (isBinary(i.code))
      value = operand(i.a) + sign(i.code) + operand(i.b);
    else
      value =
          (i.code == Program::Code::kNegate ? "-" : literal(Digits50(1)) + " / ") + operand(i.a);
    const auto [it, is_new] = known.emplace(value, fmt::format("t{}", known.size() + 1));
    text[i.result] = it->second;
    if (!is_new) continue;
    countOne(i.code, init.count);
    init.lines += let(it->second, value);
  }
  const bool ends = language_ == CodeLanguage::kC || language_ == CodeLanguage::kMatlab;
  const std::string indent = ends ? "  " : "    ";
  if (language_ == CodeLanguage::kPython || language_ == CodeLanguage::kJulia) {
    init.lines += indent + array + "_ = [";
    for (std::size_t k = 0; k < constants.slots.size(); ++k)
      init.lines += (k > 0 ? ", " : "") + text.at(constants.slots[k]);
    init.lines += "]\n";
    return;
  }
  for (std::size_t k = 0; k < constants.slots.size(); ++k)
    init.lines += indent + element(member("constants", array), static_cast<int>(k)) + " = " +
                  text.at(constants.slots[k]) + ";\n";
}

CodeLines::Init CodeLines::init() const {
  Init out;
  std::map<std::string, std::string> known;
  for (const CodeFunction& function : code_.functions_)
    initProgram(function.program, word(function.quantity), known, out);
  if (code_.needsFriction()) initProgram(code_.friction_program_, "friction", known, out);
  return out;
}

}  // namespace dynwitness::crosscheck::kernel
