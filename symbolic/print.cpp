// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/print.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "scene/mimic.hpp"

namespace dynwitness::symbolic {

namespace {

/// R_ij of the quaternion (w, x, y, z) that starts at a slot, for a formula in C or Python.
/// @param position  what a position slot is called
template <typename Position>
std::string rotationCode(int entry, const Position& position) {
  const auto q = [&](int k) { return position(entry / 9 + k); };
  const auto square = [&](int k) { return q(k) + "*" + q(k); };
  const std::string n =
      "(" + square(0) + " + " + square(1) + " + " + square(2) + " + " + square(3) + ")";
  const int i = entry % 9 / 3, j = entry % 3, k = 3 - i - j;
  if (i == j) {
    std::string sum = square(0);
    for (int m = 0; m < 3; ++m) sum += (m == i ? " + " : " - ") + square(m + 1);
    return "(" + sum + ")/" + n;
  }
  const bool plus = (j + 1) % 3 == i;  // R_yx, R_zy, R_xz
  return "2*(" + q(i + 1) + "*" + q(j + 1) + (plus ? " + " : " - ") + q(0) + "*" + q(k + 1) + ")/" +
         n;
}

bool isCode(Style style) {
  return style == Style::kC || style == Style::kPython || style == Style::kSympy;
}

/// The variable that holds a number of the scene in a program.
std::string atomName(const Atom& atom, std::size_t position) {
  if (atom.kind == Atom::Kind::kNumber) return identifier(atom.name);
  return "k" + std::to_string(position + 1);
}

/// Values with their formulas, used-once values inlined.
class Lister {
 public:
  Lister(const Program& program, Style style) : program_(program) {
    formulas_.resize(program.slots);
    uses_.assign(program.slots, 0);
    const int numbers = static_cast<int>(program.constants.size() + program.atoms.size());
    for (int slot = 0; slot < numbers; ++slot)
      formulas_[slot] = {leafFormula(program, slot, style), {}, 1};
    for (const Program::Load& load : program.loads)
      formulas_[load.slot] = {leafFormula(program, load.slot, style), {}, 1};
    for (const auto* part : {&program.prologue, &program.body}) {
      for (const Program::Instruction& i : *part) {
        ++uses_[i.a];
        if (isBinary(i)) ++uses_[i.b];
      }
    }
    // results, and what the body takes from the prologue, stand on lines of their own
    for (int output : program.outputs) uses_[output] += 2;
    std::vector<char> in_prologue(program.slots, 0);
    for (const Program::Instruction& i : program.prologue) in_prologue[i.result] = 1;
    for (const Program::Instruction& i : program.body)
      for (int operand : {i.a, isBinary(i) ? i.b : i.a})
        if (in_prologue[operand]) uses_[operand] += 2;
    for (const Program::Instruction& i : program.prologue) visit(i);
    for (const Program::Instruction& i : program.body) visit(i);
  }

  std::vector<Statement> take() { return std::move(statements_); }

 private:
  static constexpr int kLongest = 12;  ///< leaves on one line

  struct Inlined {
    Formula formula;
    std::vector<int> reads;
    int leaves = 0;
  };

  static bool isBinary(const Program::Instruction& i) {
    return i.code != Program::Code::kNegate && i.code != Program::Code::kInverse;
  }

  void visit(const Program::Instruction& i) {
    const Inlined& a = formulas_[i.a];
    const Inlined& b = formulas_[i.b];
    Inlined value;
    switch (i.code) {
      case Program::Code::kAdd:
        value.formula = Formula::sum({a.formula, b.formula});
        break;
      case Program::Code::kSubtract:
        value.formula = Formula::sum({a.formula, Formula::negate(b.formula)});
        break;
      case Program::Code::kMultiply:
        value.formula = Formula::product({a.formula, b.formula});
        break;
      case Program::Code::kNegate:
        value.formula = Formula::negate(a.formula);
        break;
      case Program::Code::kInverse:
        value.formula = Formula::power(a.formula, -1);
        break;
    }
    value.reads = a.reads;
    value.leaves = a.leaves;
    if (isBinary(i)) {
      value.reads.insert(value.reads.end(), b.reads.begin(), b.reads.end());
      value.leaves += b.leaves;
    }
    std::string name = program_.slot_names[i.result];
    if (name.empty() && uses_[i.result] <= 1 && value.leaves < kLongest) {
      formulas_[i.result] = value;
      return;
    }
    if (name.empty()) name = "t" + std::to_string(++temporaries_);
    statements_.push_back({i.result, name, value.formula, value.reads});
    formulas_[i.result] = {Formula::ofSymbol(name), {i.result}, 1};
  }

