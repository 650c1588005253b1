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

/// At least log2 n, n not zero.
int bitsOf(std::uint64_t n) {
  const int bits = 63 - __builtin_clzll(n);
  return (n & (n - 1)) == 0 ? bits : bits + 1;  // a power of two, or more
}
/// At least log2 |n|, n not zero.
double bitsOf(const scene::Integer& n) {
  if (n.backend().size() == 1) return bitsOf(*n.backend().limbs());
  const scene::Integer size = abs(n);
  const auto bits = static_cast<double>(msb(size));
  return lsb(size) == msb(size) ? bits : bits + 1;  // a power of two, or more
}

constexpr int kMadeBits = 13;  // more finds hardly more

}  // namespace

FormulaSizes::FormulaSizes()
    : outer_(PrimeField::sizes_),
      values_(1),
      places_(1 << 12, 0),
      made_lately_(1 << kMadeBits),
      denominators_{{0, 0, {0, 0}}},
      index_(1 << 8, 0) {
  PrimeField::sizes_ = this;
}

// ---- sizes --------------------------------------------------------------------------------------

namespace {

constexpr std::uint64_t kMix = 0x9e3779b97f4a7c15u;

std::uint64_t mixed(std::uint64_t h) {
  h *= kMix;
  return h ^ (h >> 32);
}

std::uint64_t wordOf(double x) {
  std::uint64_t word = 0;
  static_assert(sizeof x == sizeof word);
  std::memcpy(&word, &x, sizeof word);
  return word;
}

}  // namespace

std::uint64_t FormulaSizes::hashOf(const Value& value) {
  // the last bits of both doubles are zero as a rule: those from above are brought down
  const std::uint64_t h = mixed(mixed(wordOf(value.degree)) ^ wordOf(value.bits)) ^
                          static_cast<std::uint64_t>(value.denominator);
  return mixed(h);
}

std::uint64_t FormulaSizes::kept(const Value& value) {
  std::size_t at = hashOf(value) & (places_.size() - 1);
  for (; places_[at] != 0; at = (at + 1) & (places_.size() - 1)) {
    const Value& other = values_[places_[at]];
    if (other.degree == value.degree && other.bits == value.bits &&
        other.denominator == value.denominator)
      return places_[at];
  }
  const std::uint64_t index = values_.size();
  if (index >> (64 - kOperationBits) != 0)
    throw std::length_error("FormulaSizes: more than 2^28 sizes of formulas");
  places_[at] = static_cast<std::uint32_t>(index);
  values_.push_back(value);
  if (2 * values_.size() > places_.size()) growPlaces();
  return index;
}

void FormulaSizes::growPlaces() {
  places_.assign(4 * places_.size(), 0);
  for (std::size_t i = 1; i < values_.size(); ++i) {
    std::size_t at = hashOf(values_[i]) & (places_.size() - 1);
    while (places_[at] != 0) at = (at + 1) & (places_.size() - 1);
    places_[at] = static_cast<std::uint32_t>(i);
  }
}

PrimeField FormulaSizes::made(std::uint64_t index) {
  PrimeField value;
  value.word_ = index << kOperationBits | (++operations_ & kOperation);
  return value;
}

// ---- denominators -------------------------------------------------------------------------------

FormulaSizes::OfTwo::Known& FormulaSizes::OfTwo::placeOf(std::uint64_t key) {
  std::size_t at = mixed(key) & (known_.size() - 1);
  while (known_[at].key != key && known_[at].key != kNone) at = (at + 1) & (known_.size() - 1);
  return known_[at];
}

int& FormulaSizes::OfTwo::operator()(int a, int b) {
  const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
  Known* place = &placeOf(key);
  if (place->key == key) return place->value;
  if (2 * ++count_ > known_.size()) {
    std::vector<Known> old(2 * known_.size());
    old.swap(known_);
    for (const Known& known : old)
      if (known.key != kNone) placeOf(known.key) = known;
    place = &placeOf(key);
  }
  place->key = key;
  return place->value;
}

