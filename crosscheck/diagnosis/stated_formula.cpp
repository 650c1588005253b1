// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/stated_formula.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/nearest_name.hpp"
#include "scene/words.hpp"
#include "symbolic/numbers.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::Expression;
using symbolic::Input;
using symbolic::Node;
using symbolic::Value;
using Kind = Expression::Kind;

/// Column of a word in a text, counted from 1.
std::size_t columnOf(const std::string& word, const std::string& text) {
  const auto isLetter = [&text](std::size_t at) {
    return at < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  std::size_t at = text.find(word);
  while (at != std::string::npos && ((at > 0 && isLetter(at - 1)) || isLetter(at + word.size())))
    at = text.find(word, at + 1);
  return at == std::string::npos ? 1 : at + 1;
}

/// An expression as a node, letter by letter.
class Reader {
 public:
  Reader(const scene::Mechanism& mechanism, symbolic::Equations& equations, const std::string& text,
         const scene::SourceLocation& where)
      : equations_(equations),
        number_(mechanism, false, &equations.graph),
        text_(text),
        where_(where) {
    for (const scene::Parameter& p : mechanism.parameters) parameters_.push_back(p.name);
  }

  Value value(const Expression& e) {
    switch (e.kind()) {
      case Kind::kNumber:
        return constant(e.number());
      case Kind::kPi:
        return number_(e);
      case Kind::kParameter:
        return symbol(e.parameter());
      case Kind::kTime:
        return symbol("t");
      case Kind::kNegate:
        return -value(e.left());
      case Kind::kAdd:
        return value(e.left()) + value(e.right());
      case Kind::kSubtract:
        return value(e.left()) - value(e.right());
      case Kind::kMultiply:
        return value(e.left()) * value(e.right());
      case Kind::kDivide:
        return quotient(value(e.left()), value(e.right()));
      case Kind::kPower:
        return power(value(e.left()), e.exponent());
      case Kind::kCall:
        break;
    }
    if (e.function() != "cos" && e.function() != "sin")
      fail(e.function(), "no function here, allowed: cos, sin");
    const scene::CosSin<Value> point = circle(e.left());
    return e.function() == "cos" ? point.c : point.s;
  }

 private:
  [[noreturn]] void fail(const std::string& word, const std::string& what) const {
    throw scene::InputError(where_, fmt::format("expression \"{}\": column {}: {}: {}", text_,
                                                columnOf(word, text_), word, what));
  }

  Value constant(const symbolic::Rational& r) {
    return {&equations_.graph, equations_.graph.constant(r)};
  }
  Value quotient(Value a, Value b) {
    if (equations_.graph.isZero(b.node))
      throw scene::InputError(where_, fmt::format("expression \"{}\": division by 0", text_));
    return a / b;
  }
  Value power(Value base, int exponent) {
    Value result = constant(1);
    for (int k = 0; k < std::abs(exponent); ++k) result = result * base;
    return exponent < 0 ? quotient(constant(1), result) : result;
  }

  /// q1, qd2, qdd3: which input, and of which joint; none: another name.
  std::optional<std::pair<Input, int>> input(const std::string& name) const {
    const std::size_t digits = name.find_first_of("0123456789");
    if (digits == std::string::npos || name.size() - digits > 3 || name[digits] == '0') return {};
    if (!std::all_of(name.begin() + static_cast<std::ptrdiff_t>(digits), name.end(),
                     [](unsigned char ch) { return std::isdigit(ch) != 0; }))
      return {};
    static const std::map<std::string, Input> kLetters = {
        {"q", Input::kPosition}, {"qd", Input::kVelocity}, {"qdd", Input::kAcceleration}};
    const auto letter = kLetters.find(name.substr(0, digits));
    const int joint = std::stoi(name.substr(digits)) - 1;
    if (letter == kLetters.end() || joint >= equations_.dof()) return {};
    return std::pair(letter->second, joint);
  }

  Value symbol(const std::string& name) {
    if (std::find(parameters_.begin(), parameters_.end(), name) != parameters_.end())
      return number_(scene::Number::parse(name));
    if (const auto found = input(name))
      return {&equations_.graph, equations_.graph.input(found->first, found->second)};
    const std::string n = std::to_string(equations_.dof());
    std::vector<std::string> known = parameters_;
    for (const char* letter : {"q", "qd", "qdd"}) known.push_back(letter + n);
    fail(name, fmt::format("unknown{}, allowed: {}{}pi, q1..q{}, qd1..qd{}, qdd1..qdd{}, cos, sin",
                           scene::didYouMean(name, known), fmt::join(parameters_, ", "),
                           parameters_.empty() ? "" : ", ", n, n, n));
  }

  // ---- angles

  using Circle = scene::CosSin<Value>;
  static Circle sum(const Circle& a, const Circle& b) {
    return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s};
  }
  Circle multiple(Circle one, const symbolic::Rational& times) {
    if (times < 0) one.s = -one.s;
    Circle total{constant(1), constant(0)};
    for (symbolic::Rational k = abs(times); k > 0; k -= 1) total = sum(total, one);
    return total;
  }
  static bool mentions(const Expression& e, const std::vector<std::string>& names) {
    const std::set<std::string> found = e.parameters();
    return std::any_of(found.begin(), found.end(), [&names](const std::string& name) {
      return std::find(names.begin(), names.end(), name) == names.end();
    });
  }

  /// Cosine and sine of a sum of angles.
  Circle circle(const Expression& e) {
    switch (e.kind()) {
      case Kind::kNegate:
        return multiple(circle(e.left()), -1);
      case Kind::kAdd:
        return sum(circle(e.left()), circle(e.right()));
      case Kind::kSubtract:
        return sum(circle(e.left()), multiple(circle(e.right()), -1));
      case Kind::kMultiply:
        for (const auto& [factor, angle] :
             {std::pair(e.left(), e.right()), std::pair(e.right(), e.left())})
          if (factor.kind() == Kind::kNumber && isSmallInteger(factor.number()))
            return multiple(circle(angle), factor.number());
        break;
      default:
        break;
    }
    if (e.kind() == Kind::kParameter)
      if (const auto found = input(e.parameter());
          found &&
          std::find(parameters_.begin(), parameters_.end(), e.parameter()) == parameters_.end())
        return ofPosition(e.parameter(), *found);
    return fixed(e);
  }
  static bool isSmallInteger(const symbolic::Rational& r) {
    constexpr int kMostTurns = 20;  // a scene's formulas have at most twice its joints
    return denominator(r) == 1 && abs(r) <= kMostTurns;
  }
  Circle ofPosition(const std::string& name, const std::pair<Input, int>& at) {
    if (at.first != Input::kPosition) fail(name, "no angle, allowed in cos and sin: q");
    if (!equations_.revolute[static_cast<std::size_t>(at.second)])
      fail(name, "a length, not an angle, allowed in cos and sin: q of joints that turn");
    symbolic::Graph& graph = equations_.graph;
    return {{&graph, graph.input(Input::kCos, at.second)},
            {&graph, graph.input(Input::kSin, at.second)}};
  }
  Circle fixed(const Expression& e) {
    if (mentions(e, parameters_) || hasCall(e))
      throw scene::InputError(
          where_, fmt::format("expression \"{}\": angle {}, allowed in cos and sin: sums of whole "
                              "multiples of q1..q{} and of fixed angles in the parameters",
                              text_, e.text(), equations_.dof()));
    return number_.angle(e);
  }
  static bool hasCall(const Expression& e) {
    switch (e.kind()) {
      case Kind::kCall:
      case Kind::kTime:
        return true;
      case Kind::kNegate:
      case Kind::kPower:
        return hasCall(e.left());
      case Kind::kAdd:
      case Kind::kSubtract:
      case Kind::kMultiply:
      case Kind::kDivide:
        return hasCall(e.left()) || hasCall(e.right());
      default:
        return false;
    }
  }

  symbolic::Equations& equations_;
  symbolic::NodeNumbers number_;
  const std::string& text_;
  const scene::SourceLocation& where_;
  std::vector<std::string> parameters_;
};

