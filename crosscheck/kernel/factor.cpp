// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/factor.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace dynwitness::crosscheck::kernel {
namespace {

using symbolic::Graph;
using symbolic::Input;
using symbolic::Node;
using symbolic::Op;
using symbolic::Program;

/// Sums of up to so many terms are written out in others before pairs are looked for. Each is
/// tried; longer ones were never the best for the bundled scenes.
constexpr std::size_t kLongest[] = {0, 2, 3, 4};
constexpr std::size_t kUsuallyBest = 2;
/// Terms beyond which pairs are not compared.
constexpr int kLargest = 6000;

/// A value with its sign outside.
struct Term {
  int value;
  bool negative;
  friend bool operator<(const Term& a, const Term& b) {
    return std::tie(a.value, a.negative) < std::tie(b.value, b.negative);
  }
};

/// A node of the graph taken apart: sums have any number of terms, signs live in sums.
struct Value {
  enum class Kind { kLeaf, kSum, kProduct, kInverse } kind = Kind::kLeaf;
  Node node;                ///< kLeaf: an input, or anything that the state does not enter
  std::vector<Term> terms;  ///< kSum
  int a = -1, b = -1;       ///< kProduct, kInverse
  int uses = 0;
};

class Regrouping {
 public:
  Regrouping(Graph& graph, const std::vector<Node>& outputs, std::size_t longest)
      : graph_(graph), longest_(longest) {
    takeApart(outputs);
    countUses();
    const int all = static_cast<int>(values_.size());  // flatten() adds leaves
    for (int i = 0; i < all; ++i)
      if (isSum(values_[i])) flatten(i);
  }

  /// @return false: too large
  bool run() {
    int terms = 0;
    for (const Value& value : values_)
      if (isSum(value)) terms += static_cast<int>(value.terms.size());
    if (terms > kLargest) return false;
    for (std::size_t i = 0; i < values_.size();
         ++i)  // values_ grows, and new sums are looked at too
      while (isSum(values_[i]) && factorOut(static_cast<int>(i))) {
      }
    if (longest_ > 0 && !expand()) return false;
    sharePairs();
    return true;
  }

  long steps() const { return steps_ + 8 * static_cast<long>(values_.size()); }

  std::vector<Node> nodes() {
    made_.assign(values_.size(), {});
    is_made_.assign(values_.size(), 0);
    std::vector<Node> out;
    for (const Term& output : outputs_) out.push_back(signedNode(output));
    return out;
  }

 private:
  static bool isSum(const Value& value) {
    return value.kind == Value::Kind::kSum && value.uses > 0;
  }

  int add(Value value) {
    values_.push_back(std::move(value));
    return static_cast<int>(values_.size()) - 1;
  }
  int leaf(Node n) {
    Value value;
    value.node = n;
    return add(value);
  }
  int product(int a, int b) {
    if (b < a) std::swap(a, b);
    const auto [it, is_new] = products_.try_emplace({a, b}, 0);
    if (is_new) {
      Value value;
      value.kind = Value::Kind::kProduct;
      value.a = a;
      value.b = b;
      it->second = add(value);
    }
    return it->second;
  }
  int sum(std::vector<Term> terms) {
    Value value;
    value.kind = Value::Kind::kSum;
    value.terms = std::move(terms);
    return add(value);
  }
  int trig(Input input, int joint) {
    const Node n = graph_.input(input, joint);
    const auto [it, is_new] = leaves_.try_emplace(n.index, 0);
    if (is_new) it->second = leaf(n);
    return it->second;
  }

