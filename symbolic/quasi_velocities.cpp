// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/quasi_velocities.hpp"

#include <map>
#include <utility>

namespace dynwitness::symbolic {
namespace {

using Key = std::pair<Input, int>;  ///< of a variable

Key keyOf(const Variable& variable) {
  return {variable.input, variable.joint};
}

/// b_ijk of a joint's rates, turns and shifts, as (j, k, sign) for one i.
struct Bracket {
  int j, k, sign;
};
std::vector<Bracket> brackets(const QuasiJoint& joint, int i) {
  std::vector<Bracket> out;
  const int turns = joint.rate + (joint.floats ? 3 : 0);
  for (const int shift : {1, 2}) {  // e_a x e_b = sign e_c
    const int a = (i - joint.rate) % 3, b = (a + shift) % 3, c = (a + 3 - shift) % 3;
    const int sign = shift == 1 ? 1 : -1;
    if (i >= turns) {
      out.push_back({turns + b, turns + c, sign});  // [turn, turn] = turn
      if (joint.floats)
        out.push_back({joint.rate + b, joint.rate + c, sign});  // [turn, shift] = shift
    } else {
      out.push_back({turns + b, joint.rate + c, sign});  // [shift, turn] = shift
    }
  }
  return out;
}

}  // namespace

std::vector<Node> positionGradient(Equations& e, Node f) {
  Graph& graph = e.graph;
  std::vector<Variable> variables;
  std::map<Key, Node> slope;
  for (const Direction& direction : e.directions)
    for (const auto& [variable, node] : direction)
      if (slope.emplace(keyOf(variable), Node{}).second) variables.push_back(variable);
  const std::vector<Node> slopes = graph.gradient(f, variables);
  for (std::size_t i = 0; i < variables.size(); ++i) slope[keyOf(variables[i])] = slopes[i];
  std::vector<Node> result;
  for (const Direction& direction : e.directions) {
    Node sum;
    for (const auto& [variable, node] : direction)
      sum = graph.add(sum, graph.multiply(slope.at(keyOf(variable)), node));
    result.push_back(sum);
  }
  return result;
}

namespace {

/// (of_ij_by_k + of_ik_by_j - of_jk_by_i) / 2
Node christoffel(Graph& graph, Node of_ij_by_k, Node of_ik_by_j, Node of_jk_by_i) {
  return graph.multiply(graph.constant(Rational(1, 2)),
                        graph.subtract(graph.add(of_ij_by_k, of_ik_by_j), of_jk_by_i));
}

}  // namespace

Node christoffelSymbol(Equations& equations, int i, int j, int k) {
  const auto slope = [&equations](int row, int column, int by) {
    return positionGradient(equations, equations.M[row][column])[by];
  };
  return christoffel(equations.graph, slope(i, j, k), slope(i, k, j), slope(j, k, i));
}

std::vector<Node> christoffelSymbols(Equations& e) {
  const auto n = static_cast<std::size_t>(e.dof());
  std::vector<std::vector<Node>> slopes(n * n);  // of M_ij
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j)
      slopes[i * n + j] = slopes[j * n + i] = positionGradient(e, e.M[i][j]);
  std::vector<Node> symbols;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < n; ++k)
        symbols.push_back(
            christoffel(e.graph, slopes[i * n + j][k], slopes[i * n + k][j], slopes[j * n + k][i]));
  return symbols;
}

Direction positionsAlong(Equations& e, const std::vector<Node>& rates) {
  Graph& graph = e.graph;
  std::vector<Variable> order;
  std::map<Key, Node> speed;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    for (const auto& [variable, node] : e.directions[i]) {
      const auto [it, is_new] = speed.emplace(keyOf(variable), Node{});
      if (is_new) order.push_back(variable);
      it->second = graph.add(it->second, graph.multiply(node, rates[i]));
    }
  }
  Direction result;
  for (const Variable& variable : order) result.push_back({variable, speed[keyOf(variable)]});
  return result;
}

Direction motion(Equations& e, bool with_accelerations) {
  Graph& graph = e.graph;
  std::vector<Node> qd;
  for (int i = 0; i < e.dof(); ++i) qd.push_back(graph.input(Input::kVelocity, i));
  Direction result = positionsAlong(e, qd);
  if (with_accelerations)
    for (int i = 0; i < e.dof(); ++i)
      result.push_back({{Input::kVelocity, i}, graph.input(Input::kAcceleration, i)});
  return result;
}

std::vector<Node> structureTerms(Equations& e, const std::vector<Node>& p) {
  Graph& graph = e.graph;
  std::vector<Node> terms(p.size());
  for (const QuasiJoint& joint : e.quasi) {
    for (int i = joint.rate; i < joint.rate + (joint.floats ? 6 : 3); ++i) {
      for (const Bracket& b : brackets(joint, i)) {
        const Node term = graph.multiply(graph.input(Input::kVelocity, b.j), p[b.k]);
        terms[i] = b.sign > 0 ? graph.add(terms[i], term) : graph.subtract(terms[i], term);
      }
    }
  }
  return terms;
}

std::vector<Node> hamelTerms(Equations& e, std::vector<Node> p) {
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = e.graph.subtract(p[i], e.gear_momenta[i]);
  return structureTerms(e, p);
}

}  // namespace dynwitness::symbolic