symbolic::Equations derived(const scene::Mechanism& mechanism) {
  if (mechanism.dof() != mechanism.positions())
    throw scene::InputError({},
                            "formulas of a scene whose rates are no derivatives of its positions, "
                            "allowed: no spherical or floating joint, and none that follows");
  if (mechanism.dof() == 0)
    throw scene::InputError({}, "formulas of a scene that cannot move, allowed: a joint that does");
  symbolic::Options options;
  options.regroup_inertias = false;  // as `derive` does
  symbolic::Equations equations = symbolic::derive(mechanism, options);
  const symbolic::NodeNumbers number(mechanism, false, &equations.graph);
  for (const scene::Parameter& p : mechanism.parameters) number(scene::Number::parse(p.name));
  number(scene::Number::parse("pi"));
  return equations;
}

std::string indexed(const std::string& letters, int i, int j) {
  return fmt::format("{}{}{}{}", letters, i + 1, i > 8 || j > 8 ? "_" : "", j + 1);
}

}  // namespace

StatedLanguage::StatedLanguage(const scene::Mechanism& mechanism)
    : mechanism_(mechanism), equations_(derived(mechanism)) {
  symbolic::Equations& e = equations_;
  symbolic::Graph& graph = e.graph;
  quantities_ = {{"T", e.kinetic}, {"V", e.potential}};
  const auto add = [this](const char* letter, const std::vector<Node>& nodes) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      quantities_.emplace_back(letter + std::to_string(i + 1), nodes[i]);
  };
  add("p", e.p);
  std::vector<Node> tau;
  for (int i = 0; i < e.dof(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    Node sum = graph.subtract(graph.add(e.c[row], e.g[row]), e.Q[row]);
    for (int j = 0; j < e.dof(); ++j) {
      const Node entry = e.M[row][static_cast<std::size_t>(j)];
      quantities_.emplace_back(indexed("M", i, j), entry);
      sum = graph.add(sum, graph.multiply(entry, graph.input(Input::kAcceleration, j)));
    }
    tau.push_back(sum);
  }
  add("c", e.c);
  add("g", e.g);
  for (const scene::Link& link : mechanism.links)
    has_tau_ = has_tau_ && !link.joint.friction.isCoulomb();
  if (has_tau_) add("tau", tau);
}

