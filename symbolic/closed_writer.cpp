// SPDX-License-Identifier: GPL-3.0-or-later
// From polynomials to the formulas that are shown.
#include <algorithm>
#include <optional>

#include "symbolic/closed_form.hpp"
#include "symbolic/rate_factors.hpp"

namespace dynwitness::symbolic {

/// Writes a polynomial as sums of products, common factors outside.
class ClosedAlgebra::Writer {
 public:
  explicit Writer(const std::vector<Symbol>& symbols) : symbols_(symbols) {}

  /// Terms with the same cosines and sines together, or first those with the same rates.
  Formula write(const Polynomial& p, bool rates_outside) const {
    const auto isTrig = [](Role r) { return r == Role::kCos || r == Role::kSin; };
    std::vector<Formula> terms;
    if (rates_outside) {
      for (const auto& [rates, inner] : grouped(p, [](Role r) { return r == Role::kRate; }))
        terms.push_back(join(write(inner, false), factors(rates)));
    } else {
      for (const auto& [trig, inner] : grouped(p, isTrig))
        terms.push_back(join(writeRates(inner), factors(trig)));
    }
    return Formula::sum(flattened(terms));
  }

 private:
  /// A polynomial by the part of its monomials whose symbols have a role.
  template <typename Predicate>
  std::map<Monomial, Polynomial, DisplayOrder> grouped(const Polynomial& p,
                                                       Predicate wanted) const {
    std::map<Monomial, Polynomial, DisplayOrder> groups;
    for (const auto& [monomial, r] : p) {
      Monomial key, rest;
      for (const auto& factor : monomial)
        (wanted(symbols_[factor.first].role) ? key : rest).push_back(factor);
      groups[key][rest] += r;
    }
    return groups;
  }

  std::vector<Formula> factors(const Monomial& m) const {
    std::vector<Formula> result;
    for (const auto& [symbol, exponent] : m)
      result.push_back(Formula::power(symbols_[symbol].shown, exponent));
    return result;
  }

  /// What stands in front, times more factors, the sign outside.
  static Formula join(Formula front, const std::vector<Formula>& more) {
    std::vector<Formula> all{std::move(front)};
    all.insert(all.end(), more.begin(), more.end());
    return Formula::product(all);
  }

  static std::vector<Formula> flattened(const std::vector<Formula>& terms) {
    std::vector<Formula> result;
    for (const Formula& term : terms) {
      if (term.kind == Formula::Kind::kSum)
        result.insert(result.end(), term.operands.begin(), term.operands.end());
      else
        result.push_back(term);
    }
    return result;
  }

  /// No cosines and sines any more: rates with polynomials in the numbers as coefficients. When
  /// these are multiples of one polynomial, it is written once.
  Formula writeRates(const Polynomial& p) const {
    const auto groups = grouped(p, [](Role r) { return r == Role::kRate; });
    const Polynomial& first = groups.begin()->second;
    Polynomial multiples;
    for (const auto& [rates, numbers] : groups) {
      const Rational ratio = numbers.begin()->second / first.begin()->second;
      if (!isMultiple(numbers, first, ratio)) {
        std::vector<Formula> terms;
        for (const auto& [r, n] : groups) terms.push_back(join(writeSum(n), factors(r)));
        return Formula::sum(flattened(terms));
      }
      multiples[rates] = ratio;
    }
    // whole numbers among the rates: qd2 (2 qd1 + qd2)
    scene::Integer divisor = 0, multiple = 1;
    for (const auto& [rates, ratio] : multiples) {
      divisor = gcd(divisor, abs(numerator(ratio)));
      multiple = lcm(multiple, denominator(ratio));
    }
    const Rational content(divisor, multiple);
    for (auto& entry : multiples) entry.second /= content;
    Polynomial coefficient = first;
    for (auto& entry : coefficient) entry.second *= content;
    std::vector<Formula> factors_of_rates = factoredRates(multiples);
    if (factors_of_rates.empty()) factors_of_rates = {writeSum(multiples)};
    return join(writeSum(coefficient), factors_of_rates);
  }

