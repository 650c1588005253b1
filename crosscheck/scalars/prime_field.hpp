// SPDX-License-Identifier: GPL-3.0-or-later
// Integers modulo a prime: arithmetic without rounding, in which two formulas are equal or not.
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>

#include <Eigen/Core>

#include <flint/nmod_vec.h>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "crosscheck/scalars/indeterminates.hpp"
#include "scene/mechanism.hpp"
#include "scene/numbers.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// A divisor was zero: the formula has no value at this point, and another one has to be drawn.
class DivisionByZero : public std::domain_error {
 public:
  using std::domain_error::domain_error;
};

class FormulaSizes;

/** The scalar of the exact checks.

    In the scope of a Modulus it is an element of the field of integers modulo a prime p below 2^63,
    through FLINT's nmod: + - * and comparison are exact, so is division by anything but zero. There
    is no order and no size: a residual is zero or it is not. Elements made under one prime mean
    nothing under another.

    In the scope of FormulaSizes it is the size of the formula that makes the element, which says
    how many random elements are enough. So both come from one code, compiled once.

    The innermost scope of the thread decides. An element is one word, passed in a register: sums
    are made in place, products apart (prime_field.cpp), since a sweep on this type is large enough
    without them. */
class PrimeField {
 public:
  /// The field that this thread computes in, for as long as the object lives.
  class Modulus {
   public:
    /// @throws std::invalid_argument unless `prime` is a prime, p = 3 mod 4 and 2^61 < p < 2^63.
    explicit Modulus(std::uint64_t prime);
    ~Modulus();
    Modulus(const Modulus&) = delete;
    Modulus& operator=(const Modulus&) = delete;

   private:
    nmod_t outer_;
    FormulaSizes* outer_sizes_;
  };
  static std::uint64_t modulus() { return modulus_.n; }
  static bool isSized() { return sizes_ != nullptr; }  ///< the innermost scope is FormulaSizes

  PrimeField() = default;  ///< zero
  PrimeField(int value);   // NOLINT(google-explicit-constructor): integers are field elements
  /// The class of an integer 0 <= residue < p.
  static PrimeField fromResidue(std::uint64_t residue) { return PrimeField(residue, Raw{}); }
  /// numerator / denominator. @throws DivisionByZero when p divides the denominator.
  static PrimeField fromRational(const scene::Rational& value);

  std::uint64_t residue() const { return word_; }
  bool isZero() const { return word_ == 0; }  ///< sized: the formula is the polynomial 0
  /// @throws DivisionByZero for zero
  PrimeField inverse() const;

  /// Sized, in that scope: the weighted degree of the numerator.
  double degree() const;
  /// Sized, in that scope: log2 of the sum of the magnitudes of the numerator's coefficients.
  double bits() const;

  friend PrimeField operator+(PrimeField a, PrimeField b) { return sum(a, b); }
  friend PrimeField operator-(PrimeField a, PrimeField b) { return difference(a, b); }
  friend PrimeField operator*(PrimeField a, PrimeField b) { return product(a, b); }
  friend PrimeField operator/(PrimeField a, PrimeField b) { return quotient(a, b); }
  PrimeField operator-() const { return isSized() ? *this : PrimeField(negated(word_), Raw{}); }
  PrimeField& operator+=(PrimeField b) { return *this = sum(*this, b); }
  PrimeField& operator-=(PrimeField b) { return *this = difference(*this, b); }
  PrimeField& operator*=(PrimeField b) { return *this = product(*this, b); }
  PrimeField& operator/=(PrimeField b) { return *this = quotient(*this, b); }
  /// Sized: the same value of the same operation.
  friend bool operator==(PrimeField a, PrimeField b) { return a.word_ == b.word_; }
  friend bool operator!=(PrimeField a, PrimeField b) { return !(a == b); }