std::uint64_t FormulaSizes::hashOf(const Power* powers, std::size_t count) {
  std::uint64_t h = count;
  for (std::size_t i = 0; i < count; ++i)
    h = (h ^ static_cast<std::uint64_t>(powers[i].first) << 32 ^
         static_cast<std::uint64_t>(powers[i].second)) *
        kMix;
  return h ^ (h >> 32);
}

int FormulaSizes::intern(const Power* powers, std::size_t count) {
  if (count == 0) return 0;
  std::size_t at = hashOf(powers, count) & (index_.size() - 1);
  for (; index_[at] != 0; at = (at + 1) & (index_.size() - 1)) {
    const Denominator& known = denominators_[index_[at]];
    if (known.end - known.begin == count &&
        std::equal(powers, powers + count, powers_.data() + known.begin))
      return index_[at];
  }
  Size size{0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [divisor, exponent] = powers[i];
    size.degree += static_cast<double>(exponent) * divisors_[divisor].degree;
    size.bits += static_cast<double>(exponent) * divisors_[divisor].bits;
  }
  const auto added = static_cast<int>(denominators_.size());
  const std::size_t begin = powers_.size();
  powers_.insert(powers_.end(), powers, powers + count);
  denominators_.push_back({begin, begin + count, size});
  index_[at] = added;
  if (2 * denominators_.size() > index_.size()) growIndex();
  return added;
}

void FormulaSizes::growIndex() {
  index_.assign(2 * index_.size(), 0);
  for (std::size_t i = 1; i < denominators_.size(); ++i) {
    const Denominator& of = denominators_[i];
    std::size_t at = hashOf(powers_.data() + of.begin, of.end - of.begin) & (index_.size() - 1);
    while (index_[at] != 0) at = (at + 1) & (index_.size() - 1);
    index_[at] = static_cast<int>(i);
  }
}

FormulaSizes::Powers FormulaSizes::powersOf(int denominator) const {
  const Denominator& of = denominators_[denominator];
  const auto first = powers_.begin();
  return {first + static_cast<std::ptrdiff_t>(of.begin),
          first + static_cast<std::ptrdiff_t>(of.end)};
}

int FormulaSizes::combined(int a, int b, bool add) {
  const Denominator x = denominators_[a], y = denominators_[b];
  const std::size_t most = (x.end - x.begin) + (y.end - y.begin);
  if (both_.size() < most) both_.resize(most);
  Power* to = both_.data();
  const Power *p = powers_.data() + x.begin, *q = powers_.data() + y.begin;
  const Power *p_end = powers_.data() + x.end, *q_end = powers_.data() + y.end;
  while (p != p_end && q != q_end) {
    if (p->first < q->first) {
      *to++ = *p++;
    } else if (q->first < p->first) {
      *to++ = *q++;
    } else {
      *to++ = {p->first, add ? p->second + q->second : std::max(p->second, q->second)};
      ++p, ++q;
    }
  }
  to = std::copy(p, p_end, to);
  to = std::copy(q, q_end, to);
  return intern(both_.data(), static_cast<std::size_t>(to - both_.data()));
}

int FormulaSizes::timesDenominator(int a, int b) {
  if (a == 0 || b == 0) return a + b;
  if (b < a) std::swap(a, b);
  int& known = products_(a, b);
  return known >= 0 ? known : known = combined(a, b, true);
}

int FormulaSizes::common(int a, int b) {
  if (a == b || b == 0) return a;
  if (a == 0) return b;
  if (b < a) std::swap(a, b);
  int& known = commons_(a, b);
  return known >= 0 ? known : known = combined(a, b, false);
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
  return made(0, bitsOf(static_cast<std::uint64_t>(std::abs(static_cast<std::int64_t>(value)))), 0);
}

PrimeField FormulaSizes::constant(const scene::Rational& value) {
  if (scene::isZero(value)) return {};
  return made(0, bitsOf(scene::top(value)), denominatorOf(value));
}

