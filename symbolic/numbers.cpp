// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/numbers.hpp"

#include <array>

#include "scene/rational_signs.hpp"

namespace dynwitness::symbolic {
namespace {

/// Expressions as nodes, with parameters as symbols or as their values.
struct NodeAlgebra {
  Graph* graph;
  bool fold;
  const scene::ParameterValues* values;

  Value number(const Rational& r) const { return {graph, graph->constant(r)}; }
  Value pi() const {
    return {graph, graph->atom({Atom::Kind::kNumber, scene::Number::parse("pi"), {}, "pi"})};
  }
  Value exact(const scene::Exact& x) const {
    Value value = number(x.rational);
    if (!scene::isZero(x.pi_multiple)) value += number(x.pi_multiple) * pi();
    return value;
  }
  Value parameter(const std::string& name) const {
    if (fold) return exact(values->at(name));
    return {graph, graph->atom({Atom::Kind::kNumber, scene::Number::parse(name), {}, name})};
  }
};

bool squareRoot(const Rational& square, Rational* root) {
  using boost::multiprecision::sqrt;
  const scene::Integer n = sqrt(scene::Integer(numerator(square)));
  const scene::Integer d = sqrt(scene::Integer(denominator(square)));
  *root = Rational(n, d);
  return scene::areEqual(*root * *root, square);
}

std::string exactText(const scene::Exact& x) {
  return x.rational.str() +
         (scene::isZero(x.pi_multiple) ? "" : " + " + x.pi_multiple.str() + " pi");
}

}  // namespace

NodeNumbers::NodeNumbers(const scene::Mechanism& mechanism, bool fold_parameters, Graph* graph)
    : graph_(graph), fold_parameters_(fold_parameters), values_(mechanism.parameterValues()) {}

bool NodeNumbers::isExact(const scene::Number& n) const {
  return fold_parameters_ || n.parameters().empty();
}

Value NodeNumbers::operator()(const scene::Number& n) const {
  const NodeAlgebra algebra{graph_, fold_parameters_, &values_};
  if (isExact(n)) return algebra.exact(exactValue(n, values_));
  return scene::evaluateIn<Value>(n, algebra);
}

Vector3 NodeNumbers::vector(const scene::Vector& v) const {
  return {(*this)(v[0]), (*this)(v[1]), (*this)(v[2])};
}

scene::CosSin<Value> NodeNumbers::angle(const scene::Number& radians) {
  scene::Number written = radians;
  std::string name = radians.text();
  bool negate = false;
  if (isExact(radians)) {
    scene::Exact exact = exactValue(radians, values_);
    int quarter = 0;
    if (scene::isQuarterTurn(exact, &quarter)) {
      const auto turns = scene::quarterTurns<int>(quarter);
      return {constant(graph_, turns.c), constant(graph_, turns.s)};
    }
    const bool is_negative = scene::isNegative(exact);
    if (is_negative) exact = {-exact.rational, -exact.pi_multiple};
    const auto it = angles_.emplace(exactText(exact), std::pair(radians, is_negative)).first;
    written = it->second.first;
    negate = is_negative != it->second.second;
    name = written.text();
  }
  const Value c{graph_, graph_->atom({Atom::Kind::kCos, written, {}, "cos(" + name + ")"})};
  const Value s{graph_, graph_->atom({Atom::Kind::kSin, written, {}, "sin(" + name + ")"})};
  return {c, negate ? -s : s};
}

NodeNumbers::AlongCoordinate NodeNumbers::alongCoordinate(const scene::Vector& axis) const {
  const auto isZero = [&](const scene::Number& n) {
    return isExact(n) && exactValue(n, values_).isZero();
  };
  for (int i = 0; i < 3; ++i)
    // the sign of a symbol is not known here: only a number may say that the axis is reversed
    if (isZero(axis[(i + 1) % 3]) && isZero(axis[(i + 2) % 3]) && isExact(axis[i]))
      return {i, scene::isNegative(exactValue(axis[i], values_))};
  return {};
}

scene::AxisTurn<Value> NodeNumbers::axisTurn(const scene::Vector& axis, int label) {
  std::array<scene::Exact, 3> exact;
  std::array<bool, 3> is_zero;
  bool all_rational = true;
  for (int i = 0; i < 3; ++i) {
    exact[i] = exactValue(axis[i], values_);
    is_zero[i] = isExact(axis[i]) && exact[i].isZero();
    all_rational = all_rational && isExact(axis[i]) && exact[i].isRational();
  }
  const Value zero = constant(graph_, 0), one = constant(graph_, 1);
  const std::string text =
      "(" + axis[0].text() + ", " + axis[1].text() + ", " + axis[2].text() + ")";
  const int named = axes_.emplace(text, label).first->second;
  const auto symbol = [&](Atom::Kind kind, const std::string& what) {
    // with a space, which no parameter's name has
    return Value{graph_,
                 graph_->atom({kind, 0, axis, what + " axis" + std::to_string(named) + ")"})};
  };
  scene::AxisTurn<Value> turn;
  Rational rho, length;
  const bool rho_exact = all_rational && squareRoot(exact[0].rational * exact[0].rational +
                                                        exact[1].rational * exact[1].rational,
                                                    &rho);
  if (rho_exact) {
    turn.alpha.c = constant(graph_, exact[0].rational / rho);
    turn.alpha.s = constant(graph_, exact[1].rational / rho);
  } else {
    // alone beside z it is the cosine or sine of a quarter turn, whose sign a symbol does not tell
    const auto aloneBesideZ = [&](int i, Atom::Kind kind, const char* what) {
      if (is_zero[1 - i] && isExact(axis[i]))
        return constant(graph_, exact[i].approximation() < 0 ? -1 : 1);
      return symbol(kind, what);
    };
    turn.alpha.c = is_zero[0] ? zero : aloneBesideZ(0, Atom::Kind::kCosAlpha, "cos(alpha");
    turn.alpha.s = is_zero[1] ? zero : aloneBesideZ(1, Atom::Kind::kSinAlpha, "sin(alpha");
  }
  if (rho_exact && squareRoot(rho * rho + exact[2].rational * exact[2].rational, &length)) {
    turn.beta.c = constant(graph_, exact[2].rational / length);
    turn.beta.s = constant(graph_, rho / length);
  } else {
    turn.beta.c = is_zero[2] ? zero : symbol(Atom::Kind::kCosBeta, "cos(beta");
    turn.beta.s = is_zero[2] ? one : symbol(Atom::Kind::kSinBeta, "sin(beta");
  }
  return turn;
}

}  // namespace dynwitness::symbolic
