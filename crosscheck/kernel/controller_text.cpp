// SPDX-License-Identifier: GPL-3.0-or-later
// The text of ControllerCode in each language: one operation of the program after the other.
#include "crosscheck/kernel/controller_text.hpp"

#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/kernel/controller_code.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

using symbolic::Input;
using symbolic::Program;

/// The word of a quantity in names of functions: C and c are one file in some file systems.
const char* word(CodeQuantity quantity) {
  return quantity == CodeQuantity::kC ? "coriolis_matrix" : name(quantity);
}

/// A name of the scene in a comment, which it must not end.
std::string commented(const std::string& text) {
  std::string out;
  for (const char ch : text) {
    const bool plain = ch >= ' ' && ch < 127 && ch != '"' && ch != '\\';
    out += plain && !(ch == '/' && !out.empty() && out.back() == '*') ? ch : ' ';
  }
  return out;
}

std::vector<std::string> arguments(CodeQuantity quantity) {
  switch (quantity) {
    case CodeQuantity::kTau:
    case CodeQuantity::kY:
      return {"q", "qd", "qdd"};
    case CodeQuantity::kQdd:
      return {"q", "qd", "tau"};
    case CodeQuantity::kC:
    case CodeQuantity::kc:
    case CodeQuantity::kJacobianRate:
      return {"q", "qd"};
    default:
      return {"q"};
  }
}

std::string upper(std::string text) {
  for (char& ch : text) ch = static_cast<char>(std::toupper(static_cast<unsigned char>(ch)));
  return text;
}

std::string join(const std::vector<std::string>& parts, const std::string& between) {
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : between) + part;
  return out;
}

}  // namespace

/// Writes functions in one language.
class CodeWriter {
 public:
  CodeWriter(const ControllerCode& code, CodeLanguage language, CodeScalar scalar)
      : code_(code), language_(language), scalar_(scalar) {
    if (scalar == CodeScalar::kFloat && language != CodeLanguage::kC)
      throw scene::InputError({},
                              "--scalar float: single precision is written in C, allowed: "
                              "--format c, or --scalar double");
  }

