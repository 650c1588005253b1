// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/degree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/scalars/prime_field.hpp"

namespace dynwitness::crosscheck {
namespace {

/// At least log2 |n|, n not zero.
double bitsOf(const scene::Integer& n) {
  const auto bits = static_cast<double>(msb(abs(n)));
  return abs(n) == scene::Integer(1) << msb(abs(n)) ? bits : bits + 1;
}

}  // namespace

thread_local DegreeBound::Divisors* DegreeBound::current_ = nullptr;

DegreeBound::Divisors::Divisors() : outer_(current_), denominators_{{{}, {0, 0}}} {
  index_[{}] = 0;
  current_ = this;
}

int DegreeBound::Divisors::intern(const Powers& powers) {
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

int DegreeBound::Divisors::combined(int a, int b, bool add) {
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

int DegreeBound::Divisors::product(int a, int b) {
  if (a == 0 || b == 0) return a + b;
  if (b < a) std::swap(a, b);
  const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
  const auto it = products_.find(key);
  return it != products_.end() ? it->second : products_[key] = combined(a, b, true);
}

int DegreeBound::Divisors::common(int a, int b) {
  if (a == b || b == 0) return a;
  if (a == 0) return b;
  if (b < a) std::swap(a, b);
  const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
  const auto it = commons_.find(key);
  return it != commons_.end() ? it->second : commons_[key] = combined(a, b, false);
}

int DegreeBound::Divisors::newDivisor(Size size) {
  divisors_.push_back(size);
  total_degree_ += size.degree;
  total_bits_ += size.bits;
  return static_cast<int>(divisors_.size()) - 1;
}

int DegreeBound::Divisors::divisorOf(const DegreeBound& value) {
  const auto [it, is_new] = divisor_of_serial_.emplace(value.serial_, 0);
  if (is_new) it->second = newDivisor({value.degree_, value.bits_});
  return it->second;
}

int DegreeBound::Divisors::constantDivisor(const scene::Integer& n) {
  const auto [it, is_new] = constants_.emplace(n, 0);
  if (is_new) it->second = newDivisor({0, bitsOf(n)});
  return it->second;
}

DegreeBound::DegreeBound(double degree, double bits, int denominator)
    : degree_(degree), bits_(bits), denominator_(denominator), serial_(++current_->serial_) {}

DegreeBound::DegreeBound(int value) {
  if (value != 0) *this = DegreeBound(0, bitsOf(value), 0);
}

DegreeBound DegreeBound::constant(const scene::Rational& value) {
  if (value == 0) return {};
  const double bits = bitsOf(numerator(value));
  if (denominator(value) == 1) return {0, bits, 0};
  // decimals are what scenes are made of: common powers of 2, 3, 5, and the rest as it is
  Divisors& divisors = *current_;
  Divisors::Powers powers;
  scene::Integer rest = denominator(value);
  for (const int prime : {2, 3, 5}) {
    int exponent = 0;
    for (; rest % prime == 0; rest /= prime) ++exponent;
    if (exponent > 0) powers.emplace_back(divisors.constantDivisor(prime), exponent);
  }
  if (rest != 1) powers.emplace_back(divisors.constantDivisor(rest), 1);
  std::sort(powers.begin(), powers.end());
  return {0, bits, divisors.intern(powers)};
}

DegreeBound DegreeBound::indeterminate(double weight) {
  return {weight, 0, 0};
}

DegreeBound DegreeBound::sum(const DegreeBound& a, const DegreeBound& b) {
  if (a.isZero()) return b;
  if (b.isZero()) return a;
  if (a.denominator_ == b.denominator_)
    return {std::max(a.degree_, b.degree_), std::max(a.bits_, b.bits_) + 1, a.denominator_};
  Divisors& divisors = *current_;
  const int common = divisors.common(a.denominator_, b.denominator_);
  const auto& size = divisors.denominators_[common].size;
  const auto& a_size = divisors.denominators_[a.denominator_].size;
  const auto& b_size = divisors.denominators_[b.denominator_].size;
  return {size.degree + std::max(a.degree_ - a_size.degree, b.degree_ - b_size.degree),
          size.bits + std::max(a.bits_ - a_size.bits, b.bits_ - b_size.bits) + 1, common};
}

DegreeBound DegreeBound::product(const DegreeBound& a, const DegreeBound& b) {
  if (a.isZero() || b.isZero()) return {};
  if (a.denominator_ == 0 && b.denominator_ == 0)
    return {a.degree_ + b.degree_, a.bits_ + b.bits_, 0};
  // (N / E) (X / (N F)) = X / (E F)
  Divisors& divisors = *current_;
  for (const auto& [n, x] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    if (x->denominator_ == 0) continue;
    const auto known = divisors.divisor_of_serial_.find(n->serial_);
    if (known == divisors.divisor_of_serial_.end()) continue;
    auto powers = divisors.denominators_[x->denominator_].powers;
    const auto it = std::find_if(powers.begin(), powers.end(),
                                 [&](const auto& power) { return power.first == known->second; });
    if (it == powers.end()) continue;
    if (--it->second == 0) powers.erase(it);
    return {x->degree_, x->bits_, divisors.product(n->denominator_, divisors.intern(powers))};
  }
  return {a.degree_ + b.degree_, a.bits_ + b.bits_,
          divisors.product(a.denominator_, b.denominator_)};
}

DegreeBound DegreeBound::quotient(const DegreeBound& a, const DegreeBound& b) {
  if (b.isZero()) throw DivisionByZero("division by a formula that is zero");
  if (a.isZero()) return {};
  Divisors& divisors = *current_;
  // (X / E) / (N / F) = X F' / (E' N), with E' / F' = E / F in lowest terms
  Divisors::Powers below = divisors.denominators_[a.denominator_].powers;
  double degree = a.degree_, bits = a.bits_;
  for (const auto& [divisor, exponent] : divisors.denominators_[b.denominator_].powers) {
    const auto it = std::find_if(below.begin(), below.end(),
                                 [&](const auto& power) { return power.first == divisor; });
    const int cancelled = it == below.end() ? 0 : std::min(it->second, exponent);
    if (cancelled > 0) it->second -= cancelled;
    degree += (exponent - cancelled) * divisors.divisors_[divisor].degree;
    bits += (exponent - cancelled) * divisors.divisors_[divisor].bits;
  }
  below.erase(std::remove_if(below.begin(), below.end(),
                             [](const auto& power) { return power.second == 0; }),
              below.end());
  const int numerator_of_b = divisors.intern({{divisors.divisorOf(b), 1}});
  return {degree, bits, divisors.product(divisors.intern(below), numerator_of_b)};
}

double errorProbability(const DegreeBound& difference, const DegreeBound::Divisors& divisors) {
  const auto share = [](double degree, double bits) {
    return degree / kSmallestPrime + (bits + degree / 4) / 62 / kPrimesDrawnFrom;
  };
  if (difference.isZero()) return 0;
  const double drawn_again = share(divisors.totalDegree(), divisors.totalBits());
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