std::string StatedLanguage::allowedNames() const {
  const int n = equations_.dof();
  std::string names = fmt::format("T, V, p1..p{0}, {1}..{2}, c1..c{0}, g1..g{0}", n,
                                  indexed("M", 0, 0), indexed("M", n - 1, n - 1));
  if (n < 10) names += fmt::format(", Gamma111..Gamma{0}{0}{0}", n);
  return has_tau_ ? names + fmt::format(", tau1..tau{}", n) : names;
}

Node StatedLanguage::quantity(const std::string& name, const scene::SourceLocation& where) {
  std::string plain = name;
  const std::size_t letters = plain.find_first_of("_0123456789");
  if (letters != std::string::npos && letters + 1 < plain.size() && plain[letters] == '_')
    plain.erase(letters, 1);
  for (const auto& [known, node] : quantities_)
    if (known == plain) return node;
  constexpr std::size_t kGamma = 5, kIndices = 3;
  if (plain.compare(0, kGamma, "Gamma") == 0 && plain.size() == kGamma + kIndices) {
    int index[kIndices];
    bool is_known = true;
    for (std::size_t k = 0; k < kIndices; ++k) {
      index[k] = plain[kGamma + k] - '1';
      is_known = is_known && index[k] >= 0 && index[k] < std::min(equations_.dof(), 9);
    }
    if (is_known) return symbolic::christoffelSymbol(equations_, index[0], index[1], index[2]);
  }
  std::vector<std::string> known;
  for (const auto& entry : quantities_) known.push_back(entry.first);
  const bool is_tau = !has_tau_ && plain.compare(0, 3, "tau") == 0;
  throw scene::InputError(where,
                          fmt::format("{}: {}{}, allowed before \"=\": {}", name,
                                      is_tau ? "has the sign of a rate, which no formula here has"
                                             : "no quantity of this scene",
                                      scene::didYouMean(plain, known), allowedNames()));
}

StatedLanguage::Read StatedLanguage::read(const StatedFormula& formula) {
  const std::size_t sign = formula.text.find('=');
  if (sign == std::string::npos || formula.text.find('=', sign + 1) != std::string::npos)
    throw scene::InputError(
        formula.where, fmt::format("\"{}\": allowed: NAME = EXPRESSION, as M12 = m*l^2*cos(q2)/2, "
                                   "NAME one of {}",
                                   formula.text, allowedNames()));
  const std::string name(scene::trimmed(formula.text.substr(0, sign))),
      right(scene::trimmed(formula.text.substr(sign + 1)));
  const Node derived_node = quantity(name, formula.where);
  const Expression expression = Expression::parseOfTime(right, formula.where);
  const Node stated = Reader(mechanism_, equations_, right, formula.where).value(expression).node;
  return {std::string(scene::trimmed(formula.text)), name, derived_node, stated};
}

}  // namespace dynwitness::crosscheck
