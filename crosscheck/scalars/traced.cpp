// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/traced.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "crosscheck/scalars/indeterminates.hpp"

namespace dynwitness::crosscheck {

using symbolic::Atom;
using symbolic::Input;

thread_local symbolic::Graph* Traced::current_ = nullptr;

Traced::Traced(int value) {
  // 0 and 1 are nodes of every graph, so that constants need none
  node_ = value == 0 || value == 1 ? symbolic::Node{value} : graph().constant(value);
}

namespace {

Traced constant(const scene::Rational& r) {
  return Traced(Traced::graph().constant(r));
}

Traced atom(Atom::Kind kind, const scene::Number& number, const scene::Vector& axis,
            const std::string& name) {
  return Traced(Traced::graph().atom({kind, number, axis, name}));
}

Traced pi() {
  return atom(Atom::Kind::kNumber, scene::Number::parse("pi"), {}, "pi");
}

/// Expressions in parameters that stay symbols.
struct SymbolAlgebra {
  Traced number(const scene::Rational& r) const { return constant(r); }
  Traced pi() const { return crosscheck::pi(); }
  Traced parameter(const std::string& name) const {
    return atom(Atom::Kind::kNumber, scene::Number::parse(name), {}, name);
  }
};

std::string exactText(const scene::Exact& x) {
  return x.rational.str() + (x.pi_multiple == 0 ? "" : " + " + x.pi_multiple.str() + " pi");
}

}  // namespace

Traced TracedNumbers::operator()(const scene::Number& number) const {
  if (!fold_parameters_ && !number.parameters().empty())
    return scene::evaluateIn<Traced>(number, SymbolAlgebra());
  const scene::Exact exact = exactValue(number, values_);
  Traced value = constant(exact.rational);
  if (exact.pi_multiple != 0) value += constant(exact.pi_multiple) * pi();
  return value;
}

scene::CosSin<Traced> TracedNumbers::angle(const scene::Number& radians) const {
  const scene::Exact exact = exactValue(radians, values_);
  int quarter = 0;
  if (scene::isQuarterTurn(exact, &quarter)) return scene::quarterTurns<Traced>(quarter);
  const bool negative = exact.approximation() < 0;
  // the name is the angle itself: one written in another way is the same atom
  const scene::Exact size = negative ? scene::Exact{-exact.rational, -exact.pi_multiple} : exact;
  const std::string text = exactText(size);
  const scene::Number number =
      scene::Number::parse("(" + size.rational.str() + ") + (" + size.pi_multiple.str() + ")*pi");
  const Traced c = atom(Atom::Kind::kCos, number, {}, "cos(" + text + ")");
  const Traced s = atom(Atom::Kind::kSin, number, {}, "sin(" + text + ")");
  return {c, negative ? -s : s};
}

scene::AxisTurn<Traced> TracedNumbers::axisTurn(const scene::Vector& axis) const {
  std::array<scene::Exact, 3> v;
  std::array<scene::Rational, 3> size;
  bool rational = true;
  for (int i = 0; i < 3; ++i) {
    v[i] = exactValue(axis[i], values_);
    size[i] = v[i].approximation();
    rational = rational && v[i].isRational();
  }
  if (size[0] == 0 && size[1] == 0 && size[2] == 0)
    throw std::invalid_argument("axisTurn: axis: expected a non-zero vector");
  const std::string text = exactText(v[0]) + ", " + exactText(v[1]) + ", " + exactText(v[2]);
  const auto symbol = [&](Atom::Kind kind, const std::string& what) {
    return atom(kind, scene::Number(0), axis, what + " of axis (" + text + ")");
  };
  scene::Rational rho, length;
  const bool rho_rational = rational && rationalRoot(size[0] * size[0] + size[1] * size[1], &rho);
  scene::AxisTurn<Traced> turn{{Traced(1), Traced(0)}, {Traced(0), Traced(1)}};
  if (rho_rational && rho == 0) {
    turn.beta = {Traced(size[2] < 0 ? -1 : 1), Traced(0)};
    return turn;
  }
  if (rho_rational) {
    turn.alpha = {constant(size[0] / rho), constant(size[1] / rho)};
  } else {
    if (size[0] != 0) turn.alpha.c = symbol(Atom::Kind::kCosAlpha, "cos(alpha)");
    turn.alpha.s = size[1] == 0 ? Traced(0) : symbol(Atom::Kind::kSinAlpha, "sin(alpha)");
    if (size[0] == 0) turn.alpha = {Traced(0), Traced(size[1] < 0 ? -1 : 1)};
    if (size[1] == 0) turn.alpha = {Traced(size[0] < 0 ? -1 : 1), Traced(0)};
  }
  if (rho_rational && rationalRoot(rho * rho + size[2] * size[2], &length)) {
    turn.beta = {constant(size[2] / length), constant(rho / length)};
  } else if (size[2] != 0) {
    turn.beta = {symbol(Atom::Kind::kCosBeta, "cos(beta)"),
                 symbol(Atom::Kind::kSinBeta, "sin(beta)")};
  }
  return turn;
}

scene::State<Traced> tracedState(const scene::Mechanism& mechanism) {
  symbolic::Graph& graph = Traced::graph();
  const auto input = [&](Input kind, int joint) { return Traced(graph.input(kind, joint)); };
  scene::State<Traced> state;
  for (int i = 0; i < mechanism.positions(); ++i)
    state.x.push_back({input(Input::kPosition, i), input(Input::kCos, i), input(Input::kSin, i)});
  for (int i = 0; i < mechanism.dof(); ++i) {
    state.qd.push_back(input(Input::kVelocity, i));
    state.qdd.push_back(input(Input::kAcceleration, i));
    state.tau.push_back(input(Input::kForce, i));
  }
  return state;
}

}  // namespace dynwitness::crosscheck
