// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/formula_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
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

FormulaSizes::FormulaSizes()
    : outer_(PrimeField::sizes_),
      values_(1),
      buckets_(1 << 12, 0),
      memory_(1 << 14),
      denominators_{{{}, {0, 0}}} {
  index_[{}] = 0;
  PrimeField::sizes_ = this;
}

// ---- sizes, each kept once ----------------------------------------------------------------------

namespace {

std::uint64_t mixed(std::uint64_t h) {
  h *= 0x9e3779b97f4a7c15u;
  return h ^ (h >> 32);
}

std::uint64_t hashOf(double degree, double bits, int denominator) {
  std::uint64_t words[2];
  static_assert(sizeof(double) == sizeof(words[0]));
  std::memcpy(&words[0], &degree, sizeof degree);
  std::memcpy(&words[1], &bits, sizeof bits);
  return mixed(mixed(mixed(words[0]) ^ words[1]) ^ static_cast<std::uint64_t>(denominator));
}

}  // namespace

std::uint64_t FormulaSizes::kept(const Value& value) {
  const std::uint64_t mask = buckets_.size() - 1;
  std::uint64_t at = hashOf(value.degree, value.bits, value.denominator) & mask;
  for (; buckets_[at] != 0; at = (at + 1) & mask) {
    const Value& other = values_[buckets_[at]];
    if (other.degree == value.degree && other.bits == value.bits &&
        other.denominator == value.denominator)
      return buckets_[at];
  }
  const std::uint64_t index = values_.size();
  if (index >> (64 - kOperationBits) != 0)
    throw std::length_error("FormulaSizes: more than 2^28 sizes of formulas");
  values_.push_back(value);
  buckets_[at] = static_cast<std::uint32_t>(index);
  if (2 * values_.size() > buckets_.size()) growBuckets();
  return index;
}

void FormulaSizes::growBuckets() {
  buckets_.assign(2 * buckets_.size(), 0);
  const std::uint64_t mask = buckets_.size() - 1;
  for (std::size_t i = 1; i < values_.size(); ++i) {
    std::uint64_t at = hashOf(values_[i].degree, values_[i].bits, values_[i].denominator) & mask;
    while (buckets_[at] != 0) at = (at + 1) & mask;
    buckets_[at] = static_cast<std::uint32_t>(i);
  }
}

std::uint64_t FormulaSizes::remembered(Made made, std::uint64_t a, std::uint64_t b) {
  if (b < a) std::swap(a, b);
  const std::uint64_t key = a << 32 | b << 1 | static_cast<std::uint64_t>(made);
  Remembered& memory = memory_[mixed(key) & (memory_.size() - 1)];
  if (memory.key == key) return memory.index;
  const Value value =
      made == Made::kSum ? sumOf(values_[a], values_[b]) : productOf(values_[a], values_[b]);
  memory = {key, kept(value)};
  return memory.index;
}

PrimeField FormulaSizes::made(std::uint64_t index) {
  PrimeField value;
  value.word_ = index << kOperationBits | (++operations_ & kOperation);
  return value;
}

// ---- denominators -------------------------------------------------------------------------------

std::size_t FormulaSizes::PowersHash::operator()(const Powers& powers) const {
  std::uint64_t h = powers.size();
  for (const auto& [divisor, exponent] : powers)
    h = mixed(h ^
              (static_cast<std::uint64_t>(divisor) << 32 | static_cast<std::uint32_t>(exponent)));
  return h;
}