  const Program& program_;
  std::vector<Inlined> formulas_;
  std::vector<int> uses_;
  std::vector<Statement> statements_;
  int temporaries_ = 0;
};

/// An expression of the scene as code: the algebra for scene::evaluateIn.
struct Code {
  std::string text;
  friend Code operator+(const Code& a, const Code& b) {
    return {"(" + a.text + " + " + b.text + ")"};
  }
  friend Code operator-(const Code& a, const Code& b) {
    return {"(" + a.text + " - " + b.text + ")"};
  }
  friend Code operator*(const Code& a, const Code& b) { return {a.text + "*" + b.text}; }
  friend Code operator/(const Code& a, const Code& b) {
    return {"(" + a.text + "/" + b.text + ")"};
  }
  Code operator-() const { return {"(-" + text + ")"}; }
};
struct CodeAlgebra {
  Style style;
  Code number(const Rational& r) const {
    const std::string text = print(Formula::ofNumber(r), style);
    // quotients of Python's own integers are floating-point numbers
    if (style == Style::kSympy && denominator(r) == 1) return {"Integer(" + text + ")"};
    return {r < 0 ? "(" + text + ")" : text};
  }
  Code parameter(const std::string& name) const { return {identifier(name)}; }
  Code pi() const { return {style == Style::kSympy ? "pi" : "3.141592653589793"}; }
};

/// The differences between the two languages.
struct Language {
  Style style;
  std::string declare;  ///< before a local variable
  std::string end;      ///< after a statement
};

std::string atomCode(const Atom& atom, Style style) {
  const CodeAlgebra algebra{style};
  const auto code = [&](const scene::Number& n) {
    return scene::evaluateIn<Code>(n, algebra).text;
  };
  const std::string x = code(atom.axis[0]), y = code(atom.axis[1]), z = code(atom.axis[2]);
  const std::string rho = "sqrt(" + x + "*" + x + " + " + y + "*" + y + ")";
  const std::string length =
      "sqrt(" + x + "*" + x + " + " + y + "*" + y + " + " + z + "*" + z + ")";
  switch (atom.kind) {
    case Atom::Kind::kNumber:
      return code(atom.number);
    case Atom::Kind::kCos:
      return "cos(" + code(atom.number) + ")";
    case Atom::Kind::kSin:
      return "sin(" + code(atom.number) + ")";
    case Atom::Kind::kCosAlpha:
      return x + "/" + rho;
    case Atom::Kind::kSinAlpha:
      return y + "/" + rho;
    case Atom::Kind::kCosBeta:
      return z + "/" + length;
    case Atom::Kind::kSinBeta:
      return rho + "/" + length;
  }
  return "";
}

/// The lines of a function's body: numbers of the scene, state, statements, and the program's
/// outputs, one a line.
std::vector<std::string> bodyLines(const Equations& equations, const scene::Mechanism& mechanism,
                                   const Program& program, const Language& language) {
  std::vector<std::string> lines;
  const auto let = [&](const std::string& name, const std::string& value) {
    lines.push_back(language.declare + name + " = " + value + language.end);
  };
  const auto isParameter = [](const Atom& a) {
    return a.kind == Atom::Kind::kNumber && a.name != "pi";
  };
  // only the parameters that the statements read, or that the angles among them are made of
  std::set<std::string> read;
  for (const Atom& atom : program.atoms)
    for (const scene::Number& n : {atom.number, atom.axis[0], atom.axis[1], atom.axis[2]})
      for (const std::string& name : n.parameters()) read.insert(name);
  // q has no followers in it: they are formed where they are read
  std::map<int, std::string> position_of;
  const std::vector<int> given = scene::givenSlots(mechanism);
  for (std::size_t k = 0; k < given.size(); ++k)
    position_of[given[k]] = "q[" + std::to_string(k) + "]";
  for (const scene::Follower& f : scene::followers(mechanism)) {
    const auto code = [&](const scene::Number& n) {
      return scene::evaluateIn<Code>(n, CodeAlgebra{language.style}).text;
    };
    position_of[f.slot] =
        "(" + code(scene::Number(f.multiplier)) + "*" + position_of.at(f.leader_slot);
    if (!f.offset.isLiteralZero()) position_of[f.slot] += " + " + code(f.offset);
    position_of[f.slot] += ")";
    for (const std::string& name : f.offset.parameters()) read.insert(name);
  }
  const auto position = [&](int slot) { return position_of.at(slot); };
  for (std::size_t i = 0; i < mechanism.parameters.size(); ++i)
    if (read.count(mechanism.parameters[i].name) > 0)
      let(identifier(mechanism.parameters[i].name), "parameters[" + std::to_string(i) + "]");
  for (std::size_t i = 0; i < program.atoms.size(); ++i)
    if (!isParameter(program.atoms[i]))
      let(atomName(program.atoms[i], i), atomCode(program.atoms[i], language.style));
  for (const Program::Load& load : program.loads) {
    const std::string index = "[" + std::to_string(load.joint) + "]";
    const std::string name = print(Formula::ofInput(load.input, load.joint), language.style);
    switch (load.input) {
      case Input::kPosition:
        let(name, position(load.joint));
        break;
      case Input::kCos:
        let(name, "cos(" + position(load.joint) + ")");
        break;
      case Input::kSin:
        let(name, "sin(" + position(load.joint) + ")");
        break;
      case Input::kVelocity:
        let(name, "qd" + index);
        break;
      case Input::kAcceleration:
        let(name, "qdd" + index);
        break;
      case Input::kForce:
        let(name, "tau" + index);
        break;
      case Input::kDirection:
        let(name, language.style == Style::kSympy
                      ? "sign(qd" + index + ")"
                      : "(qd" + index + " > 0) - (qd" + index + " < 0)");
        break;
      case Input::kRotation:
        let(name, rotationCode(load.joint, position));
        break;
    }
  }
  std::map<int, std::string> name_of;
  for (const Statement& s : statements(program, language.style)) {
    let(s.name, print(s.value, language.style));
    name_of[s.slot] = s.name;
  }
  // outputs that are no statement are leaves
  const auto resultText = [&](int slot) {
    const auto it = name_of.find(slot);
    if (it != name_of.end()) return it->second;
    return print(leafFormula(program, slot, language.style), language.style);
  };
  const int n = equations.dof();
  for (int i = 0; i < static_cast<int>(program.outputs.size()); ++i) {
    const std::string value = resultText(program.outputs[i]);
    if (language.style == Style::kC) {
      const std::string target = i < n * n         ? "M[" + std::to_string(i) + "]"
                                 : i < n * (n + 1) ? "c[" + std::to_string(i - n * n) + "]"
                                                   : "g[" + std::to_string(i - n * (n + 1)) + "]";
      lines.push_back(target + " = " + value + language.end);
    } else {
      lines.push_back(value);
    }
  }
  return lines;
}

std::string parameterList(const scene::Mechanism& mechanism, Style style, bool names) {
  const scene::ParameterValues values = mechanism.parameterValues();
  std::string text;
  for (const scene::Parameter& p : mechanism.parameters) {
    if (!text.empty()) text += ", ";
    text +=
        names ? p.name : print(Formula::ofNumber(Rational(values.at(p.name).toDouble())), style);
  }
  return text;
}

std::string jointList(const Equations& equations) {
  std::string text;
  for (const std::string& joint : equations.joints) text += (text.empty() ? "" : ", ") + joint;
  // a comment must not end before it is over
  for (std::size_t i = 0; (i = text.find("*/", i)) != std::string::npos;) text.replace(i, 2, "* /");
  for (char& ch : text)
    if (ch == '\n' || ch == '\r' || ch == '"' || ch == '\\') ch = ' ';
  return text;
}

}  // namespace

std::vector<Statement> statements(const Program& program, Style style) {
  return Lister(program, style).take();
}

Formula leafFormula(const Program& program, int slot, Style style) {
  const std::size_t i = static_cast<std::size_t>(slot), constants = program.constants.size();
  if (i < constants) return Formula::ofNumber(program.constants[i]);
  if (i < constants + program.atoms.size()) {
    const Atom& atom = program.atoms[i - constants];
    return isCode(style) ? Formula::ofSymbol(atomName(atom, i - constants)) : Formula::ofAtom(atom);
  }
  for (const Program::Load& load : program.loads)
    if (load.slot == slot) return Formula::ofInput(load.input, load.joint);
  throw std::invalid_argument("leafFormula: slot: expected a number or a component of the state");
}

namespace {

/// What a reader of the code must know beyond the names of joints: lines, each with this in front.
std::string notes(const scene::Mechanism& mechanism, const std::string& indent) {
  std::string text;
  const std::size_t positions = scene::givenSlots(mechanism).size();
  for (const scene::Follower& f : scene::followers(mechanism))
    text += indent + "joint " + mechanism.links[f.link].joint.name + " follows " +
            mechanism.links[f.leader].joint.name + ": it has no entry in q and qd\n";
  if (static_cast<int>(positions) != mechanism.dof())
    text +=
        indent + "q: " + std::to_string(positions) +
        " positions, qd: " + std::to_string(mechanism.dof()) +
        " rates. A spherical joint has a quaternion (w, x, y, z) in q, of any\n" + indent +
        "length from 1e-150 to 1e150 (it is squared), a floating one x, y, z [m] and then a\n" +
        indent +
        "quaternion; their rates are the body's own, in its axes: (wx, wy, wz), or (vx, vy, vz, wx, wy, wz)\n";
  if (!mechanism.isOpenTree())
    text += indent +
            "these are the equations of the tree alone, without its closures and springs between "
            "points\n";
  return text;
}

/// Shapes and units of what a function takes and gives: lines, each with this in front.
std::string signatureNotes(const scene::Mechanism& mechanism, int n, const std::string& indent) {
  const auto count = [](std::size_t k) { return "[" + std::to_string(k) + "]"; };
  const auto dof = static_cast<std::size_t>(n);
  return indent + "q" + count(scene::givenSlots(mechanism).size()) + " [rad, m]: positions; qd" +
         count(dof) + " [rad/s, m/s]: rates; parameters" + count(mechanism.parameters.size()) +
         ": in SI units, in the order below\n" + indent + "M[" + std::to_string(n) + " x " +
         std::to_string(n) + "]" + " [kg m^2, kg m, kg], row by row; c" + count(dof) + " and g" +
         count(dof) + " [N m where joints turn, N where they slide]\n";
}

std::string withoutFriction(const scene::Mechanism& mechanism, const std::string& indent) {
  return mechanism.hasFriction()
             ? indent +
                   "friction is left out: viscous qd + coulomb sign(qd) of each joint belong to tau\n"
             : "";
}

/// Rows of a list, as many lines from `first` on as it has columns.
std::string pythonList(const std::vector<std::string>& lines, std::size_t first, int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + lines[first + i];
  return text + "]";
}

/// The rest of a function after its body's lines, of which the last are M row by row, c, g, ...
std::string pythonResults(const std::vector<std::string>& lines, int n,
                          const std::vector<std::string>& vectors) {
  const std::size_t first = lines.size() - n * (n + vectors.size());
  std::string text;
  for (std::size_t i = 0; i < first; ++i) text += "    " + lines[i] + "\n";
  text += "    M = [\n";
  for (int i = 0; i < n; ++i) text += "        " + pythonList(lines, first + i * n, n) + ",\n";
  text += "    ]\n";
  for (std::size_t k = 0; k < vectors.size(); ++k)
    text += "    " + vectors[k] + " = " + pythonList(lines, first + (n + k) * n, n) + "\n";
  return text;
}

/// "q1, q2": symbols of SymPy, as the text that symbols() takes.
std::string sympySymbols(const std::string& letter, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i > 0 ? " " : "") + letter + std::to_string(i + 1);
  return text;
}

/// A number as SymPy has it, exactly.
std::string sympyNumber(const scene::Exact& x) {
  const auto rational = [](const Rational& r) {
    return print(Formula::ofNumber(r), Style::kSympy);
  };
  if (x.pi_multiple == 0) return rational(x.rational);
  return (x.rational == 0 ? "" : rational(x.rational) + " + ") + rational(x.pi_multiple) + "*pi";
}

}  // namespace

