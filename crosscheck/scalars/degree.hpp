// SPDX-License-Identifier: GPL-3.0-or-later
// How large the formula is that a computation evaluates: what the chance of a false "equal" rests
// on.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <map>

#include <Eigen/Core>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "crosscheck/scalars/indeterminates.hpp"

namespace dynwitness::crosscheck {

/** A scalar that bounds the rational function N / D which a computation makes of its
    indeterminates.

    N and D are polynomials with integer coefficients. Of N the scalar bounds
      degree  the weighted degree: 1 for an element of the field, 2 for each of the coordinates c, s
      of
              a point of the circle (why 2: see errorProbability)
      bits    the logarithm to base 2 of the sum of the magnitudes of the coefficients
    and D it knows as a product of powers of the divisors that occurred, so that the common
    denominator of a sum is no larger than need be. A value that was divided by before is
    recognised, and what cancels for that reason cancels. Other cancellation is not seen: the bounds
    are upper bounds.

    A sweep on this type returns, entry by entry, bounds for the formula of that entry.

    All values live in the innermost Divisors of the thread. */
class DegreeBound {
 public:
  /// The divisors of one computation.
  class Divisors {
   public:
    Divisors();
    ~Divisors() { current_ = outer_; }
    Divisors(const Divisors&) = delete;
    Divisors& operator=(const Divisors&) = delete;

    /// Of the product of all divisors: where any of them vanishes, the computation has no value.
    double totalDegree() const { return total_degree_; }
    double totalBits() const { return total_bits_; }

   private:
    friend class DegreeBound;
    using Powers = std::vector<std::pair<int, int>>;  ///< (divisor, exponent > 0), in order
    struct Size {
      double degree, bits;
    };
    struct Denominator {
      Powers powers;
      Size size;
    };

    int intern(const Powers& powers);
    int product(int a, int b);
    int common(int a, int b);  ///< least common multiple
    int combined(int a, int b, bool add);
    int newDivisor(Size size);
    int divisorOf(const DegreeBound& value);  ///< the divisor that value's numerator is
    int constantDivisor(const scene::Integer& n);

    Divisors* outer_;
    std::vector<Size> divisors_;
    std::vector<Denominator> denominators_;
    std::map<Powers, int> index_;
    std::unordered_map<std::uint64_t, int> products_, commons_;
    std::unordered_map<std::uint64_t, int> divisor_of_serial_;
    std::map<scene::Integer, int> constants_;
    std::uint64_t serial_ = 0;
    double total_degree_ = 0, total_bits_ = 0;
  };

  DegreeBound() = default;  ///< zero
  DegreeBound(int value);   // NOLINT(google-explicit-constructor): integers are constants
  static DegreeBound constant(const scene::Rational& value);
  /// An indeterminate of this weight, coefficient 1.
  static DegreeBound indeterminate(double weight);

  bool isZero() const { return serial_ == 0; }  ///< the polynomial 0
  double degree() const { return degree_; }     ///< of the numerator
  double bits() const { return bits_; }         ///< of the numerator

  friend DegreeBound operator+(const DegreeBound& a, const DegreeBound& b) { return sum(a, b); }
  friend DegreeBound operator-(const DegreeBound& a, const DegreeBound& b) { return sum(a, b); }
  friend DegreeBound operator*(const DegreeBound& a, const DegreeBound& b) { return product(a, b); }
  /// @throws DivisionByZero when b is the polynomial 0
  friend DegreeBound operator/(const DegreeBound& a, const DegreeBound& b) {
    return quotient(a, b);
  }
  DegreeBound operator-() const { return *this; }
  DegreeBound& operator+=(const DegreeBound& b) { return *this = *this + b; }
  DegreeBound& operator-=(const DegreeBound& b) { return *this = *this - b; }
  DegreeBound& operator*=(const DegreeBound& b) { return *this = *this * b; }
  DegreeBound& operator/=(const DegreeBound& b) { return *this = *this / b; }
  /// The same value of the same operation: Eigen compares with 0.
  friend bool operator==(const DegreeBound& a, const DegreeBound& b) {
    return a.serial_ == b.serial_;
  }
  friend bool operator!=(const DegreeBound& a, const DegreeBound& b) { return !(a == b); }

 private:
  DegreeBound(double degree, double bits, int denominator);
  static DegreeBound sum(const DegreeBound& a, const DegreeBound& b);
  static DegreeBound product(const DegreeBound& a, const DegreeBound& b);
  static DegreeBound quotient(const DegreeBound& a, const DegreeBound& b);

  static thread_local Divisors* current_;
  double degree_ = 0, bits_ = 0;
  int denominator_ = 0;       ///< index into the denominators; 0 is 1
  std::uint64_t serial_ = 0;  ///< the operation that made the value; copies keep it; 0 is zero
};

/// Indeterminates and constants as degree bounds, in the place of FieldSource.
struct DegreeSource {
  using Scalar = DegreeBound;
  DegreeBound constant(const scene::Rational& value) const { return DegreeBound::constant(value); }
  DegreeBound element(const std::string&) const { return DegreeBound::indeterminate(1); }
  scene::CosSin<DegreeBound> circlePoint(const std::string&) const {
    return {DegreeBound::indeterminate(2), DegreeBound::indeterminate(2)};
  }
};

using DegreeNumbers = IndeterminateNumbers<DegreeSource>;

/** Chance that a difference which is not zero as a formula is zero at one random point.

    Let the difference be N / D with N not zero: a polynomial with integer coefficients in elements
    x_i and in points (c_j, s_j) of circles, up to c_j^2 + s_j^2 = 1. A point is a random prime p
    and, modulo p, random x_i and random t_j with c_j = (1 - t_j^2)/(1 + t_j^2), s_j = 2 t_j/(1 +
    t_j^2).

    (1) The prime. Write N without squares of s_j; each of the at most degree/4 replacements
        s^2 = 1 - c^2 at most doubles the sum of coefficients. Some coefficient is then not zero and
        below 2^(bits + degree/4), so fewer than (bits + degree/4)/62 of the primes above 2^62
        divide it, out of kPrimesDrawnFrom. For all other primes N is not zero modulo p.
    (2) The point. With z_j = c_j + i s_j and i^2 = -1 (p = 3 mod 4: a field with p^2 elements),
        N is a Laurent polynomial in z_j, a monomial of degree k in c_j and s_j going from z_j^-k to
        z_j^k. Take one variable after the other, as for the lemma of Schwartz and Zippel: let k be
        the largest exponent of z_1 or 1/z_1 in N; its coefficient has a weighted degree smaller by
        at least 2 k, and where it does not vanish, at most 2 k values of z_1 are zeros. So N
        vanishes at no more than the share degree / p of all points: each t gives another z.
    (3) Points where a divisor vanishes are drawn again. By (1) and (2) for the product of all
        divisors that is the share r of all points, and what is left is larger by 1 / (1 - r).

    @param difference  left - right
    @return the chance, infinite when the field is too small to say anything */
double errorProbability(const DegreeBound& difference, const DegreeBound::Divisors& divisors);

/// The fewest points at which a chance p of one point becomes at most `target`, p^k <= target, but
/// at least one. @throws std::invalid_argument unless 0 <= p < 1 and 0 < target < 1.
int pointsNeeded(double p, double target);

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::DegreeBound>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::DegreeBound, 4, 10, 10> {};
}  // namespace Eigen
