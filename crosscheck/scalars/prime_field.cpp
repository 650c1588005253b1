// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/prime_field.hpp"

#include <array>

#include <flint/ulong_extras.h>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/formula_sizes.hpp"
#include "scene/rational_signs.hpp"

namespace dynwitness::crosscheck {
namespace {

/// |n| mod p with the sign of n.
PrimeField fromInteger(const scene::Integer& n) {
  std::uint64_t residue = 0;
  if (const auto& limbs = n.backend(); limbs.size() == 1)
    residue = *limbs.limbs() % PrimeField::modulus();
  else
    residue = static_cast<std::uint64_t>(scene::Integer(abs(n) % PrimeField::modulus()));
  const PrimeField element = PrimeField::fromResidue(residue);
  return n.sign() < 0 ? -element : element;
}

/// Any element of the field: 63 random bits, drawn again until they are below p.
PrimeField anyElement(RandomStream& random) {
  std::uint64_t bits = random.next() >> 1;
  while (bits >= PrimeField::modulus()) bits = random.next() >> 1;
  return PrimeField::fromResidue(bits);
}

}  // namespace

PrimeField::Modulus::Modulus(std::uint64_t prime) : outer_(modulus_), outer_sizes_(sizes_) {
  if (prime <= (std::uint64_t(1) << 61) || prime >> 63 != 0 || prime % 4 != 3 ||
      n_is_prime(prime) == 0)
    throw std::invalid_argument(fmt::format(
        "PrimeField::Modulus: prime: expected a prime p = 3 mod 4, 2^61 < p < 2^63, got {}",
        prime));
  nmod_init(&modulus_, prime);
  sizes_ = nullptr;
}

PrimeField::Modulus::~Modulus() {
  modulus_ = outer_;
  sizes_ = outer_sizes_;
}

PrimeField PrimeField::fromRational(const scene::Rational& value) {
  if (sizes_) return sizes_->constant(value);
  const PrimeField top = fromInteger(scene::top(value));
  const scene::Integer& bottom = scene::bottom(value);
  if (bottom.backend().size() == 1 && *bottom.backend().limbs() == 1) return top;
  const PrimeField divisor = fromInteger(bottom);
  // decimals have few denominators, and an inverse takes as long as ten products
  struct Known {
    std::uint64_t modulus, divisor, inverse;
  };
  static thread_local std::array<Known, 64> known = {};
  Known& at = known[divisor.word_ * 0x9e3779b97f4a7c15u >> 58];
  if (at.modulus != modulus_.n || at.divisor != divisor.word_)
    at = {modulus_.n, divisor.word_, divisor.inverse().word_};
  return top * PrimeField(at.inverse, Raw{});
}

PrimeField PrimeField::inverse() const {
  if (sizes_) return sizes_->quotient(sizes_->constant(1), *this);
  if (isZero()) throw DivisionByZero("division by zero modulo " + std::to_string(modulus_.n));
  return {nmod_inv(word_, modulus_), Raw{}};
}

PrimeField PrimeField::sizedSum(PrimeField a, PrimeField b) {
  return sizes_->sum(a, b);
}
PrimeField PrimeField::sizedConstant(int value) {
  return sizes_->constant(value);
}
PrimeField PrimeField::product(PrimeField a, PrimeField b) {
  if (a.isZero() || b.isZero()) return {};  // of either kind: two of three products of a sweep
  if (__builtin_expect(isSized(), 0)) return sizes_->product(a, b);
  return {nmod_mul(a.word_, b.word_, modulus_), Raw{}};
}
PrimeField PrimeField::quotient(PrimeField a, PrimeField b) {
  if (sizes_) return sizes_->quotient(a, b);
  return product(a, b.inverse());
}
double PrimeField::degree() const {
  return sizes_ ? sizes_->valueOf(*this).degree : 0;
}
double PrimeField::bits() const {
  return sizes_ ? sizes_->valueOf(*this).bits : 0;
}

PrimeField FieldSource::element(const std::string& what) const {
  if (PrimeField::isSized()) return FormulaSizes::indeterminate(1);
  RandomStream random(name_ + " " + what, seed_, index_);
  return anyElement(random);
}

scene::CosSin<PrimeField> FieldSource::circlePoint(const std::string& what) const {
  if (PrimeField::isSized())
    return {FormulaSizes::indeterminate(2), FormulaSizes::indeterminate(2)};
  const PrimeField t = element(what), t2 = t * t;
  const PrimeField scale = (PrimeField(1) + t2).inverse();
  return {(PrimeField(1) - t2) * scale, (t + t) * scale};
}

std::uint64_t drawPrime(const std::string& name, std::uint64_t seed, std::uint64_t index) {
  RandomStream random(name + " prime", seed, index);
  while (true) {
    const std::uint64_t candidate = (std::uint64_t(1) << 62) | (random.next() >> 2) | 3;
    if (n_is_prime(candidate) != 0) return candidate;
  }
}

}  // namespace dynwitness::crosscheck