int FormulaSizes::intern(const Powers& powers) {
  const auto [it, is_new] = index_.try_emplace(powers, static_cast<int>(denominators_.size()));
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
  Powers& both = scratch_;
  both.clear();
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

int FormulaSizes::divisorOf(PrimeField value) {
  const auto [it, is_new] = divisor_of_operation_.emplace(operationOf(value), 0);
  if (is_new) {
    it->second = newDivisor({valueOf(value).degree, valueOf(value).bits});
    may_divide_.set(operationOf(value) % may_divide_.size());
  }
  return it->second;
}

int FormulaSizes::constantDivisor(const scene::Integer& n) {
  const auto [it, is_new] = constants_.emplace(n, 0);
  if (is_new) it->second = newDivisor({0, bitsOf(n)});
  return it->second;
}

// ---- values -------------------------------------------------------------------------------------

PrimeField FormulaSizes::constant(int value) {
  if (value == 0) return {};
  int bits = 0;  // as bitsOf()
  for (std::int64_t n = std::abs(static_cast<std::int64_t>(value)); std::int64_t(1) << bits < n;)
    ++bits;
  return made(0, bits, 0);
}

PrimeField FormulaSizes::constant(const scene::Rational& value) {
  if (scene::isZero(value)) return {};
  const double bits = bitsOf(scene::top(value));
  if (scene::bottom(value) == 1) return made(0, bits, 0);
  // decimals are what scenes are made of: common powers of 2, 3, 5, and the rest as it is
  Powers powers;
  scene::Integer rest = scene::bottom(value);
  const auto factor = [&](auto& n) {
    for (const int prime : {2, 3, 5}) {
      int exponent = 0;
      for (; n % prime == 0; n /= prime) ++exponent;
      if (exponent > 0) powers.emplace_back(constantDivisor(prime), exponent);
    }
  };
  if (rest.backend().size() == 1) {
    auto small = static_cast<std::uint64_t>(rest);
    factor(small);
    rest = small;
  } else {
    factor(rest);
  }
  if (rest != 1) powers.emplace_back(constantDivisor(rest), 1);
  std::sort(powers.begin(), powers.end());
  return made(0, bits, intern(powers));
}

PrimeField FormulaSizes::indeterminate(double weight) {
  return PrimeField::sizes_->made(weight, 0, 0);
}

FormulaSizes::Value FormulaSizes::sumOf(const Value& a, const Value& b) {
  if (a.denominator == b.denominator)
    return {std::max(a.degree, b.degree), std::max(a.bits, b.bits) + 1, a.denominator};
  const int both = common(a.denominator, b.denominator);
  const auto& size = denominators_[both].size;
  const auto& a_size = denominators_[a.denominator].size;
  const auto& b_size = denominators_[b.denominator].size;
  return {size.degree + std::max(a.degree - a_size.degree, b.degree - b_size.degree),
          size.bits + std::max(a.bits - a_size.bits, b.bits - b_size.bits) + 1, both};
}

FormulaSizes::Value FormulaSizes::productOf(const Value& a, const Value& b) {
  return {a.degree + b.degree, a.bits + b.bits, timesDenominator(a.denominator, b.denominator)};
}

PrimeField FormulaSizes::sum(PrimeField a, PrimeField b) {
  if (a.isZero()) return b;
  if (b.isZero()) return a;
  return made(remembered(Made::kSum, indexOf(a), indexOf(b)));
}

bool FormulaSizes::cancelled(PrimeField n, PrimeField x, PrimeField* out) {
  const Value value = valueOf(x);
  if (value.denominator == 0 || !may_divide_.test(operationOf(n) % may_divide_.size()))
    return false;
  const auto known = divisor_of_operation_.find(operationOf(n));
  if (known == divisor_of_operation_.end()) return false;
  auto powers = denominators_[value.denominator].powers;
  const auto it = std::find_if(powers.begin(), powers.end(),
                               [&](const auto& power) { return power.first == known->second; });
  if (it == powers.end()) return false;
  if (--it->second == 0) powers.erase(it);
  *out = made(value.degree, value.bits, timesDenominator(valueOf(n).denominator, intern(powers)));
  return true;
}

PrimeField FormulaSizes::product(PrimeField a, PrimeField b) {
  if (a.isZero() || b.isZero()) return {};
  PrimeField out;
  if (cancelled(a, b, &out) || cancelled(b, a, &out)) return out;
  return made(remembered(Made::kProduct, indexOf(a), indexOf(b)));
}

PrimeField FormulaSizes::quotient(PrimeField a, PrimeField b) {
  if (b.isZero()) throw DivisionByZero("division by a formula that is zero");
  if (a.isZero()) return {};
  // (X / E) / (N / F) = X F' / (E' N), with E' / F' = E / F in lowest terms
  const Value top = valueOf(a);
  Powers below = denominators_[top.denominator].powers;
  double degree = top.degree, bits = top.bits;
  for (const auto& [divisor, exponent] : denominators_[valueOf(b).denominator].powers) {
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
