// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/rate_factors.hpp"

#include <algorithm>

namespace dynwitness::symbolic {
namespace {

using scene::Integer;
using scene::Rational;

template <typename Form, typename Key>
void accumulate(const Key& key, const Rational& r, Form* form) {
  const auto at = form->emplace(key, 0).first;
  at->second += r;
  if (at->second == 0) form->erase(at);
}

QuadraticForm product(const LinearForm& a, const LinearForm& b) {
  QuadraticForm out;
  for (const auto& [i, r] : a)
    for (const auto& [j, s] : b) accumulate(std::minmax(i, j), Rational(r * s), &out);
  return out;
}

/// Q = a x^2 + x L + R
struct ByVariable {
  Rational a = 0;
  LinearForm L;
  QuadraticForm R;
};
ByVariable byVariable(const QuadraticForm& Q, int x) {
  ByVariable out;
  for (const auto& [pair, r] : Q) {
    const auto& [i, j] = pair;
    if (i == x && j == x)
      out.a = r;
    else if (i == x || j == x)
      out.L[i == x ? j : i] = r;
    else
      out.R[pair] = r;
  }
  return out;
}

std::optional<Rational> squareRoot(const Rational& square) {
  if (square < 0) return std::nullopt;
  const Integer n = sqrt(Integer(numerator(square))), d = sqrt(Integer(denominator(square)));
  const Rational root(n, d);
  return root * root == square ? std::optional(root) : std::nullopt;
}

/// The linear form whose square D is; none: there is none.
std::optional<LinearForm> squareRoot(const QuadraticForm& D) {
  if (D.empty()) return LinearForm();
  const int x = D.begin()->first.first;
  const ByVariable by = byVariable(D, x);
  const std::optional<Rational> first = squareRoot(by.a);
  if (!first || *first == 0) return std::nullopt;
  LinearForm root{{x, *first}};
  for (const auto& [j, r] : by.L) root[j] = r / (2 * *first);
  return product(root, root) == D ? std::optional(root) : std::nullopt;
}

/// The common size and first sign of a form's coefficients taken off it.
Rational takeContent(LinearForm* form) {
  Integer divisor = 0, multiple = 1;
  for (const auto& entry : *form) {
    divisor = gcd(divisor, abs(Integer(numerator(entry.second))));
    multiple = lcm(multiple, Integer(denominator(entry.second)));
  }
  Rational content(divisor, multiple);
  if (form->begin()->second < 0) content = -content;
  for (auto& entry : *form) entry.second /= content;
  return content;
}

}  // namespace

std::optional<std::pair<LinearForm, LinearForm>> linearFactors(const QuadraticForm& Q) {
  if (Q.empty()) return std::nullopt;
  const auto square = std::find_if(Q.begin(), Q.end(), [](const auto& entry) {
    return entry.first.first == entry.first.second;
  });
  const int x = square != Q.end() ? square->first.first : Q.begin()->first.first;
  const ByVariable by = byVariable(Q, x);
  LinearForm first, second;
  if (square == Q.end()) {  // L (x + K), K = R / L by the first variable of L
    const int y = by.L.begin()->first;
    first = by.L;
    second[x] = 1;
    for (const auto& [j, r] : byVariable(by.R, y).L) second[j] = r / by.L.begin()->second;
  } else {
    QuadraticForm D = product(by.L, by.L);
    for (const auto& [pair, r] : by.R) accumulate(pair, Rational(-4 * by.a * r), &D);
    const std::optional<LinearForm> root = squareRoot(D);
    if (!root) return std::nullopt;
    first = second = by.L;
    first[x] = second[x] = 2 * by.a;
    for (const auto& [j, r] : *root) {
      accumulate(j, r, &first);
      accumulate(j, Rational(-r), &second);
    }
    for (auto& entry : second) entry.second /= 4 * by.a;
  }
  const Rational content = takeContent(&first);
  for (auto& entry : second) entry.second *= content;
  if (product(first, second) != Q) return std::nullopt;
  return std::pair(first, second);
}

}  // namespace dynwitness::symbolic