std::string emitC(const Equations& equations, const scene::Mechanism& mechanism,
                  const std::string& name) {
  const Program program = compile(equations.graph, massCoriolisGravity(equations));
  const Program::Operations count = program.bodyOperations();
  const bool any = !mechanism.parameters.empty();
  std::string text =
      "/* M(q) qdd + c(q, qd) + g(q) = tau. Written by dynwitness from T and V.\n"
      "   joints: " +
      jointList(equations) + "\n" + signatureNotes(mechanism, equations.dof(), "   ") +
      notes(mechanism, "   ") + withoutFriction(mechanism, "   ") + "   " +
      std::to_string(count.multiplications) + " multiplications, " +
      std::to_string(count.additions) +
      " additions\n"
      "   parameters: " +
      (any ? parameterList(mechanism, Style::kC, true) : "none") +
      " */\n"
      "#include <math.h>\n\n"
      "const double " +
      name + "_parameters[] = {" + (any ? parameterList(mechanism, Style::kC, false) : "0.0") +
      "};\n\n"
      "void " +
      name +
      "(const double* q, const double* qd, const double* parameters,\n"
      "    double* M, double* c, double* g) {\n"
      "  (void)q; (void)qd; (void)parameters;\n";
  for (const std::string& line :
       bodyLines(equations, mechanism, program, {Style::kC, "const double ", ";"}))
    text += "  " + line + "\n";
  return text + "}\n";
}