  /// (qd2 + qd3) (2 qd1 + qd2 + qd3), where a polynomial of the second degree is such a product;
  /// none: it is no such, or its common factor says it.
  std::vector<Formula> factoredRates(const Polynomial& p) const {
    QuadraticForm form;
    for (const auto& [rates, r] : p) {
      if (rates.size() == 1 && rates[0].second == 2)
        form[{rates[0].first, rates[0].first}] = r;
      else if (rates.size() == 2 && rates[0].second == 1 && rates[1].second == 1)
        form[std::minmax(rates[0].first, rates[1].first)] = r;
      else
        return {};
    }
    const auto factors_of_form = linearFactors(form);
    if (!factors_of_form) return {};
    const auto written = [this](const LinearForm& linear) {
      Polynomial sum;
      for (const auto& [symbol, r] : linear) sum[{{symbol, 1}}] = r;
      return writeSum(sum);
    };
    const auto& [first, second] = *factors_of_form;
    if (first.size() < 2 || second.size() < 2) return {};
    if (first == second) return {Formula::power(written(first), 2)};
    return {written(first), written(second)};
  }

  static bool isMultiple(const Polynomial& a, const Polynomial& b, const Rational& ratio) {
    if (a.size() != b.size()) return false;
    for (const auto& [m, r] : b) {
      const auto it = a.find(m);
      if (it == a.end() || it->second != ratio * r) return false;
    }
    return true;
  }

  /// A plain sum with its common monomial, a common size of coefficients and sign in front.
  Formula writeSum(const Polynomial& p) const {
    Monomial common = p.begin()->first;
    bool same_size = true, all_negative = true;
    const Rational size = abs(p.begin()->second);
    for (const auto& [m, r] : p) {
      Monomial shared;
      for (const auto& [symbol, exponent] : common)
        for (const auto& [other, other_exponent] : m)
          if (symbol == other) shared.emplace_back(symbol, std::min(exponent, other_exponent));
      common = shared;
      same_size = same_size && abs(r) == size;
      all_negative = all_negative && r < 0;
    }
    Rational content = same_size ? size : Rational(1);
    if (all_negative) content = -content;
    Monomial inverse = common;
    for (auto& factor : inverse) factor.second = -factor.second;
    Polynomial rest;
    for (const auto& [m, r] : p) rest[product(m, inverse)] = r / content;
    std::vector<Formula> all{Formula::ofNumber(content)};
    for (const Formula& factor : factors(common)) all.push_back(factor);
    all.push_back(gathered(rest));
    return Formula::product(all);
  }

  /// A sum without a common factor: term by term, or by masses, or by what masses are multiplied
  /// with, whatever is shortest.
  Formula gathered(const Polynomial& p) const {
    std::vector<Formula> terms;
    for (const auto& [m, r] : p) {
      const Formula term = join(Formula::ofNumber(abs(r)), factors(m));
      terms.push_back(r < 0 ? Formula::negate(term) : term);
    }
    Formula best = Formula::sum(terms);
    for (const bool by_mass : {true, false}) {
      std::map<Monomial, Polynomial, DisplayOrder> groups;
      for (const auto& [m, r] : p) {
        Monomial mass, others;
        for (const auto& factor : m) (isMass(factor.first) ? mass : others).push_back(factor);
        if (by_mass)
          groups[mass][others] = r;
        else
          groups[others][mass] = r;
      }
      if (groups.size() == 1 || groups.size() == p.size()) continue;
      terms.clear();
      for (const auto& [outside, inside] : groups)
        terms.push_back(outside.empty() ? writeSum(inside)
                                        : join(writeSum(inside), factors(outside)));
      const Formula form = Formula::sum(flattened(terms));
      if (print(form, Style::kText).size() < print(best, Style::kText).size()) best = form;
    }
    return best;
  }
  bool isMass(int symbol) const {
    const Formula& shown = symbols_[symbol].shown;
    return shown.kind == Formula::Kind::kSymbol && shown.symbol.front() == 'm';
  }

  const std::vector<Symbol>& symbols_;
};

Formula ClosedAlgebra::formula(const GiNaC::ex& x) {
  const Polynomial p = polynomial(x);
  return reduced(p, Role::kSin).empty() ? Formula::ofNumber(0) : shortest(forms(p));
}

Formula ClosedAlgebra::shortest(const std::vector<Polynomial>& forms) const {
  std::optional<Formula> best;
  std::size_t best_length = 0;
  for (const Polynomial& form : forms) {
    for (bool rates_outside : {false, true}) {
      const Formula f = Writer(symbols_).write(form, rates_outside);
      const std::size_t length = print(f, Style::kText).size();
      if (best && length >= best_length) continue;
      best = f;
      best_length = length;
    }
  }
  return *best;
}

}  // namespace dynwitness::symbolic
