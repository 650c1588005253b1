// SPDX-License-Identifier: GPL-3.0-or-later
// Integers modulo a prime: arithmetic without rounding, in which two formulas are equal or not.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include <Eigen/Core>

#include <flint/nmod_vec.h>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "crosscheck/scalars/indeterminates.hpp"

namespace dynwitness::crosscheck {

/// A divisor was zero: the formula has no value at this point, and another one has to be drawn.
class DivisionByZero : public std::domain_error {
 public:
  using std::domain_error::domain_error;
};

/** An element of the field of integers modulo a prime p below 2^63, through FLINT's nmod.

    The prime is that of the innermost Modulus of the thread; elements made under one prime mean
    nothing under another. + - * and comparison are exact, so is division by anything but zero.
    There is no order and no size: a residual is zero or it is not. */
class PrimeField {
 public:
  /// The field that this thread computes in, for as long as the object lives.
  class Modulus {
   public:
    /// @throws std::invalid_argument unless `prime` is a prime, p = 3 mod 4 and 2^61 < p < 2^63.
    explicit Modulus(std::uint64_t prime);
    ~Modulus() { modulus_ = outer_; }
    Modulus(const Modulus&) = delete;
    Modulus& operator=(const Modulus&) = delete;

   private:
    nmod_t outer_;
  };
  static std::uint64_t modulus() { return modulus_.n; }

  PrimeField() = default;
  PrimeField(int value)  // NOLINT(google-explicit-constructor): integers are field elements
      : residue_(value >= 0
                     ? static_cast<mp_limb_t>(value)
                     : modulus_.n - static_cast<mp_limb_t>(-static_cast<std::int64_t>(value))) {}
  /// The class of an integer 0 <= residue < p.
  static PrimeField fromResidue(std::uint64_t residue) { return PrimeField(residue, Raw{}); }
  /// numerator / denominator. @throws DivisionByZero when p divides the denominator.
  static PrimeField fromRational(const scene::Rational& value);

  std::uint64_t residue() const { return residue_; }
  bool isZero() const { return residue_ == 0; }
  /// @throws DivisionByZero for zero
  PrimeField inverse() const;

  friend PrimeField operator+(PrimeField a, PrimeField b) {
    return {_nmod_add(a.residue_, b.residue_, modulus_), Raw{}};
  }
  friend PrimeField operator-(PrimeField a, PrimeField b) {
    return {_nmod_sub(a.residue_, b.residue_, modulus_), Raw{}};
  }
  friend PrimeField operator*(PrimeField a, PrimeField b) {
    return {nmod_mul(a.residue_, b.residue_, modulus_), Raw{}};
  }
  friend PrimeField operator/(PrimeField a, PrimeField b) { return a * b.inverse(); }
  PrimeField operator-() const { return {nmod_neg(residue_, modulus_), Raw{}}; }
  PrimeField& operator+=(PrimeField b) { return *this = *this + b; }
  PrimeField& operator-=(PrimeField b) { return *this = *this - b; }
  PrimeField& operator*=(PrimeField b) { return *this = *this * b; }
  PrimeField& operator/=(PrimeField b) { return *this = *this / b; }
  friend bool operator==(PrimeField a, PrimeField b) { return a.residue_ == b.residue_; }
  friend bool operator!=(PrimeField a, PrimeField b) { return a.residue_ != b.residue_; }

 private:
  struct Raw {};
  PrimeField(mp_limb_t residue, Raw) : residue_(residue) {}

  static thread_local nmod_t modulus_;
  mp_limb_t residue_ = 0;
};

inline thread_local nmod_t PrimeField::modulus_ = {0, 0, 0};

/** Where the random elements of one point come from: pure functions of (name, seed, index) and of
    what is asked for. */
class FieldSource {
 public:
  using Scalar = PrimeField;
  FieldSource(std::string name, std::uint64_t seed, std::uint64_t index)
      : name_(std::move(name)), seed_(seed), index_(index) {}

  PrimeField constant(const scene::Rational& value) const {
    return PrimeField::fromRational(value);
  }
  /// Any element of the field, all equally likely.
  PrimeField element(const std::string& what) const;
  /// ((1 - t^2)/(1 + t^2), 2 t/(1 + t^2)) with t any element: a point of c^2 + s^2 = 1. Since p = 3
  /// mod 4, -1 is no square and 1 + t^2 is never zero.
  scene::CosSin<PrimeField> circlePoint(const std::string& what) const;

 private:
  std::string name_;
  std::uint64_t seed_, index_;
};

using FieldNumbers = IndeterminateNumbers<FieldSource>;

/** A prime for the point (name, seed, index), each of those with p = 3 mod 4 between 2^62 and 2^63
    equally likely. */
std::uint64_t drawPrime(const std::string& name, std::uint64_t seed, std::uint64_t index);

/// At least this many primes are drawn from. By the prime number theorem for arithmetic
/// progressions there are close to (li(2^63) - li(2^62)) / 2 = 5.3e16.
inline constexpr double kPrimesDrawnFrom = 5e16;
inline constexpr double kSmallestPrime = 0x1p62;

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::PrimeField>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::PrimeField, 1, 2, 6> {};
}  // namespace Eigen