  // ---- graph to values
  void takeApart(const std::vector<Node>& outputs) {
    std::vector<char> needed;
    const auto need = [&](Node n) {
      if (static_cast<int>(needed.size()) <= n.index) needed.resize(n.index + 1, 0);
      needed[n.index] = 1;
    };
    for (const Node& n : outputs) need(n);
    for (int i = static_cast<int>(needed.size()) - 1; i >= 0; --i) {
      if (!needed[i] || !graph_.dependsOnState({i})) continue;
      if (graph_.operandCount({i}) > 0) need(graph_.left({i}));
      if (graph_.operandCount({i}) > 1) need(graph_.right({i}));
    }
    std::vector<Term> term_of(needed.size(), Term{-1, false});
    const auto minus = [](Term t) { return Term{t.value, !t.negative}; };
    for (int i = 0; i < static_cast<int>(needed.size()); ++i) {
      if (!needed[i]) continue;
      const Node n{i};
      Term& term = term_of[i];
      if (!graph_.dependsOnState(n) || graph_.op(n) == Op::kInput) {
        const auto [it, is_new] = leaves_.try_emplace(i, 0);
        if (is_new) it->second = leaf(n);
        term = {it->second, false};
        continue;
      }
      const Term a = term_of[graph_.left(n).index];
      const Term b = graph_.operandCount(n) > 1 ? term_of[graph_.right(n).index] : a;
      switch (graph_.op(n)) {
        case Op::kNegate:
          term = minus(a);
          break;
        case Op::kAdd:
          term = {sum({a, b}), false};
          break;
        case Op::kSubtract:
          term = {sum({a, minus(b)}), false};
          break;
        case Op::kMultiply:
          term = {product(a.value, b.value), a.negative != b.negative};
          break;
        case Op::kTurn: {
          const int joint = graph_.joint(n);
          const int x = product(trig(Input::kCos, joint), a.value);
          const int y = product(trig(Input::kSin, joint), b.value);
          term = {sum({{x, a.negative}, {y, b.negative}}), false};
          break;
        }
        case Op::kInverse: {
          Value value;
          value.kind = Value::Kind::kInverse;
          value.a = a.value;
          term = {add(value), a.negative};
          break;
        }
        default:
          break;
      }
    }
    for (const Node& n : outputs) outputs_.push_back(term_of[n.index]);
    steps_ += static_cast<long>(needed.size());
  }

  void countUses() {
    std::vector<int> open;
    const auto use = [&](int i) {
      if (values_[i].uses++ == 0) open.push_back(i);
    };
    for (const Term& output : outputs_) use(output.value);
    while (!open.empty()) {
      const Value value = values_[open.back()];
      open.pop_back();
      for (const Term& term : value.terms) use(term.value);
      if (value.a >= 0) use(value.a);
      if (value.b >= 0) use(value.b);
    }
  }

  /// Takes up the terms of sums that serve this one alone. Operands come first, so theirs are flat.
  void flatten(int sum_index) {
    std::vector<Term> terms;
    Node fixed;  // what the state does not enter is one term
    int fixed_terms = 0;
    const auto take = [&](Term term) {
      const Value& value = values_[term.value];
      if (value.kind == Value::Kind::kLeaf && !graph_.dependsOnState(value.node)) {
        fixed = term.negative ? graph_.subtract(fixed, value.node) : graph_.add(fixed, value.node);
        ++fixed_terms;
      } else {
        terms.push_back(term);
      }
    };
    for (const Term& term : values_[sum_index].terms) {
      Value& inner = values_[term.value];
      if (inner.kind != Value::Kind::kSum || inner.uses > 1) {
        take(term);
        continue;
      }
      for (const Term& t : inner.terms) take({t.value, t.negative != term.negative});
      inner.uses = 0;
    }
    if (fixed_terms > 0 && !graph_.isZero(fixed)) {
      terms.push_back({fixedLeaf(fixed), false});
    }
    values_[sum_index].terms = std::move(terms);
  }

  // ---- (1)
  bool factorOut(int sum_index) {
    std::map<int, std::vector<std::size_t>> by_factor;
    const std::vector<Term>& terms = values_[sum_index].terms;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      const Value& p = values_[terms[k].value];
      if (p.kind != Value::Kind::kProduct || p.uses != 1) continue;
      by_factor[p.a].push_back(k);
      if (p.b != p.a) by_factor[p.b].push_back(k);
    }
    int factor = -1;
    std::size_t most = 1;
    for (const auto& [f, where] : by_factor)
      if (where.size() > most) {
        most = where.size();
        factor = f;
      }
    if (factor < 0) return false;
    std::vector<Term> kept, inner;
    const std::vector<std::size_t> where = by_factor[factor];
    for (std::size_t k = 0; k < terms.size(); ++k) {
      if (!std::binary_search(where.begin(), where.end(), k)) {
        kept.push_back(terms[k]);
        continue;
      }
      Value& p = values_[terms[k].value];
      const int other = p.a == factor ? p.b : p.a;
      p.uses = 0;
      products_.erase({p.a, p.b});
      Value& o = values_[other];
      if (o.kind == Value::Kind::kSum && o.uses == 1) {
        for (const Term& t : o.terms) inner.push_back({t.value, t.negative != terms[k].negative});
        o.uses = 0;
      } else {
        inner.push_back({other, terms[k].negative});
      }
    }
    values_[factor].uses -= static_cast<int>(where.size()) - 1;
    const int bracket = sum(inner);
    values_[bracket].uses = 1;
    const int p = product(factor, bracket);
    values_[p].uses = 1;
    kept.push_back({p, false});
    values_[sum_index].terms = std::move(kept);
    return true;
  }