std::string emitPython(const Equations& equations, const scene::Mechanism& mechanism,
                       const std::string& name) {
  const Program program = compile(equations.graph, massCoriolisGravity(equations));
  const int n = equations.dof();
  std::vector<std::string> lines =
      bodyLines(equations, mechanism, program, {Style::kPython, "", ""});
  std::string text =
      "\"\"\"M(q) qdd + c(q, qd) + g(q) = tau. Written by dynwitness from T and V.\n\n"
      "joints: " +
      jointList(equations) + "\n" + signatureNotes(mechanism, n, "") + notes(mechanism, "") +
      withoutFriction(mechanism, "") + "parameters: " +
      (mechanism.parameters.empty() ? "none" : parameterList(mechanism, Style::kPython, true)) +
      "\n\"\"\"\n"
      "from math import cos, sin, sqrt\n\n"
      "PARAMETERS = [" +
      parameterList(mechanism, Style::kPython, false) +
      "]\n\n\n"
      "def " +
      name +
      "(q, qd, parameters=PARAMETERS):\n"
      "    \"\"\"Mass matrix M (rows), Coriolis and centrifugal forces c, gravity forces g, as lists.\"\"\"\n";
  return text + pythonResults(lines, n, {"c", "g"}) + "    return M, c, g\n";
}

