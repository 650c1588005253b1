// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/derivation_steps.hpp"

#include <algorithm>

namespace dynwitness::symbolic {
namespace {

bool anyOf(const Graph& graph, const std::vector<Node>& nodes) {
  return std::any_of(nodes.begin(), nodes.end(), [&](Node node) { return !graph.isZero(node); });
}

}  // namespace

std::string numbered(const std::string& letter, int i) {
  return letter + std::to_string(i + 1);
}
std::string numbered(const std::string& letter, int i, int j) {
  const bool wide = i > 8 || j > 8;
  return letter + std::to_string(i + 1) + (wide ? "_" : "") + std::to_string(j + 1);
}

std::string christoffelName(int i, int j, int k) {
  const std::string joint = (i > 8 || j > 8 || k > 8) ? "_" : "";
  return "Gamma" + std::to_string(i + 1) + joint + std::to_string(j + 1) + joint +
         std::to_string(k + 1);
}

StepEquation equationOfMotion(Equations& e, int i, const ShownEntry& shown) {
  Graph& graph = e.graph;
  Node left_value = graph.add(e.c[i], e.g[i]);
  std::vector<Formula> names, written_out;
  const auto addTerm = [&](const std::string& name, Node node, const std::vector<Formula>& times) {
    const auto term = [&times](const Formula& entry) {
      std::vector<Formula> factors{entry};
      factors.insert(factors.end(), times.begin(), times.end());
      return Formula::product(factors);
    };
    const Formula entry = shown(name, node);
    if (isZero(entry)) return;
    names.push_back(term(Formula::ofSymbol(name)));
    written_out.push_back(term(entry));
  };
  for (int j = 0; j < e.dof(); ++j) {
    addTerm(numbered("M", std::min(i, j), std::max(i, j)), e.M[i][j],
            {Formula::ofInput(Input::kAcceleration, j)});
    left_value =
        graph.add(left_value, graph.multiply(e.M[i][j], graph.input(Input::kAcceleration, j)));
  }
  addTerm(numbered("c", i), e.c[i], {});
  addTerm(numbered("g", i), e.g[i], {});
  std::vector<Formula> right{Formula::ofInput(Input::kForce, i)};
  if (!graph.isZero(e.Q[i])) right.push_back(Formula::ofSymbol(numbered("Q", i)));
  const Formula row = flatSum(written_out);
  return {{length(row) <= kLongestRow ? row : Formula::sum(names), Formula::sum(right)},
          left_value,
          graph.add(graph.input(Input::kForce, i), e.Q[i])};
}

bool isLoaded(const Equations& e) {
  return anyOf(e.graph, e.Q);
}
const char* loadsSentence(const Equations& e) {
  return anyOf(e.graph, e.friction)
             ? "The constant wrenches and friction: Q_i = d(power of the wrenches)/dqd_i "
               "- dR/dqd_i, R = sum of viscous qd^2/2 + coulomb |qd|."
             : "The constant wrenches: Q_i = d(power of the wrenches)/dqd_i.";
}

std::size_t length(const Formula& f) {
  return print(f, Style::kText).size();
}

bool isZero(const Formula& f) {
  return f.kind == Formula::Kind::kNumber && f.number == 0;
}

Formula flatSum(const std::vector<Formula>& terms) {
  std::vector<Formula> flat;
  for (const Formula& term : terms) {
    if (term.kind == Formula::Kind::kSum)
      flat.insert(flat.end(), term.operands.begin(), term.operands.end());
    else
      flat.push_back(term);
  }
  return Formula::sum(flat);
}

}  // namespace dynwitness::symbolic
