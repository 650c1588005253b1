// SPDX-License-Identifier: GPL-3.0-or-later
// The text of ControllerCode in each language: one operation of the program after the other.
#include <cctype>

#include <fmt/format.h>

#include "crosscheck/kernel/code_lines.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

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
    case CodeQuantity::kDtauDq:
      return {"q", "qd", "qdd"};
    case CodeQuantity::kQdd:
    case CodeQuantity::kDqddDq:
      return {"q", "qd", "tau"};
    case CodeQuantity::kC:
    case CodeQuantity::kc:
    case CodeQuantity::kDtauDqd:
    case CodeQuantity::kDqddDqd:
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
class CodeWriter : private CodeLines {
 public:
  CodeWriter(const ControllerCode& code, CodeLanguage language, CodeScalar scalar)
      : CodeLines(code, language, scalar) {}
  using CodeLines::body;

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
          "q: {} positions. A spherical joint has a quaternion (w, x, y, z), a floating one x, y, z "
          "and then a quaternion; their rates are the link's own, in its axes: (wx, wy, wz) or (vx, "
          "vy, vz, wx, wy, wz). Quaternions may have any length whose square is a normal number, {}; "
          "divide others by their largest component first",
          m.positions(),
          scalar_ == CodeScalar::kFloat ? "1e-18 to 1e18 in float" : "1e-150 to 1e150"));
    lines.push_back("matrices are written row by row; " +
                    (code_.isFolded() ? "all numbers of the scene are folded" : aboutParameters()));
    lines.push_back(!m.hasFriction()
                        ? "friction: the scene has none"
                        : "friction (viscous, Coulomb; 0 at rest): in tau, qdd and their "
                          "derivatives, not in M, c, g");
    lines.push_back(m.wrenches.empty() ? "constant wrenches Q: the scene has none"
                                       : "constant wrenches Q: in tau and qdd, not in M, c, g");
    if (m.isDriven() || !m.acceleration_constraints.empty())
      lines.push_back(
          "left out: driven joints are free here, and nothing is asked of accelerations");
    return lines;
  }
  /// Which numbers are fields, and what to do with them.
  std::string aboutParameters() const {
    const std::string& id = code_.identifier_;
    std::string text =
        "numbers of the scene are fields of parameters (" + id +
        "_parameters are the scene's own), but for angles, axes and what is 0, which are folded";
    for (std::size_t i = 0; i < code_.folded_.size(); ++i)
      text += (i == 0 ? ": " : ", ") + commented(code_.folded_[i]);
    return text + ". " + id +
           "_init computes what depends on them alone: call it once, and again after each change. "
           "Fields are taken as they are: nothing here finds that a mass is negative";
  }
  /// Of _init.
  std::vector<std::string> aboutInit(const CodeCount& c) const {
    return {"What depends on the parameters alone, for all functions.",
            fmt::format("once: {} multiplications, {} additions, {} divisions", c.multiplications,
                        c.additions, c.divisions)};
  }
  /// A field in words: its unit, and what --set calls it.
  static std::string aboutField(const CodeParameter& field) {
    const std::string unit =
        field.unit.empty() ? "unit as the scene has it" : "[" + field.unit + "]";
    return unit + (field.what == field.name ? "" : " " + commented(field.what));
  }
  /// "constants, " before the arguments.
  std::vector<std::string> withConstants(std::vector<std::string> all) const {
    if (!code_.isFolded()) all.insert(all.begin(), "constants");
    return all;
  }
  /// The arrays of constants that a body reads, under its names for them.
  std::string constantsOfBody(const CodeFunction& f, const Body& b) const {
    const bool is_c = language_ == CodeLanguage::kC;
    std::string text;
    const auto take = [&](const std::string& variable, const std::string& array) {
      const std::string value = language_ == CodeLanguage::kPython ? "constants[\"" + array + "\"]"
                                                                   : member("constants", array);
      text += is_c ? "  const " + type() + " *const " + variable + " = " + value + ";\n"
                   : let(variable, value);
    };
    if (b.reads_constants) take("k", word(f.quantity));
    if (b.reads_friction) take("friction", "friction");
    if (is_c && text.empty() && !code_.isFolded()) text = "  (void)constants;\n";
    return text;
  }
  /// A field's value, as a literal.
  std::string valueOf(std::size_t field) const {
    const scene::Mechanism& m = code_.scene_.mechanism;
    return literal(scene::RealNumbers<Digits50>(m)(m.parameters[field].value));
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
  /// By which q, where rates are no derivatives of it.
  std::string alongAxes() const {
    const scene::Mechanism& m = code_.scene_.mechanism;
    return m.positions() == m.dof() ? ""
                                    : " Column j as at a unit rate qd_j: along the link's axes.";
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
      case CodeQuantity::kDtauDq:
        return "Derivatives of tau by q, of q, qd, qdd: row i of tau_i." + alongAxes();
      case CodeQuantity::kDtauDqd:
        return "Derivatives of tau by qd, of q, qd: row i of tau_i.";
      case CodeQuantity::kDqddDq:
        return "Derivatives of qdd by q, of q, qd, tau: row i of qdd_i." + alongAxes();
      case CodeQuantity::kDqddDqd:
        return "Derivatives of qdd by qd, of q, qd: row i of qdd_i.";
      case CodeQuantity::kDqddDtau:
        return "Derivatives of qdd by tau, of q: the inverse of M.";
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
    if (!code_.isFolded()) text += "const " + code_.identifier_ + "_constants_type *constants, ";
    for (const std::string& argument : arguments(f.quantity))
      text += fmt::format("const {} {}[{}], ", type(), argument, entries(argument));
    return text + fmt::format("{} out[{}])", type(), size(f));
  }
  std::string cHeader() const {
    const std::string guard = upper(code_.identifier_) + "_H";
    std::string text = comment(header(), "/* ", "   ", " */");
    text += "#ifndef " + guard + "\n#define " + guard +
            "\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    if (!code_.isFolded()) text += cStructs();
    for (const CodeFunction& f : code_.functions_)
      text += "\n" + comment(about(f, body(f).count), "/* ", "   ", " */") + declaration(f) + ";\n";
    return text + "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
  }
  std::string cInitDeclaration() const {
    const std::string& id = code_.identifier_;
    return "void " + id + "_init(const " + id + "_parameters_type *parameters, " + id +
           "_constants_type *constants)";
  }
  std::string cStructs() const {
    const std::string& id = code_.identifier_;
    std::string text = "\n/* What the scene says in numbers. */\ntypedef struct {\n";
    for (const CodeParameter& field : code_.fields_)
      text += "  " + type() + " " + field.name + "; /* " + aboutField(field) + " */\n";
    if (code_.fields_.empty()) text += "  " + type() + " none;\n";
    text += "} " + id + "_parameters_type;\n\nextern const " + id + "_parameters_type " + id +
            "_parameters;\n\n/* What init makes of them. */\ntypedef struct {\n";
    const auto arrays = constantArrays();
    for (const auto& [array, size] : arrays)
      text += fmt::format("  {} {}[{}];\n", type(), array, size);
    if (arrays.empty()) text += "  " + type() + " none;\n";
    return text + "} " + id + "_constants_type;\n\n" +
           comment(aboutInit(init().count), "/* ", "   ", " */") + cInitDeclaration() + ";\n";
  }
  std::string cInit() const {
    const std::string& id = code_.identifier_;
    std::string text = "\nconst " + id + "_parameters_type " + id + "_parameters = {\n";
    for (std::size_t i = 0; i < code_.fields_.size(); ++i)
      text += "  ." + code_.fields_[i].name + " = " + valueOf(i) + ",\n";
    if (code_.fields_.empty()) text += "  .none = " + literal(Digits50(0)) + ",\n";
    const Init made = init();
    text += "};\n\n" + cInitDeclaration() + " {\n" + made.lines;
    if (!made.reads_parameters) text += "  (void)parameters;\n";
    if (constantArrays().empty()) text += "  constants->none = " + literal(Digits50(0)) + ";\n";
    return text + "}\n";
  }
  std::string cSource() const {
    std::string text = "#include \"" + code_.identifier_ + ".h\"\n\n";
    text += "#include <math.h>\n";
    if (!code_.isFolded()) text += cInit();
    for (const CodeFunction& f : code_.functions_) {
      const Body b = body(f);
      text += "\n" + declaration(f) + " {\n" + constantsOfBody(f, b) + b.lines;
      for (std::size_t i = 0; i < b.results.size(); ++i)
        text += fmt::format("  out[{}] = {};\n", i, b.results[i]);
      for (const std::string& argument : arguments(f.quantity))
        if (b.reads.count(argument) == 0) text += "  (void)" + argument + ";\n";
      text += "}\n";
    }
    return text;
  }

  // ---- Python, Julia, MATLAB -----------------------------------------------------------------

  /// Name = name, ... of the arrays of constants.
  std::string arraysAs(const std::string& quote, const std::string& equals) const {
    std::vector<std::string> texts;
    for (const auto& [array, size] : constantArrays())
      texts.push_back(quote + array + quote + equals + array + "_");
    return join(texts, ", ");
  }
  std::string pythonInit() const {
    const std::string& id = code_.identifier_;
    const Init made = init();
    std::string text = "\n\n@dataclass(frozen=True)\nclass " + id + "_parameters_type:\n" +
                       "    # with other values: dataclasses.replace(" + id +
                       "_parameters, FIELD=...)\n";
    for (std::size_t i = 0; i < code_.fields_.size(); ++i)
      text += "    " + code_.fields_[i].name + ": float = " + valueOf(i) + "  # " +
              aboutField(code_.fields_[i]) + "\n";
    if (code_.fields_.empty()) text += "    pass\n";
    return text + "\n\n" + id + "_parameters = " + id + "_parameters_type()\n\n\ndef " + id +
           "_init(parameters):\n" + comment(aboutInit(made.count), "    # ", "    # ", "") +
           made.lines + "    return {" + arraysAs("\"", ": ") + "}\n";
  }
  std::string pythonModule() const {
    std::string text = comment(header(), "# ", "# ", "");
    if (!code_.isFolded()) text += "from dataclasses import dataclass\n";
    text += "from math import cos, sin\n";
    if (!code_.isFolded()) text += pythonInit();
    for (const CodeFunction& f : code_.functions_) {
      const Body b = body(f);
      text += "\n\ndef " + functionName(f) + "(" +
              join(withConstants(arguments(f.quantity)), ", ") + "):\n" +
              comment(about(f, b.count), "    # ", "    # ", "") + constantsOfBody(f, b) + b.lines +
              "    return [";
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
  std::string juliaInit() const {
    const std::string& id = code_.identifier_;
    const Init made = init();
    std::string text = "\n# with other values: merge(" + id +
                       "_parameters, (FIELD = ...,))\nconst " + id + "_parameters = (;\n";
    for (std::size_t i = 0; i < code_.fields_.size(); ++i)
      text += "    " + code_.fields_[i].name + " = " + valueOf(i) + ",  # " +
              aboutField(code_.fields_[i]) + "\n";
    return text + ")\n\n" + comment(aboutInit(made.count), "# ", "# ", "") + "function " + id +
           "_init(parameters)\n" + made.lines + "    return (; " + arraysAs("", " = ") + ")\nend\n";
  }
  std::string juliaModule() const {
    std::string text = comment(header(), "# ", "# ", "");
    if (!code_.isFolded()) text += juliaInit();
    for (const CodeFunction& f : code_.functions_) {
      const Body b = body(f);
      text += "\n" + comment(about(f, b.count), "# ", "# ", "") + "function " + functionName(f) +
              "!(out, " + join(withConstants(arguments(f.quantity)), ", ") + ")\n" +
              constantsOfBody(f, b) + b.lines;
      for (int i = 0; i < size(f); ++i)
        text += "    " + target(f, i) + " = " + b.results[static_cast<std::size_t>(i)] + "\n";
      text += "    return out\nend\n";
    }
    return text;
  }
  std::string matlabParameters() const {
    std::string text = "function parameters = " + code_.identifier_ + "_parameters()\n" +
                       comment(header(), "  % ", "  % ", "") + "  parameters = struct();\n";
    for (std::size_t i = 0; i < code_.fields_.size(); ++i)
      text += "  parameters." + code_.fields_[i].name + " = " + valueOf(i) + "; % " +
              aboutField(code_.fields_[i]) + "\n";
    return text + "end\n";
  }
  std::string matlabInit() const {
    const Init made = init();
    return "function constants = " + code_.identifier_ + "_init(parameters)\n" +
           comment(aboutInit(made.count), "  % ", "  % ", "") + "  constants = struct();\n" +
           made.lines + "end\n";
  }
  std::string matlabFunction(const CodeFunction& f) const {
    const Body b = body(f);
    std::string text = "function out = " + functionName(f) + "(" +
                       join(withConstants(arguments(f.quantity)), ", ") + ")\n" +
                       comment(about(f, b.count), "  % ", "  % ", "") +
                       comment(header(), "  % ", "  % ", "") + constantsOfBody(f, b) + b.lines +
                       fmt::format("  out = zeros({}, {});\n", f.rows, f.columns);
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
    const std::string& id = code_.identifier_;
    if (!code_.isFolded())
      text += "  static " + id + "_constants_type constants[1];\n  " + id + "_init(&" + id +
              "_parameters, constants);\n";
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
                join(withConstants(arguments(f.quantity)), ", ") + ", out);\n" +
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
        if (!code_.isFolded())
          text += "constants = " + id + "." + id + "_init(" + id + "." + id + "_parameters)\n";
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
        if (!code_.isFolded()) text += "const constants = " + id + "_init(" + id + "_parameters)\n";
        end = "exit(failures[] == 0 ? 0 : 1)\n";
        break;
      default:
        text = "function failures = " + id + "_test()\n" +
               comment(aboutTest(), "  % ", "  % ", "") + "  failures = 0;\n";
        if (!code_.isFolded()) text += "  constants = " + id + "_init(" + id + "_parameters());\n";
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
        std::vector<std::string> given = withConstants({});
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
  if (!isFolded()) {
    all.emplace_back(id + "_parameters.m", writer.matlabParameters());
    all.emplace_back(id + "_init.m", writer.matlabInit());
  }
  for (const CodeFunction& f : functions_)
    all.emplace_back(writer.functionName(f) + ".m", writer.matlabFunction(f));
  all.emplace_back(id + "_test.m", writer.scriptTest(golden));
  return all;
}

}  // namespace dynwitness::crosscheck::kernel