std::string emitSympy(const Equations& equations, const scene::Mechanism& mechanism) {
  std::vector<Node> outputs = massCoriolisGravity(equations);
  outputs.insert(outputs.end(), equations.Q.begin(), equations.Q.end());
  const int n = equations.dof(), positions = static_cast<int>(scene::givenSlots(mechanism).size());
  const std::vector<std::string> lines =
      bodyLines(equations, mechanism, compile(equations.graph, outputs), {Style::kSympy, "", ""});
  const scene::ParameterValues values = mechanism.parameterValues();
  std::string names, numbers;
  for (const scene::Parameter& p : mechanism.parameters) {
    // a parameter that is called as a coordinate is not that coordinate
    const bool is_coordinate = p.name.find_first_not_of("qd0123456789") == std::string::npos;
    names += (names.empty() ? "" : " ") + (is_coordinate ? identifier(p.name) : p.name);
    numbers += (numbers.empty() ? "" : ", ") + sympyNumber(values.at(p.name));
  }
  const auto tuple = [](const std::string& symbols) {
    return symbols.empty() ? "()" : "symbols(\"" + symbols + "\", real=True, seq=True)";
  };
  return "\"\"\"M(q) qdd + c(q, qd) + g(q) = tau + Q(q, qd) as expressions of SymPy. Written by dynwitness\n"
         "from T and V.\n\n"
         "M, c, g, Q and tau are matrices in the symbols q, qd, qdd and parameters, whose values in this\n"
         "scene are VALUES: M.subs(VALUES), M.diff(q[0]), lambdify([*q, *qd, *qdd], tau.subs(VALUES), cse=True).\n"
         "Q is what constant wrenches and friction do. equations() takes other symbols or functions of time.\n\n"
         "joints: " +
         jointList(equations) + "\n" + notes(mechanism, "") +
         "\"\"\"\n"
         "from sympy import Integer, Matrix, Rational, cos, pi, sign, sin, sqrt, symbols\n\n\n"
         "def equations(q, qd, parameters):\n"
         "    \"\"\"M row by row, c, g and Q at positions, rates and parameters of any kind.\"\"\"\n" +
         pythonResults(lines, n, {"c", "g", "Q"}) +
         "    return M, c, g, Q\n\n\n"
         "q = " +
         tuple(sympySymbols("q", positions)) + "\nqd = " + tuple(sympySymbols("qd", n)) +
         "\nqdd = " + tuple(sympySymbols("qdd", n)) + "\nparameters = " + tuple(names) +
         "\nVALUES = dict(zip(parameters, [" + numbers +
         "]))\n"
         "M, c, g, Q = (Matrix(part) for part in equations(q, qd, parameters))\n"
         "tau = M*Matrix(qdd) + c + g - Q\n";
}

}  // namespace dynwitness::symbolic