  /// A number of the program or of a test.
  std::string number(double x) const {
    std::string text = fmt::format("{}", x);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return x < 0 || std::signbit(x) ? "(" + text + ")" : text;
  }
  std::string literal(const Digits50& exact) const {
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

  std::string element(const std::string& array, int i) const {
    switch (language_) {
      case CodeLanguage::kMatlab:
        return fmt::format("{}({})", array, i + 1);
      case CodeLanguage::kJulia:
        return fmt::format("{}[{}]", array, i + 1);
      default:
        return fmt::format("{}[{}]", array, i);
    }
  }
  std::string math(const char* function) const {
    if (language_ == CodeLanguage::kC && scalar_ == CodeScalar::kFloat)
      return std::string(function) + "f";
    return function;
  }
  std::string type() const { return scalar_ == CodeScalar::kFloat ? "float" : "double"; }
  std::string let(const std::string& variable, const std::string& value) const {
    switch (language_) {
      case CodeLanguage::kC:
        return "  const " + type() + " " + variable + " = " + value + ";\n";
      case CodeLanguage::kMatlab:
        return "  " + variable + " = " + value + ";\n";
      case CodeLanguage::kPython:
        return "    " + variable + " = " + value + "\n";
      case CodeLanguage::kJulia:
        return "    " + variable + " = " + value + "\n";
    }
    return "";
  }

  /// What a joint's friction takes at its rate.
  std::string friction(const ControllerCode::JointFriction& f, int i, CodeCount& count) const {
    const std::string rate = element("qd", i);
    const auto value = [&](double x) { return literal(Digits50(x)); };
    std::string text;
    if (f.viscous != 0) {
      text = value(f.viscous) + " * " + rate;
      ++count.multiplications;
    }
    if (f.positive == 0 && f.negative == 0) return text;
    const std::string zero = literal(Digits50(0)), forward = value(f.positive),
                      back = value(-f.negative);
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

  /// The lines of a function, and its results in order.
  struct Body {
    std::string lines;
    std::vector<std::string> results;
    std::set<std::string> reads;  ///< arguments
    CodeCount count;
  };
  Body body(const CodeFunction& function) const {
    const Program& program = function.program;
    const LiteralValues literals(program, code_.scene_.mechanism);
    std::vector<int> uses(program.slots, 0), in_sums(program.slots, 0);
    for (const Program::Instruction& i : program.body) {
      const bool binary = i.code != Program::Code::kNegate && i.code != Program::Code::kInverse;
      const bool sums = i.code == Program::Code::kAdd || i.code == Program::Code::kSubtract;
      ++uses[i.a];
      in_sums[i.a] += sums ? 1 : 0;
      if (!binary) continue;
      ++uses[i.b];
      in_sums[i.b] += sums ? 1 : 0;
    }
    for (const int slot : program.outputs) uses[slot] += 2;

    Body out;
    std::map<int, std::string> text;
    const bool friction_counts = code_.hasFriction(function);
    const auto reads = [&](const char* argument, int i) {
      out.reads.insert(argument);
      return element(argument, i);
    };
    const auto frictionOf = [&](int i) {
      if (!friction_counts || code_.friction_[i].isNone()) return std::string();
      out.reads.insert("qd");
      const std::string variable = fmt::format("friction{}", i + 1);
      out.lines += let(variable, friction(code_.friction_[i], i, out.count));
      return variable;
    };
    for (const Program::Load& load : program.loads) {
      if (uses[load.slot] == 0) continue;
      std::string& here = text[load.slot];
      switch (load.input) {
        case Input::kPosition:
          here = reads("q", load.joint);
          break;
        case Input::kCos:
        case Input::kSin: {
          const bool is_cos = load.input == Input::kCos;
          here = fmt::format("{}{}", is_cos ? "c" : "s", load.joint + 1);
          out.lines += let(here, math(is_cos ? "cos" : "sin") + "(" + reads("q", load.joint) + ")");
          ++out.count.trigonometric;
          break;
        }
        case Input::kVelocity:
          here = reads("qd", load.joint);
          break;
        case Input::kAcceleration:
          here = reads("qdd", load.joint);
          break;
        case Input::kForce: {
          here = reads("tau", load.joint);
          const std::string friction = frictionOf(load.joint);
          if (friction.empty()) break;
          const std::string free = fmt::format("free{}", load.joint + 1);
          out.lines += let(free, here + " - " + friction);
          ++out.count.additions;
          here = free;
          break;
        }
        default:
          throw std::logic_error("CodeWriter: no program reads this input");
      }
    }
    const auto operand = [&](int slot) {
      const auto it = text.find(slot);
      return it != text.end() ? it->second : literal(literals.exact(slot));
    };
    const std::string zero = literal(Digits50(0)), one = literal(Digits50(1));
    int temporaries = 0;
    for (const Program::Instruction& i : program.body) {
      // numbers that are 0 or 1 by what irrational ones of the scene make together
      if (i.code != Program::Code::kNegate && i.code != Program::Code::kInverse) {
        const std::string a = operand(i.a), b = operand(i.b);
        const bool multiplies = i.code == Program::Code::kMultiply;
        if (multiplies && (a == zero || b == zero)) {
          text[i.result] = zero;
          continue;
        }
        if (b == (multiplies ? one : zero) ||
            (a == (multiplies ? one : zero) && i.code != Program::Code::kSubtract)) {
          std::string same = b == (multiplies ? one : zero) ? a : b;
          if (same.find(" * ") != std::string::npos) {  // a product that stood in this sum alone
            const std::string variable = fmt::format("t{}", ++temporaries);
            out.lines += let(variable, same);
            same = variable;
          }
          text[i.result] = same;
          continue;
        }
      }
      std::string value;
      switch (i.code) {
        case Program::Code::kAdd:
        case Program::Code::kSubtract:
          value = operand(i.a) + (i.code == Program::Code::kAdd ? " + " : " - ") + operand(i.b);
          ++out.count.additions;
          break;
        case Program::Code::kMultiply:
          value = operand(i.a) + " * " + operand(i.b);
          ++out.count.multiplications;
          // a product that one sum alone takes stands in it
          if (uses[i.result] == 1 && in_sums[i.result] == 1) {
            text[i.result] = "(" + value + ")";
            continue;
          }
          break;
        case Program::Code::kNegate:
          value = "-" + operand(i.a);
          break;
        case Program::Code::kInverse:
          value = literal(Digits50(1)) + " / " + operand(i.a);
          ++out.count.divisions;
          break;
      }
      const std::string variable = fmt::format("t{}", ++temporaries);
      out.lines += let(variable, value);
      text[i.result] = variable;
    }
    for (std::size_t i = 0; i < program.outputs.size(); ++i) {
      std::string result = operand(program.outputs[i]);
      if (function.quantity == CodeQuantity::kTau) {
        const std::string friction = frictionOf(static_cast<int>(i));
        if (!friction.empty()) {
          result += " + " + friction;
          ++out.count.additions;
        }
      }
      out.results.push_back(result);
    }
    return out;
  }

  std::string functionName(const CodeFunction& function) const {
    return code_.identifier_ + "_" + word(function.quantity);
  }

  /// What stands above all functions, a line each.
  std::vector<std::string> header() const {
    const scene::Mechanism& m = code_.scene_.mechanism;
    std::vector<std::string> lines = {
        "Dynamics of " + commented(code_.scene_.name) + ". Written by dynwitness; SI units.",
        "    M(q) qdd + c(q, qd) + g(q) + friction(qd) = tau + Q"};
    std::string joints;
    for (const std::string& label : m.rateLabels())
      joints += (joints.empty() ? "" : ", ") + commented(label);
    lines.push_back("rates, in their order: " + joints);
    if (m.positions() != m.dof())
      lines.push_back(fmt::format(
          "q: {} positions. A spherical joint has a quaternion (w, x, y, z) of any length but 0, a "
          "floating one x, y, z and then a quaternion; their rates are the link's own, in its axes: "
          "(wx, wy, wz) or (vx, vy, vz, wx, wy, wz)",
          m.positions()));
    lines.push_back("matrices are written row by row; all numbers of the scene are folded");
    lines.push_back(!m.hasFriction()
                        ? "friction: the scene has none"
                        : "friction (viscous, Coulomb; 0 at rest): in tau and qdd, not "
                          "in M, c, g");
    lines.push_back(m.wrenches.empty() ? "constant wrenches Q: the scene has none"
                                       : "constant wrenches Q: in tau and qdd, not in M, c, g");
    if (m.isDriven() || !m.acceleration_constraints.empty())
      lines.push_back(
          "left out: driven joints are free here, and nothing is asked of accelerations");
    return lines;
  }
  /// Of one function.
  std::vector<std::string> about(const CodeFunction& function, const CodeCount& c) const {
    std::vector<std::string> lines = {sentence(function)};
    std::string counts =
        fmt::format("a call: {} multiplications, {} additions, {} divisions, {} cosines and sines",
                    c.multiplications, c.additions, c.divisions, c.trigonometric);
    if (c.comparisons > 0) counts += fmt::format(", {} comparisons", c.comparisons);
    lines.push_back(counts + " (" + function.road + ")");
    return lines;
  }
  std::string sentence(const CodeFunction& f) const {
    switch (f.quantity) {
      case CodeQuantity::kTau:
        return "Joint forces tau of q, qd, qdd (inverse dynamics).";
      case CodeQuantity::kQdd:
        return "Joint accelerations qdd of q, qd, tau (forward dynamics).";
      case CodeQuantity::kM:
        return "Mass matrix M of q.";
      case CodeQuantity::kC:
        return "Coriolis matrix C of q, qd: c = C qd, dM/dt - 2 C is skew.";
      case CodeQuantity::kc:
        return "Coriolis and centrifugal forces c of q, qd.";
      case CodeQuantity::kg:
        return "Gravity forces g = dV/dq of q, springs included.";
      case CodeQuantity::kY: {
        std::string text = "Regressor Y of q, qd, qdd: M qdd + c + g = Y pi + springs, pi =";
        for (const scene::InertialParameter& p : code_.parameters_)
          text += " " + commented(scene::label(p, code_.scene_.mechanism));
        return text + ".";
      }
      default:
        break;
    }
    const CodePoint& p = *code_.point_;
    const std::string where = fmt::format(
        "point ({}, {}, {}) of link {}", commented(p.at[0].text()), commented(p.at[1].text()),
        commented(p.at[2].text()), commented(code_.scene_.mechanism.links[p.link].name));
    switch (f.quantity) {
      case CodeQuantity::kPosition:
        return "Position of the " + where + ", world axes.";
      case CodeQuantity::kOrientation:
        return "Orientation of the link of the " + where + ": its axes are the columns.";
      case CodeQuantity::kJacobian:
        return "Jacobian J of the " + where + ": (v, w) = J qd, world axes.";
      default:
        return "dJ/dt along qd of the Jacobian of the " + where + ".";
    }
  }

  static std::string comment(const std::vector<std::string>& lines, const std::string& start,
                             const std::string& next, const std::string& end) {
    std::string out;
    for (const std::string& line : lines) {
      // at 100 columns
      std::size_t from = 0;
      while (from < line.size() || (from == 0 && line.empty())) {
        std::size_t to = line.size() - from > 92 ? line.rfind(' ', from + 92) : line.size();
        if (to == std::string::npos || to <= from) to = line.size();
        out += (out.empty() ? start : next) + (from > 0 ? "  " : "") + line.substr(from, to - from);
        from = to + 1;
        out += from < line.size() ? "\n" : "";
        if (line.empty()) break;
      }
      if (&line != &lines.back()) out += "\n";
    }
    return out + end + "\n";
  }

  int entries(const std::string& argument) const {
    return argument == "q" ? code_.scene_.mechanism.positions() : code_.scene_.mechanism.dof();
  }
  static int size(const CodeFunction& f) { return f.rows * f.columns; }

  // ---- C -------------------------------------------------------------------------------------

  std::string declaration(const CodeFunction& f) const {
    std::string text = "void " + functionName(f) + "(";
    for (const std::string& argument : arguments(f.quantity))
      text += fmt::format("const {} {}[{}], ", type(), argument, entries(argument));
    return text + fmt::format("{} out[{}])", type(), size(f));
  }
  std::string cHeader() const {
    const std::string guard = upper(code_.identifier_) + "_H";
    std::string text = comment(header(), "/* ", "   ", " */");
    text += "#ifndef " + guard + "\n#define " + guard +
            "\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    for (const CodeFunction& f : code_.functions_)
      text += "\n" + comment(about(f, body(f).count), "/* ", "   ", " */") + declaration(f) + ";\n";
    return text + "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
  }
  std::string cSource() const {
    std::string text = "#include \"" + code_.identifier_ + ".h\"\n\n";
    text += "#include <math.h>\n";
    for (const CodeFunction& f : code_.functions_) {
      const Body b = body(f);
      text += "\n" + declaration(f) + " {\n" + b.lines;
      for (std::size_t i = 0; i < b.results.size(); ++i)
        text += fmt::format("  out[{}] = {};\n", i, b.results[i]);
      for (const std::string& argument : arguments(f.quantity))
        if (b.reads.count(argument) == 0) text += "  (void)" + argument + ";\n";
      text += "}\n";
    }
    return text;
  }

  // ---- Python, Julia, MATLAB -----------------------------------------------------------------

  std::string pythonModule() const {
    std::string text = comment(header(), "# ", "# ", "") + "from math import cos, sin\n";
    for (const CodeFunction& f : code_.functions_) {
      const Body b = body(f);
      text += "\n\ndef " + functionName(f) + "(" + join(arguments(f.quantity), ", ") + "):\n" +
              comment(about(f, b.count), "    # ", "    # ", "") + b.lines + "    return [";
      for (int i = 0; i < f.rows; ++i) {
        std::vector<std::string> row(b.results.begin() + i * f.columns,
                                     b.results.begin() + (i + 1) * f.columns);
        const std::string listed = join(row, ", ");
        text += (i > 0 ? ",\n            " : "") + (f.columns > 1 ? "[" + listed + "]" : listed);
      }
      text += "]\n";
    }
    return text;
  }
  std::string target(const CodeFunction& f, int i) const {
    const bool matlab = language_ == CodeLanguage::kMatlab;
    const std::string index = f.columns > 1
                                  ? fmt::format("{}, {}", i / f.columns + 1, i % f.columns + 1)
                                  : fmt::format("{}", i + 1);
    return matlab ? "out(" + index + ")" : "out[" + index + "]";
  }
  std::string juliaModule() const {
    std::string text = comment(header(), "# ", "# ", "");
    for (const CodeFunction& f : code_.functions_) {
      const Body b = body(f);
      text += "\n" + comment(about(f, b.count), "# ", "# ", "") + "function " + functionName(f) +
              "!(out, " + join(arguments(f.quantity), ", ") + ")\n" + b.lines;
      for (int i = 0; i < size(f); ++i)
        text += "    " + target(f, i) + " = " + b.results[static_cast<std::size_t>(i)] + "\n";
      text += "    return out\nend\n";
    }
    return text;
  }
  std::string matlabFunction(const CodeFunction& f) const {
    const Body b = body(f);
    std::string text =
        "function out = " + functionName(f) + "(" + join(arguments(f.quantity), ", ") + ")\n" +
        comment(about(f, b.count), "  % ", "  % ", "") + comment(header(), "  % ", "  % ", "") +
        b.lines + fmt::format("  out = zeros({}, {});\n", f.rows, f.columns);
    for (int i = 0; i < size(f); ++i)
      if (const std::string& value = b.results[static_cast<std::size_t>(i)]; value != number(0))
        text += "  " + target(f, i) + " = " + value + ";\n";
    return text + "end\n";
  }

  // ---- tests ---------------------------------------------------------------------------------

  std::string list(const std::vector<double>& values, bool as_scalar) const {
    std::vector<std::string> texts;
    for (const double x : values) {
      std::string text = as_scalar ? literal(Digits50(x)) : number(x);
      if (text == "inf") text = language_ == CodeLanguage::kC ? "HUGE_VAL" : "Inf";
      texts.push_back(text);
    }
    return join(texts, ", ");
  }
  static std::vector<double> argument(const std::string& name, const scene::State<double>& s) {
    if (name == "qd") return s.qd;
    if (name == "qdd") return s.qdd;
    if (name == "tau") return s.tau;
    std::vector<double> q;
    for (const scene::JointPosition<double>& x : s.x) q.push_back(x.q);
    return q;
  }
  std::vector<std::string> aboutTest() const {
    return {"Whether the functions of " + code_.identifier_ + " answer what recursive sweeps of",
            "dynwitness answer, within what rounding may do to both: each limit is a bound of this",
            "very code's roundings, cosines and sines within 1 ulp taken as given."};
  }
  std::string cTest(const std::vector<GoldenCase>& golden) const {
    std::string text = comment(aboutTest(), "/* ", "   ", " */") + "#include \"" +
                       code_.identifier_ + R"(.h"

#include <math.h>
#include <stdio.h>

static int failures = 0;

static void check(const char* what, int count, const )" +
                       type() + R"(* value, const double* expected,
                  const double* limit) {
  for (int i = 0; i < count; ++i) {
    const double off = fabs((double)value[i] - expected[i]);
    if (!(off <= limit[i])) {
      (void)printf("%s[%d]: expected %.17g, got %.17g, limit %.3g\n", what, i, expected[i],
                   (double)value[i], limit[i]);
      ++failures;
    }
  }
}

int main(void) {
)";
    for (const GoldenCase& one : golden)
      for (std::size_t k = 0; k < code_.functions_.size(); ++k) {
        const CodeFunction& f = code_.functions_[k];
        text += "  {\n";
        for (const std::string& a : arguments(f.quantity))
          text += "    const " + type() + " " + a + "[] = {" + list(argument(a, one.state), true) +
                  "};\n";
        text += fmt::format("    const double expected[] = {{{}}};\n", list(one.value[k], false)) +
                fmt::format("    const double limit[] = {{{}}};\n", list(one.limit[k], false)) +
                fmt::format("    {} out[{}];\n", type(), size(f)) + "    " + functionName(f) + "(" +
                join(arguments(f.quantity), ", ") + ", out);\n" +
                fmt::format("    check(\"{}\", {}, out, expected, limit);\n  }}\n",
                            name(f.quantity), size(f));
      }
    return text + "  return failures == 0 ? 0 : 1;\n}\n";
  }
  /// The same in the others, a call a case.
  std::string scriptTest(const std::vector<GoldenCase>& golden) const {
    const std::string id = code_.identifier_;
    std::string text, end;
    switch (language_) {
      case CodeLanguage::kPython:
        text = comment(aboutTest(), "# ", "# ", "") + "import sys\n\nimport " + id + R"(

Inf = float("inf")
failures = 0


def check(what, value, expected, limit):
    global failures
    flat = [x for row in value for x in (row if isinstance(row, list) else [row])]
    for i, (got, wanted, most) in enumerate(zip(flat, expected, limit)):
        if not abs(got - wanted) <= most:
            print("%s[%d]: expected %.17g, got %.17g, limit %.3g" % (what, i, wanted, got, most))
            failures += 1
    if len(flat) != len(expected):
        print("%s: expected %d numbers, got %d" % (what, len(expected), len(flat)))
        failures += 1


)";
        end = "sys.exit(0 if failures == 0 else 1)\n";
        break;
      case CodeLanguage::kJulia:
        text = comment(aboutTest(), "# ", "# ", "") + "include(\"" + id + R"(.jl")

const failures = Ref(0)
function check(what, value, expected, limit)
    flat = vec(permutedims(value))
    for i in eachindex(flat)
        if !(abs(flat[i] - expected[i]) <= limit[i])
            println(what, "[", i, "]: expected ", expected[i], ", got ", flat[i], ", limit ", limit[i])
            failures[] += 1
        end
    end
end

)";
        end = "exit(failures[] == 0 ? 0 : 1)\n";
        break;
      default:
        text = "function failures = " + id + "_test()\n" +
               comment(aboutTest(), "  % ", "  % ", "") + "  failures = 0;\n";
        end =
            "end\n\nfunction wrong = check(what, value, expected, limit)\n"
            "  flat = reshape(value.', 1, []);\n"
            "  wrong = sum(~(abs(flat - expected) <= limit));\n"
            "  if wrong > 0\n"
            "    fprintf('%s: %d numbers are beyond their limits\\n', what, wrong);\n"
            "  end\nend\n";
    }
    for (const GoldenCase& one : golden)
      for (std::size_t k = 0; k < code_.functions_.size(); ++k) {
        const CodeFunction& f = code_.functions_[k];
        std::vector<std::string> given;
        for (const std::string& a : arguments(f.quantity))
          given.push_back("[" + list(argument(a, one.state), true) + "]");
        const std::string expected = "[" + list(one.value[k], false) + "]",
                          limit = "[" + list(one.limit[k], false) + "]", what = name(f.quantity);
        const std::string call = functionName(f);
        if (language_ == CodeLanguage::kPython)
          text += fmt::format("check(\"{}\", {}.{}({}), {}, {})\n", what, id, call,
                              join(given, ", "), expected, limit);
        else if (language_ == CodeLanguage::kJulia)
          text += fmt::format("check(\"{}\", {}!(zeros({}, {}), {}), {}, {})\n", what, call, f.rows,
                              f.columns, join(given, ", "), expected, limit);
        else
          text += fmt::format("  failures = failures + check('{}', {}({}), {}, {});\n", what, call,
                              join(given, ", "), expected, limit);
      }
    return text + end;
  }

 private:
  const ControllerCode& code_;
  CodeLanguage language_;
  CodeScalar scalar_;
};