 private:
  friend class FormulaSizes;
  struct Raw {};
  PrimeField(mp_limb_t residue, Raw) : word_(residue) {}
  static PrimeField sum(PrimeField a, PrimeField b) {
    if (__builtin_expect(isSized(), 0)) return sizedSum(a, b);
    return {_nmod_add(a.word_, b.word_, modulus_), Raw{}};
  }
  static PrimeField difference(PrimeField a, PrimeField b) {
    if (__builtin_expect(isSized(), 0)) return sizedSum(a, b);
    return {_nmod_sub(a.word_, b.word_, modulus_), Raw{}};
  }
  static PrimeField sizedSum(PrimeField a, PrimeField b);
  static PrimeField product(PrimeField a, PrimeField b);
  static PrimeField quotient(PrimeField a, PrimeField b);
  static PrimeField sizedConstant(int value);
  static std::uint64_t negated(std::uint64_t word) { return word == 0 ? 0 : modulus_.n - word; }

  static thread_local nmod_t modulus_;
  static thread_local FormulaSizes* sizes_;
  /// The residue; sized: which operation made the value, which copies keep, and how large it is
  /// (FormulaSizes).
  std::uint64_t word_ = 0;
};

inline thread_local nmod_t PrimeField::modulus_ = {0, 0, 0};
inline thread_local FormulaSizes* PrimeField::sizes_ = nullptr;

inline PrimeField::PrimeField(int value) {
  if (value == 0) return;  // of either kind
  if (isSized())
    *this = sizedConstant(value);
  else
    word_ = value > 0 ? static_cast<mp_limb_t>(value)
                      : modulus_.n - static_cast<mp_limb_t>(-static_cast<std::int64_t>(value));
}

/** Where the random elements of one point come from: pure functions of (name, seed, index) and of
    what is asked for. Sized, they are indeterminates: of weight 1, and 2 for the coordinates of a
    point of the circle. */
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

/** Gives a scene's numbers to the field (the "Numbers" concept of scene/numbers.hpp).

    Rationals stay what they are. What has no rational value becomes an indeterminate, the same one
    wherever the same number occurs: pi; the point (cos, sin) of the circle of a fixed angle that is
    no quarter turn, where a x and -x + k pi/2 share one indeterminate point; and cos and sin of the
    turns that take z to a slanted axis, where they are irrational. A formula that uses no more of
    them than c^2 + s^2 = 1 cannot tell the difference, and what holds for the indeterminates holds
    for the scene's numbers. */
class FieldNumbers {
 public:
  using Scalar = PrimeField;
  using Point = scene::CosSin<PrimeField>;

  FieldNumbers(const scene::Mechanism& mechanism, FieldSource source,
               Parameters parameters = Parameters::kAsWritten);

  PrimeField operator()(const scene::Number& number) const;
  /// The same of a number without a text.
  PrimeField rational(const scene::Rational& value) const { return source_.constant(value); }
  Point angle(const scene::Number& radians) const;
  scene::AxisTurn<PrimeField> axisTurn(const scene::Vector& axis) const;

 private:
  bool isKnown(const scene::Number& number) const;
  scene::Exact exactly(const scene::Number& number) const;
  Point pointOf(const scene::Number& radians) const;

  scene::ParameterValues values_;
  FieldSource source_;
  Parameters parameters_;
  mutable std::map<std::string, Point> points_;  ///< angles that were asked for, by their text
};

/** A state of indeterminates: joint positions as points of the circle beside an element for q
    (which is all that a component of a quaternion has), and elements for velocities, accelerations
    and forces.

    The q of a joint that follows another is  multiplier q_leader + offset;  its point is one of its
    own. No formula knows the offset but through that point (and q), and whatever the point, some
    offset leads to it: what holds for every point holds for every offset. */
scene::State<PrimeField> indeterminateState(const scene::Mechanism& mechanism,
                                            const FieldSource& source,
                                            Parameters parameters = Parameters::kAsWritten);

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
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::PrimeField, 4, 4, 6> {};
}  // namespace Eigen