int FormulaSizes::denominatorOf(const scene::Rational& constant) {
  const auto& bottom = scene::bottom(constant).backend();
  const bool is_word = bottom.size() == 1;
  const std::uint64_t word = is_word ? *bottom.limbs() : 0;
  if (word == 1) return 0;
  OfConstant& known = of_constants_[word * kMix >> 58];
  if (is_word && known.word == word) return known.denominator;
  // decimals are what scenes are made of: common powers of 2, 3, 5, and the rest as it is
  Powers powers;
  scene::Integer rest = scene::bottom(constant);
  const auto factor = [&](auto& n) {
    for (const int prime : {2, 3, 5}) {
      int exponent = 0;
      for (; n % prime == 0; n /= prime) ++exponent;
      if (exponent > 0) powers.emplace_back(constantDivisor(prime), exponent);
    }
  };
  if (is_word) {
    std::uint64_t small = word;
    factor(small);
    rest = small;
  } else {
    factor(rest);
  }
  if (rest != 1) powers.emplace_back(constantDivisor(rest), 1);
  std::sort(powers.begin(), powers.end());
  const int denominator = intern(powers);
  if (is_word) known = {word, denominator};
  return denominator;
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

template <FormulaSizes::OfSizes Make>
PrimeField FormulaSizes::commuting(PrimeField a, PrimeField b) {
  std::uint64_t x = indexOf(a), y = indexOf(b);
  if (y < x) std::swap(x, y);
  constexpr int kIndexBits = 64 - kOperationBits;
  const std::uint64_t of = (x << kIndexBits | y) << 1 | (Make == &FormulaSizes::productOf ? 1 : 0);
  Made& known = made_lately_[of * kMix >> (64 - kMadeBits)];
  if (known.of != of) known = {of, kept((this->*Make)(valueOf(a), valueOf(b)))};
  return made(known.index);
}

PrimeField FormulaSizes::sum(PrimeField a, PrimeField b) {
  if (a.isZero()) return b;
  if (b.isZero()) return a;
  return commuting<&FormulaSizes::sumOf>(a, b);
}

bool FormulaSizes::cancelled(PrimeField n, PrimeField x, PrimeField* out) {
  const Value value = valueOf(x);
  if (value.denominator == 0) return false;
  const auto known = divisor_of_operation_.find(operationOf(n));
  if (known == divisor_of_operation_.end()) return false;
  Powers powers = powersOf(value.denominator);
  const auto it = std::find_if(powers.begin(), powers.end(),
                               [&](const Power& power) { return power.first == known->second; });
  if (it == powers.end()) return false;
  if (--it->second == 0) powers.erase(it);
  *out = made(value.degree, value.bits, timesDenominator(valueOf(n).denominator, intern(powers)));
  return true;
}

PrimeField FormulaSizes::product(PrimeField a, PrimeField b) {  // neither is 0
  PrimeField out;
  if (mayDivide(a) && cancelled(a, b, &out)) return out;
  if (mayDivide(b) && cancelled(b, a, &out)) return out;
  return commuting<&FormulaSizes::productOf>(a, b);
}

PrimeField FormulaSizes::quotient(PrimeField a, PrimeField b) {
  if (b.isZero()) throw DivisionByZero("division by a formula that is zero");
  if (a.isZero()) return {};
  // (X / E) / (N / F) = X F' / (E' N), with E' / F' = E / F in lowest terms
  const Value top = valueOf(a);
  Powers below = powersOf(top.denominator);
  double degree = top.degree, bits = top.bits;
  for (const auto& [divisor, exponent] : powersOf(valueOf(b).denominator)) {
    const auto it = std::find_if(below.begin(), below.end(),
                                 [&](const auto& power) { return power.first == divisor; });
    const std::int64_t cancelled = it == below.end() ? 0 : std::min(it->second, exponent);
    if (cancelled > 0) it->second -= cancelled;
    degree += static_cast<double>(exponent - cancelled) * divisors_[divisor].degree;
    bits += static_cast<double>(exponent - cancelled) * divisors_[divisor].bits;
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