CodeCount ControllerCode::count(const CodeFunction& function) const {
  return CodeWriter(*this, CodeLanguage::kC, CodeScalar::kDouble).body(function).count;
}

std::vector<std::pair<std::string, std::string>> ControllerCode::files(
    CodeLanguage language, CodeScalar scalar, const std::vector<GoldenCase>& golden) const {
  const CodeWriter writer(*this, language, scalar);
  const std::string& id = identifier_;
  switch (language) {
    case CodeLanguage::kC:
      return {{id + ".h", writer.cHeader()},
              {id + ".c", writer.cSource()},
              {id + "_test.c", writer.cTest(golden)}};
    case CodeLanguage::kPython:
      return {{id + ".py", writer.pythonModule()}, {id + "_test.py", writer.scriptTest(golden)}};
    case CodeLanguage::kJulia:
      return {{id + ".jl", writer.juliaModule()}, {id + "_test.jl", writer.scriptTest(golden)}};
    case CodeLanguage::kMatlab:
      break;
  }
  std::vector<std::pair<std::string, std::string>> all;
  for (const CodeFunction& f : functions_)
    all.emplace_back(writer.functionName(f) + ".m", writer.matlabFunction(f));
  all.emplace_back(id + "_test.m", writer.scriptTest(golden));
  return all;
}

}  // namespace dynwitness::crosscheck::kernel