  // ---- (3)
  /// Writes every sum in what is no sum. @return false: that becomes too large
  bool expand() {
    // sums by their operands: new ones of factorOut() may stand behind those that use them
    std::vector<char> done(values_.size(), 0);
    int total = 0;
    for (std::size_t start = 0; start < values_.size(); ++start) {
      std::vector<int> open = {static_cast<int>(start)};
      while (!open.empty()) {
        const int i = open.back();
        if (!isSum(values_[i]) || done[i]) {
          open.pop_back();
          continue;
        }
        const std::size_t before = open.size();
        for (const Term& term : values_[i].terms)
          if (isSum(values_[term.value]) && !done[term.value]) open.push_back(term.value);
        if (open.size() > before) continue;
        open.pop_back();
        done[i] = 1;
        total += expandSum(i);
        if (total > kLargest) return false;
      }
    }
    return true;
  }
  /// @return how many terms the sum has now
  int expandSum(int sum_index) {
    std::map<int, int> times;
    Node fixed;
    const auto take = [&](const Term& term) {
      const Value& value = values_[term.value];
      if (value.kind == Value::Kind::kLeaf && !graph_.dependsOnState(value.node))
        fixed = term.negative ? graph_.subtract(fixed, value.node) : graph_.add(fixed, value.node);
      else
        times[term.value] += term.negative ? -1 : 1;
    };
    for (const Term& term : values_[sum_index].terms) {
      if (!isSum(values_[term.value]) || values_[term.value].terms.size() > longest_) {
        take(term);
        continue;
      }
      for (const Term& t : values_[term.value].terms) take({t.value, t.negative != term.negative});
    }
    std::vector<Term> terms;
    for (const auto& [value, n] : times) {
      // twice something would be a product
      if (n > 1 || n < -1) return static_cast<int>(values_[sum_index].terms.size());
      if (n != 0) terms.push_back({value, n < 0});
    }
    if (!graph_.isZero(fixed)) terms.push_back({fixedLeaf(fixed), false});
    if (terms.empty()) return 0;
    values_[sum_index].terms = std::move(terms);
    return static_cast<int>(values_[sum_index].terms.size());
  }
  int fixedLeaf(Node n) {
    const auto [it, is_new] = leaves_.try_emplace(n.index, 0);
    if (is_new) it->second = leaf(n);
    values_[it->second].uses++;
    return it->second;
  }

  // ---- (2)
  /// Two values, the smaller index first, and whether their signs differ.
  using Pair = std::tuple<int, int, bool>;

