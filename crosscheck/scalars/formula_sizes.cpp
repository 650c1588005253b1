// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/formula_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/rational_signs.hpp"

namespace dynwitness::crosscheck {
namespace {

/// At least log2 |n|, n not zero.
double bitsOf(const scene::Integer& n) {
  const scene::Integer size = abs(n);
  const auto bits = static_cast<double>(msb(size));
  return lsb(size) == msb(size) ? bits : bits + 1;  // a power of two, or more
}

}  // namespace

FormulaSizes::FormulaSizes() : outer_(PrimeField::sizes_), denominators_{{{}, {0, 0}}} {
  index_[{}] = 0;
  PrimeField::sizes_ = this;
}

int FormulaSizes::intern(const Powers& powers) {
  const auto [it, is_new] = index_.emplace(powers, static_cast<int>(denominators_.size()));
  if (is_new) {
    Size size{0, 0};
    for (const auto& [divisor, exponent] : powers) {
      size.degree += exponent * divisors_[divisor].degree;
      size.bits += exponent * divisors_[divisor].bits;
    }
    denominators_.push_back({powers, size});
  }
  return it->second;
}

int FormulaSizes::combined(int a, int b, bool add) {
  const Powers &x = denominators_[a].powers, &y = denominators_[b].powers;
  Powers both;
  for (std::size_t i = 0, j = 0; i < x.size() || j < y.size();) {
    if (j == y.size() || (i < x.size() && x[i].first < y[j].first)) {
      both.push_back(x[i++]);
    } else if (i == x.size() || y[j].first < x[i].first) {
      both.push_back(y[j++]);
    } else {
      const int m = x[i].second, n = y[j].second;
      both.emplace_back(x[i].first, add ? m + n : std::max(m, n));
      ++i, ++j;
    }
  }
  return intern(both);
}

int FormulaSizes::timesDenominator(int a, int b) {
  if (a == 0 || b == 0) return a + b;
  if (b < a) std::swap(a, b);
  const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
  const auto it = products_.find(key);
  return it != products_.end() ? it->second : products_[key] = combined(a, b, true);
}

int FormulaSizes::common(int a, int b) {
  if (a == b || b == 0) return a;
  if (a == 0) return b;
  if (b < a) std::swap(a, b);
  const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
  const auto it = commons_.find(key);
  return it != commons_.end() ? it->second : commons_[key] = combined(a, b, false);
}

int FormulaSizes::newDivisor(Size size) {
  divisors_.push_back(size);
  total_degree_ += size.degree;
  total_bits_ += size.bits;
  return static_cast<int>(divisors_.size()) - 1;
}

int FormulaSizes::divisorOf(const PrimeField& value) {
  const auto [it, is_new] = divisor_of_operation_.emplace(value.word_, 0);
  if (is_new) it->second = newDivisor({value.degree_, value.bits_});
  return it->second;
}

int FormulaSizes::constantDivisor(const scene::Integer& n) {
  const auto [it, is_new] = constants_.emplace(n, 0);
  if (is_new) it->second = newDivisor({0, bitsOf(n)});
  return it->second;
}

PrimeField FormulaSizes::made(double degree, double bits, int denominator) {
  PrimeField value;
  value.word_ = ++operations_;
  value.degree_ = degree;
  value.bits_ = bits;
  value.denominator_ = denominator;
  return value;
}

PrimeField FormulaSizes::constant(int value) {
  return value == 0 ? PrimeField() : made(0, bitsOf(value), 0);
}

PrimeField FormulaSizes::constant(const scene::Rational& value) {
  if (scene::isZero(value)) return {};
  const double bits = bitsOf(scene::top(value));
  if (scene::bottom(value) == 1) return made(0, bits, 0);
  // decimals are what scenes are made of: common powers of 2, 3, 5, and the rest as it is
  Powers powers;
  scene::Integer rest = denominator(value);
  for (const int prime : {2, 3, 5}) {
    int exponent = 0;
    for (; rest % prime == 0; rest /= prime) ++exponent;
    if (exponent > 0) powers.emplace_back(constantDivisor(prime), exponent);
  }
  if (rest != 1) powers.emplace_back(constantDivisor(rest), 1);
  std::sort(powers.begin(), powers.end());
  return made(0, bits, intern(powers));
}

PrimeField FormulaSizes::indeterminate(double weight) {
  return PrimeField::sizes_->made(weight, 0, 0);
}

PrimeField FormulaSizes::sum(const PrimeField& a, const PrimeField& b) {
  if (a.isZero()) return b;
  if (b.isZero()) return a;
  if (a.denominator_ == b.denominator_)
    return made(std::max(a.degree_, b.degree_), std::max(a.bits_, b.bits_) + 1, a.denominator_);
  const int both = common(a.denominator_, b.denominator_);
  const auto& size = denominators_[both].size;
  const auto& a_size = denominators_[a.denominator_].size;
  const auto& b_size = denominators_[b.denominator_].size;
  return made(size.degree + std::max(a.degree_ - a_size.degree, b.degree_ - b_size.degree),
              size.bits + std::max(a.bits_ - a_size.bits, b.bits_ - b_size.bits) + 1, both);
}

PrimeField FormulaSizes::product(const PrimeField& a, const PrimeField& b) {
  if (a.isZero() || b.isZero()) return {};
  if (a.denominator_ == 0 && b.denominator_ == 0)
    return made(a.degree_ + b.degree_, a.bits_ + b.bits_, 0);
  // (N / E) (X / (N F)) = X / (E F)
  for (const auto& [n, x] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    if (x->denominator_ == 0) continue;
    const auto known = divisor_of_operation_.find(n->word_);
    if (known == divisor_of_operation_.end()) continue;
    auto powers = denominators_[x->denominator_].powers;
    const auto it = std::find_if(powers.begin(), powers.end(),
                                 [&](const auto& power) { return power.first == known->second; });
    if (it == powers.end()) continue;
    if (--it->second == 0) powers.erase(it);
    return made(x->degree_, x->bits_, timesDenominator(n->denominator_, intern(powers)));
  }
  return made(a.degree_ + b.degree_, a.bits_ + b.bits_,
              timesDenominator(a.denominator_, b.denominator_));
}

PrimeField FormulaSizes::quotient(const PrimeField& a, const PrimeField& b) {
  if (b.isZero()) throw DivisionByZero("division by a formula that is zero");
  if (a.isZero()) return {};
  // (X / E) / (N / F) = X F' / (E' N), with E' / F' = E / F in lowest terms
  Powers below = denominators_[a.denominator_].powers;
  double degree = a.degree_, bits = a.bits_;
  for (const auto& [divisor, exponent] : denominators_[b.denominator_].powers) {
    const auto it = std::find_if(below.begin(), below.end(),
                                 [&](const auto& power) { return power.first == divisor; });
    const int cancelled = it == below.end() ? 0 : std::min(it->second, exponent);
    if (cancelled > 0) it->second -= cancelled;
    degree += (exponent - cancelled) * divisors_[divisor].degree;
    bits += (exponent - cancelled) * divisors_[divisor].bits;
  }
  below.erase(std::remove_if(below.begin(), below.end(),
                             [](const auto& power) { return power.second == 0; }),
              below.end());
  const int numerator_of_b = intern({{divisorOf(b), 1}});
  return made(degree, bits, timesDenominator(intern(below), numerator_of_b));
}

double errorProbability(const PrimeField& difference, const FormulaSizes& sizes) {
  const auto share = [](double degree, double bits) {
    return degree / kSmallestPrime + (bits + degree / 4) / 62 / kPrimesDrawnFrom;
  };
  if (difference.isZero()) return 0;
  const double drawn_again = share(sizes.totalDegree(), sizes.totalBits());
  const double chance = share(difference.degree(), difference.bits()) / (1 - drawn_again);
  return drawn_again < 1 && chance < 1 ? chance : std::numeric_limits<double>::infinity();
}

int pointsNeeded(double p, double target) {
  if (!(p >= 0 && p < 1 && target > 0 && target < 1))
    throw std::invalid_argument(fmt::format(
        "pointsNeeded: expected 0 <= p < 1 and 0 < target < 1, got {} and {}", p, target));
  if (p == 0) return 1;
  int points = std::max(1, static_cast<int>(std::ceil(std::log(target) / std::log(p))) - 1);
  while (points * std::log(p) > std::log(target))
    ++points;  // the quotient of logarithms is rounded
  return points;
}

}  // namespace dynwitness::crosscheck
