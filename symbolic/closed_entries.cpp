// SPDX-License-Identifier: GPL-3.0-or-later
// Which entries have a closed form that can be read, whatever the number of joints.
#include <algorithm>
#include <set>
#include <stdexcept>

#include "symbolic/closed_form.hpp"

namespace dynwitness::symbolic {
namespace {

/// Terms on the way: a formula of twelve terms in sums of up to four angles (eight products each)
/// and its velocities fits, and a hundred thousand products of two terms take a second.
constexpr std::size_t kMostOnTheWay = 300;
/// What a reader takes in as one formula: terms as if multiplied out, characters of plain text.
constexpr std::size_t kMostTerms = 12, kMostLetters = 400;

bool dependsOnState(const Formula& f) {
  return f.kind == Formula::Kind::kInput ||
         std::any_of(f.operands.begin(), f.operands.end(), dependsOnState);
}

bool isRate(const Formula& f) {
  return f.kind == Formula::Kind::kInput &&
         (f.input == Input::kVelocity || f.input == Input::kAcceleration);
}
bool hasRates(const Formula& f) {
  return isRate(f) || std::any_of(f.operands.begin(), f.operands.end(), hasRates);
}

/// qd1 + 2 qd2: an angular velocity or a speed.
bool isSumOfRates(const Formula& f) {
  const auto isMultiple = [&](const Formula& term) {
    const Formula& of = term.kind == Formula::Kind::kNegate ? term.operands.front() : term;
    return isRate(of) ||
           (of.kind == Formula::Kind::kProduct && of.operands.size() == 2 &&
            of.operands.front().kind == Formula::Kind::kNumber && isRate(of.operands.back()));
  };
  return f.kind == Formula::Kind::kSum &&
         std::all_of(f.operands.begin(), f.operands.end(), isMultiple);
}

/// Terms that depend on the state, and one for what does not. What is linear in the rates is read
/// as a sum of velocities: one term each.
std::size_t termsOf(const Formula& f) {
  if (!dependsOnState(f) || isSumOfRates(f)) return 1;
  std::size_t terms = 1;
  switch (f.kind) {
    case Formula::Kind::kNegate:
      return termsOf(f.operands.front());
    case Formula::Kind::kProduct: {
      const bool is_linear = std::count_if(f.operands.begin(), f.operands.end(), hasRates) == 1;
      for (const Formula& factor : f.operands)
        terms *= isSumOfRates(factor) && !is_linear ? factor.operands.size() : termsOf(factor);
      return terms;
    }
    case Formula::Kind::kSum: {
      std::size_t constants = 0;
      terms = 0;
      for (const Formula& term : f.operands)
        if (dependsOnState(term))
          terms += termsOf(term);
        else
          constants = 1;
      return terms + constants;
    }
    default:
      return 1;
  }
}

}  // namespace

std::optional<ClosedAlgebra::Polynomial> ClosedAlgebra::boundedProduct(const Polynomial& a,
                                                                       const Polynomial& b) {
  const auto cost = static_cast<long>(a.size() * b.size());
  products_left_ -= cost;
  if (products_left_ < 0) return std::nullopt;
  return reduced(onFixedCircles(product(a, b)), Role::kSin);
}

std::optional<ClosedAlgebra::Polynomial> ClosedAlgebra::multipliedOutAnew(Node node) {
  const Graph& graph = equations_.graph;
  const auto symbol = [](int s) { return Polynomial{{{{s, 1}}, 1}}; };
  switch (graph.op(node)) {
    case Op::kConstant:
      return graph.isZero(node) ? Polynomial() : Polynomial{{{}, graph.value(node)}};
    case Op::kAtom:
    case Op::kInverse: {
      const auto at = number_symbols_.find(node.index);
      if (at == number_symbols_.end()) return std::nullopt;
      return onFixedCircles(symbol(at->second));
    }
    case Op::kInput:
      return symbol(symbol_of_.at(input(graph.inputKind(node), graph.joint(node))));
    default:
      break;
  }
  const Polynomial* a = known(graph.left(node));
  if (!a) return std::nullopt;
  if (graph.op(node) == Op::kNegate) return product(*a, {{{}, -1}});
  const Polynomial* b = known(graph.right(node));
  if (!b) return std::nullopt;
  Polynomial sum = *a;
  switch (graph.op(node)) {
    case Op::kAdd:
      accumulate(*b, &sum);
      return sum;
    case Op::kSubtract:
      accumulate(product(*b, {{{}, -1}}), &sum);
      return sum;
    case Op::kMultiply:
      return boundedProduct(*a, *b);
    default: {  // kTurn
      const int k = graph.joint(node);
      auto turned = boundedProduct(*a, symbol(symbol_of_.at(input(Input::kCos, k))));
      const auto sine = boundedProduct(*b, symbol(symbol_of_.at(input(Input::kSin, k))));
      if (!turned || !sine) return std::nullopt;
      accumulate(*sine, &*turned);
      return turned;
    }
  }
}

const ClosedAlgebra::Polynomial* ClosedAlgebra::known(Node node) const {
  const std::optional<Polynomial>& p = multiplied_out_.at(node.index);
  return p ? &*p : nullptr;
}

/// Operands first, without recursion: graphs of long chains are deep.
const ClosedAlgebra::Polynomial* ClosedAlgebra::multipliedOut(Node node) {
  const Graph& graph = equations_.graph;
  std::vector<Node> open{node};
  while (!open.empty()) {
    const Node n = open.back();
    bool is_ready = true;
    const int operands = multiplied_out_.count(n.index) ? 0 : graph.operandCount(n);
    for (int k = 0; k < operands; ++k)
      if (const Node operand = k == 0 ? graph.left(n) : graph.right(n);
          !multiplied_out_.count(operand.index)) {
        open.push_back(operand);
        is_ready = false;
      }
    if (!is_ready) continue;
    open.pop_back();
    if (multiplied_out_.count(n.index)) continue;
    std::optional<Polynomial> p = multipliedOutAnew(n);
    if (p && p->size() > kMostOnTheWay) p.reset();
    multiplied_out_.emplace(n.index, std::move(p));
  }
  return known(node);
}

/// Monomials that differ in symbols of some roles or in positions; all others are one.
std::size_t ClosedAlgebra::differentIn(const Polynomial& p, const std::set<Role>& roles) const {
  std::set<Monomial> seen;
  for (const auto& [monomial, r] : p) {
    Monomial part;
    for (const auto& factor : monomial)
      if (const Symbol& s = symbols_[factor.first];
          roles.count(s.role) || (s.role == Role::kNumber && s.shown.kind == Formula::Kind::kInput))
        part.push_back(factor);
    seen.insert(std::move(part));
  }
  return seen.size();
}

std::optional<Formula> ClosedAlgebra::shortFormula(Node node) {
  const Polynomial* p = multipliedOut(node);
  if (!p) return std::nullopt;
  if (p->empty()) return Formula::ofNumber(0);
  // other angles leave products of rates as they are, and products of more sums are not looked for
  if (differentIn(*p, {Role::kRate}) > kMostTerms) return std::nullopt;
  std::vector<Polynomial> readable = forms(*p);
  const auto isLong = [this](const Polynomial& form) {
    return differentIn(form, {Role::kCos, Role::kSin}) > kMostTerms;
  };
  readable.erase(std::remove_if(readable.begin(), readable.end(), isLong), readable.end());
  if (readable.empty()) return std::nullopt;
  Formula f = shortest(readable);
  if (termsOf(f) > kMostTerms || print(f, Style::kText).size() > kMostLetters) return std::nullopt;
  return f;
}

}  // namespace dynwitness::symbolic