  /// Counts the pairs of all sums, then shares the most frequent one until none occurs twice. Only
  /// the sums that change are counted anew.
  void sharePairs() {
    users_.resize(values_.size());
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (!isSum(values_[i])) continue;
      countPairs(values_[i], 1);
      for (const Term& term : values_[i].terms) users_[term.value].push_back(static_cast<int>(i));
    }
    while (!frequent_.empty()) share(frequent_.begin()->second);
  }
  void countPairs(const Value& value, int by) {
    for (std::size_t i = 0; i < value.terms.size(); ++i)
      for (std::size_t j = i + 1; j < value.terms.size(); ++j) {
        const Pair pair = key(value.terms[i], value.terms[j]);
        int& count = count_[pair];
        if (count > 1) frequent_.erase({-count, pair});
        count += by;
        if (count > 1) frequent_.insert({-count, pair});
        if (count == 0) count_.erase(pair);
        ++steps_;
      }
  }
  void share(const Pair shared) {
    const auto [a, b, differ] = shared;
    std::vector<int> sums;  // those that have the pair
    std::sort(users_[a].begin(), users_[a].end());
    users_[a].erase(std::unique(users_[a].begin(), users_[a].end()), users_[a].end());
    for (const int i : users_[a])
      if (has(values_[i], shared)) sums.push_back(i);
    // a sum that is the pair and nothing else may serve the others
    const auto same =
        std::find_if(sums.begin(), sums.end(), [&](int i) { return values_[i].terms.size() == 2; });
    int pair = same == sums.end() ? -1 : *same;
    if (pair < 0) {
      pair = sum({{a, false}, {b, differ}});
      users_.resize(values_.size());
      countPairs(values_[pair], 1);
      users_[a].push_back(pair);
      users_[b].push_back(pair);
    }
    const Term first = values_[pair].terms[0];
    const bool pair_sign = first.value == a ? first.negative : values_[pair].terms[1].negative;
    for (const int i : sums) {
      if (i == pair) continue;
      countPairs(values_[i], -1);
      std::vector<Term>& terms = values_[i].terms;
      for (std::size_t x = 0; x < terms.size(); ++x) {
        for (std::size_t y = x + 1; y < terms.size(); ++y) {
          if (key(terms[x], terms[y]) != shared) continue;
          const bool sign = terms[x].value == a ? terms[x].negative : terms[y].negative;
          terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(y));
          terms[x] = {pair, sign != pair_sign};
          ++values_[pair].uses;
          users_[pair].push_back(i);
          break;
        }
      }
      countPairs(values_[i], 1);
    }
  }
  bool has(const Value& value, const Pair& pair) {
    if (!isSum(value)) return false;
    steps_ += static_cast<long>(value.terms.size());
    for (std::size_t i = 0; i < value.terms.size(); ++i)
      for (std::size_t j = i + 1; j < value.terms.size(); ++j)
        if (key(value.terms[i], value.terms[j]) == pair) return true;
    return false;
  }
  static Pair key(Term x, Term y) {
    if (y.value < x.value) std::swap(x, y);
    return {x.value, y.value, x.negative != y.negative};
  }

  // ---- values to graph
  Node signedNode(const Term& term) {
    const Node n = node(term.value);
    return term.negative ? graph_.negate(n) : n;
  }
  Node node(int wanted) {
    std::vector<int> open = {wanted};
    while (!open.empty()) {
      const int i = open.back();
      if (is_made_[i]) {
        open.pop_back();
        continue;
      }
      const Value& value = values_[i];
      const std::size_t before = open.size();
      const auto need = [&](int operand) {
        if (operand >= 0 && !is_made_[operand]) open.push_back(operand);
      };
      for (const Term& term : value.terms) need(term.value);
      need(value.a);
      need(value.b);
      if (open.size() > before) continue;
      open.pop_back();
      made_[i] = make(value);
      is_made_[i] = 1;
    }
    return made_[wanted];
  }
  Node make(const Value& value) {
    switch (value.kind) {
      case Value::Kind::kLeaf:
        return value.node;
      case Value::Kind::kProduct:
        return graph_.multiply(made_[value.a], made_[value.b]);
      case Value::Kind::kInverse:
        return graph_.inverse(made_[value.a]);
      case Value::Kind::kSum:
        break;
    }
    // in the order of the operands, so that what is known early is added early
    std::vector<std::pair<Node, bool>> terms;
    for (const Term& term : value.terms) terms.emplace_back(made_[term.value], term.negative);
    std::sort(terms.begin(), terms.end());
    Node total;
    for (const auto& [n, negative] : terms)
      total = negative ? graph_.subtract(total, n) : graph_.add(total, n);
    return total;
  }

  Graph& graph_;
  std::size_t longest_;
  std::vector<Value> values_;
  std::map<std::pair<int, int>, int> products_;
  std::map<int, int> leaves_;  ///< by node
  std::vector<Term> outputs_;
  std::vector<Node> made_;
  std::vector<char> is_made_;
  std::map<Pair, int> count_;  ///< of each pair in all sums
  std::set<std::pair<int, Pair>>
      frequent_;  ///< those that occur twice or more, by their count's opposite
  std::vector<std::vector<int>> users_;  ///< sums that have (or had) a value as a term
  long steps_ = 0;
};

}  // namespace

Program factored(Graph& graph, const std::vector<Node>& outputs, Effort effort, long* steps) {
  Program best = symbolic::compile(graph, outputs);
  for (const std::size_t longest : kLongest) {
    if (effort == Effort::kQuick && longest != kUsuallyBest) continue;
    Regrouping regrouping(graph, outputs, longest);
    const bool is_small = regrouping.run();
    if (is_small) {
      Program small = symbolic::compile(graph, regrouping.nodes());
      if (small.bodyOperations().all() < best.bodyOperations().all()) best = std::move(small);
    }
    if (steps) *steps += regrouping.steps();
    if (!is_small) break;
  }
  return best;
}

}  // namespace dynwitness::crosscheck::kernel
