// SPDX-License-Identifier: GPL-3.0-or-later
// The shared expression graph, its two ways of differentiation, and its programs.
#include <cstdint>
#include <type_traits>

#include <ginac/ginac.h>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "symbolic/exact_points.hpp"
#include "symbolic/graph.hpp"
#include "symbolic/program.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;

namespace {

Rational evaluate(const Graph& graph, Node n, const scene::State<Rational>& state) {
  const Program program = compile(graph, {n});
  return ProgramRun<Rational>(program, ExactNumbers(scene::Mechanism{}))(state)[0];
}

/// Random polynomials in the inputs of three joints, with turns.
Node randomExpression(Graph& graph, unsigned seed, int operations = 40) {
  std::mt19937 random(seed);
  std::vector<Node> nodes = {graph.constant(Rational(2, 3))};
  for (int k = 0; k < 3; ++k)
    for (Input input : {Input::kPosition, Input::kCos, Input::kSin, Input::kVelocity})
      nodes.push_back(graph.input(input, k));
  for (int i = 0; i < operations; ++i) {
    // recent nodes twice as often, so that depth grows; degrees are kept low by sums
    const auto pick = [&] {
      return nodes[nodes.size() - 1 - random() % std::min<std::size_t>(nodes.size(), 14)];
    };
    const Node a = pick(), b = pick();
    switch (random() % 6) {
      case 0:
        nodes.push_back(graph.multiply(a, b));
        break;
      case 1:
        nodes.push_back(graph.turn(random() % 3, a, b));
        break;
      case 2:
        nodes.push_back(graph.subtract(a, b));
        break;
      case 3:
        nodes.push_back(graph.negate(a));
        break;
      default:
        nodes.push_back(graph.add(a, b));
    }
  }
  return graph.sum({nodes.end() - 6, nodes.end()});
}

/// Integers modulo 2^61 - 1: a scalar that is no number type of the language.
struct Residue {
  static constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;
  std::uint64_t v = 0;
  Residue() = default;
  explicit Residue(std::uint64_t x) : v(x % kPrime) {}
  friend Residue operator+(Residue a, Residue b) { return Residue(a.v + b.v); }
  friend Residue operator-(Residue a, Residue b) { return Residue(a.v + kPrime - b.v); }
  friend Residue operator*(Residue a, Residue b) {
    return Residue(static_cast<std::uint64_t>(static_cast<unsigned __int128>(a.v) * b.v % kPrime));
  }
  friend Residue operator/(Residue a, Residue b) {
    Residue inverse(1);
    for (std::uint64_t e = kPrime - 2; e > 0; e >>= 1, b = b * b)
      if (e & 1) inverse = inverse * b;
    return a * inverse;
  }
  Residue operator-() const { return Residue(kPrime - v); }
};

Residue residue(const Rational& r) {
  const auto part = [](scene::Integer i) {
    const scene::Integer p = Residue::kPrime;
    i %= p;
    if (i < 0) i += p;
    return Residue(static_cast<std::uint64_t>(i));
  };
  return part(numerator(r)) / part(denominator(r));
}

template <typename T>
struct From {
  static T rational(const Rational& r) { return static_cast<T>(r); }
};
template <>
struct From<Residue> {
  static Residue rational(const Rational& r) { return residue(r); }
};
template <>
struct From<GiNaC::ex> {
  static GiNaC::ex rational(const Rational& r) {
    const scene::Integer n = numerator(r), d = denominator(r);
    return GiNaC::numeric(n.str().c_str()) / GiNaC::numeric(d.str().c_str());
  }
};

/// Numbers for a program without angles and axes.
template <typename T>
struct PlainNumbers {
  T operator()(const scene::Number& n) const {
    return From<T>::rational(exactValue(n, {{"m", {Rational(7, 3), 0}}}).rational);
  }
  scene::CosSin<T> angle(const scene::Number&) const { return {(*this)(1), (*this)(0)}; }
  scene::AxisTurn<T> axisTurn(const scene::Vector&) const { return {angle(0), angle(0)}; }
};

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

BOOST_AUTO_TEST_CASE(the_same_operation_is_the_same_node) {
  Graph g;
  const Node a = g.input(Input::kVelocity, 0), b = g.input(Input::kVelocity, 1);
  BOOST_TEST((g.add(a, b) == g.add(b, a)));
  BOOST_TEST((g.multiply(a, b) == g.multiply(b, a)));
  BOOST_TEST((g.subtract(a, b) == g.negate(g.subtract(b, a))));
  BOOST_TEST((g.multiply(g.negate(a), b) == g.negate(g.multiply(a, b))));
  BOOST_TEST((g.turn(0, g.negate(a), b) == g.negate(g.turn(0, a, g.negate(b)))));
  const int size = g.size();
  g.add(g.multiply(a, b), g.add(a, b));
  g.add(g.multiply(b, a), g.add(b, a));
  BOOST_TEST(g.size() == size + 1);
}

BOOST_AUTO_TEST_CASE(what_cancels_leaves_nothing_behind) {
  Graph g;
  const Node a = g.input(Input::kVelocity, 0), b = g.input(Input::kVelocity, 1);
  BOOST_TEST(g.isZero(g.subtract(a, a)));
  BOOST_TEST(g.isZero(g.multiply(g.constant(0), a)));
  BOOST_TEST((g.multiply(g.constant(1), a) == a));
  BOOST_TEST((g.subtract(a, g.subtract(a, b)) == b));
  BOOST_TEST((g.subtract(g.add(a, b), a) == b));
  BOOST_TEST((g.add(g.subtract(a, b), b) == a));
  BOOST_TEST((g.multiply(g.constant(Rational(1, 2)), g.add(a, a)) == a));
  BOOST_TEST((g.add(g.multiply(g.constant(3), a), g.negate(a)) == g.add(a, a)));
  BOOST_TEST((g.turn(2, Node{}, b) == g.multiply(g.input(Input::kSin, 2), b)));
}

BOOST_AUTO_TEST_CASE(constants_fold_exactly) {
  Graph g;
  const Node tenth = g.constant(Rational(1, 10));
  BOOST_TEST((g.add(g.add(tenth, tenth), tenth) == g.constant(Rational(3, 10))));
  BOOST_TEST((g.multiply(tenth, g.inverse(tenth)) == g.constant(1)));
}

BOOST_AUTO_TEST_CASE(derivatives_of_cosine_and_sine) {
  Graph g;
  const Node c = g.input(Input::kCos, 0), s = g.input(Input::kSin, 0);
  const std::pair<Variable, Node> along_q{{Input::kPosition, 0}, g.constant(1)};
  BOOST_TEST((g.directionalDerivative({c}, {along_q})[0] == g.negate(s)));
  BOOST_TEST((g.directionalDerivative({s}, {along_q})[0] == c));
  // d(c s)/dq = c^2 - s^2, d(c^2 + s^2)/dq = 0
  const Node product = g.gradient(g.multiply(c, s), {{Input::kPosition, 0}})[0];
  const auto state = exactState(1, 5);
  const Rational cv = state.x[0].c, sv = state.x[0].s;
  BOOST_TEST(evaluate(g, product, state) == cv * cv - sv * sv);
  const Node circle = g.add(g.multiply(c, c), g.multiply(s, s));
  BOOST_TEST(evaluate(g, g.gradient(circle, {{Input::kPosition, 0}})[0], state) == 0);
}

BOOST_AUTO_TEST_CASE(work_on_parameters_is_done_once) {
  Graph g;
  const Node m = g.atom({Atom::Kind::kNumber, scene::Number::parse("m"), {}, "m"});
  const Node v = g.input(Input::kVelocity, 0);
  // (m m) (m v) + unused: three products of which two need no state
  g.multiply(v, v);
  const Program program = compile(g, {g.multiply(g.multiply(m, m), g.multiply(m, v))});
  BOOST_TEST(program.prologue.size() == 2u);
  BOOST_TEST(program.bodyOperations().multiplications == 1);
  BOOST_TEST(program.bodyOperations().additions == 0);
}

BOOST_AUTO_TEST_CASE(a_turn_costs_two_products_and_a_sum) {
  Graph g;
  const Node x = g.input(Input::kVelocity, 0), y = g.input(Input::kVelocity, 1);
  const Program program = compile(g, {g.turn(0, x, y), g.turn(0, y, g.negate(x))});
  BOOST_TEST(program.bodyOperations().multiplications == 4);
  BOOST_TEST(program.bodyOperations().additions == 2);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_DATA_TEST_CASE(reverse_mode_equals_forward_mode, boost::unit_test::data::xrange(20), seed) {
  Graph g;
  const Node f = randomExpression(g, 100 + seed);
  const auto state = exactState(3, seed);
  std::vector<Variable> variables;
  for (int k = 0; k < 3; ++k) {
    variables.push_back({Input::kPosition, k});
    variables.push_back({Input::kVelocity, k});
  }
  const std::vector<Node> gradient = g.gradient(f, variables);
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const Node forward = g.directionalDerivative({f}, {{variables[i], g.constant(1)}})[0];
    BOOST_TEST(evaluate(g, forward, state) == evaluate(g, gradient[i], state));
  }
}

// by another road: dual numbers e + f eps, eps^2 = 0, through the undifferentiated program
BOOST_DATA_TEST_CASE(derivatives_equal_those_of_dual_numbers, boost::unit_test::data::xrange(20),
                     seed) {
  struct Dual {
    Rational e, f;
    Dual() = default;
    Dual(Rational value, Rational derivative = 0) : e(value), f(derivative) {}
    Dual operator+(const Dual& o) const { return {e + o.e, f + o.f}; }
    Dual operator-(const Dual& o) const { return {e - o.e, f - o.f}; }
    Dual operator*(const Dual& o) const { return {e * o.e, e * o.f + f * o.e}; }
    Dual operator/(const Dual& o) const { return {e / o.e, (f * o.e - e * o.f) / (o.e * o.e)}; }
    Dual operator-() const { return {-e, -f}; }
  };
  struct DualNumbers {
    Dual operator()(const scene::Number& n) const { return {exactValue(n, {}).rational, 0}; }
    scene::CosSin<Dual> angle(const scene::Number&) const { return {{1, 0}, {0, 0}}; }
    scene::AxisTurn<Dual> axisTurn(const scene::Vector&) const { return {angle(0), angle(0)}; }
  };
  Graph g;
  const Node f = randomExpression(g, 200 + seed);
  const auto state = exactState(3, seed);
  scene::State<Dual> dual;
  std::vector<std::pair<Variable, Node>> direction;
  for (int k = 0; k < 3; ++k) {
    const Rational dq = k + 1, dqd = Rational(1, k + 2);
    direction.push_back({{Input::kPosition, k}, g.constant(dq)});
    direction.push_back({{Input::kVelocity, k}, g.constant(dqd)});
    const auto& x = state.x[k];
    dual.x.push_back({{x.q, dq}, {x.c, -x.s * dq}, {x.s, x.c * dq}});
    dual.qd.push_back({state.qd[k], dqd});
  }
  const Program program = compile(g, {f});
  const Dual result = ProgramRun<Dual>(program, DualNumbers{})(dual)[0];
  BOOST_TEST(evaluate(g, g.directionalDerivative({f}, direction)[0], state) == result.f);
}

using Scalars = std::tuple<double, float, long double, Residue, GiNaC::ex>;
BOOST_AUTO_TEST_CASE_TEMPLATE(programs_run_on_any_scalar, T, Scalars) {
  Graph g;
  const Node m = g.atom({Atom::Kind::kNumber, scene::Number::parse("m"), {}, "m"});
  const Node f = g.add(g.multiply(g.inverse(m), randomExpression(g, 7, 12)), g.multiply(m, m));
  const auto exact_state = exactState(3, 1);
  scene::State<T> state;
  for (int k = 0; k < 3; ++k) {
    const auto& x = exact_state.x[k];
    state.x.push_back({From<T>::rational(x.q), From<T>::rational(x.c), From<T>::rational(x.s)});
    state.qd.push_back(From<T>::rational(exact_state.qd[k]));
  }
  const Program program = compile(g, {f});
  const Rational truth = ProgramRun<Rational>(program, PlainNumbers<Rational>{})(exact_state)[0];
  const T value = ProgramRun<T>(program, PlainNumbers<T>{})(state)[0];
  if constexpr (std::is_floating_point_v<T>) {
    const T expected = From<T>::rational(truth);
    BOOST_TEST(std::abs(value - expected) <=
               64 * std::numeric_limits<T>::epsilon() * std::abs(expected));
  } else if constexpr (std::is_same_v<T, Residue>) {
    BOOST_TEST(value.v == residue(truth).v);
  } else {
    BOOST_TEST((value - From<T>::rational(truth)).expand().is_zero());
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(zero_is_not_inverted) {
  Graph g;
  BOOST_CHECK_THROW(g.inverse(g.constant(0)), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
