// SPDX-License-Identifier: GPL-3.0-or-later
// How large the formula is that a computation evaluates: what the chance of a false "equal" rests
// on.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "crosscheck/scalars/prime_field.hpp"

namespace dynwitness::crosscheck {

/** For as long as the object lives, PrimeField bounds the rational function N / D which a
    computation makes of its indeterminates, and does not compute its values.

    N and D are polynomials with integer coefficients. Of N it bounds
      degree  the weighted degree: 1 for an element of the field, 2 for each of the coordinates c, s
              of a point of the circle (why 2: see errorProbability)
      bits    the logarithm to base 2 of the sum of the magnitudes of the coefficients
    and D it knows as a product of powers of the divisors that occurred, so that the common
    denominator of a sum is no larger than need be. A value that was divided by before is
    recognised, and what cancels for that reason cancels. Other cancellation is not seen: the bounds
    are upper bounds.

    A sweep in this scope returns, entry by entry, bounds for the formula of that entry. They are
    read in the scope.

    An element holds the place of its size in a list and the number of its operation. Few sizes
    occur, each many times: each is kept once, and what two sizes made lately is not asked for
    again. */
class FormulaSizes {
 public:
  FormulaSizes();
  ~FormulaSizes() { PrimeField::sizes_ = outer_; }
  FormulaSizes(const FormulaSizes&) = delete;
  FormulaSizes& operator=(const FormulaSizes&) = delete;

  /// An indeterminate of this weight, coefficient 1, in the innermost scope.
  static PrimeField indeterminate(double weight);

  /// Of the product of all divisors: where any of them vanishes, the computation has no value.
  double totalDegree() const { return total_degree_; }
  double totalBits() const { return total_bits_; }

 private:
  friend class PrimeField;
  struct Size {
    double degree, bits;
  };
  /// Numerator and denominator of a value.
  struct Value {
    double degree = 0, bits = 0;
    int denominator = 0;  ///< index into denominators_; 0 is 1
  };
  const Value& valueOf(PrimeField a) const { return values_[indexOf(a)]; }

  PrimeField constant(int value);
  PrimeField constant(const scene::Rational& value);
  PrimeField sum(PrimeField a, PrimeField b);
  PrimeField product(PrimeField a, PrimeField b);
  /// @throws DivisionByZero when b is the polynomial 0
  PrimeField quotient(PrimeField a, PrimeField b);

  /// (divisor, exponent > 0): formulas of 26 rates have exponents that come near the largest int.
  using Power = std::pair<int, std::int64_t>;
  using Powers = std::vector<Power>;  ///< in the order of divisors
  /// Its powers stand in powers_.
  struct Denominator {
    std::size_t begin, end;
    Size size;
  };

  /// What two denominators make, by both; of the open kind, since it is asked a hundred thousand
  /// times a mechanism.
  class OfTwo {
   public:
    /// The place for a and b, -1 where nothing is known yet: valid until the next call.
    int& operator()(int a, int b);

   private:
    struct Known {
      std::uint64_t key = kNone;
      int value = -1;
    };
    static constexpr std::uint64_t kNone = ~std::uint64_t(0);
    Known& placeOf(std::uint64_t key);
    std::vector<Known> known_ = std::vector<Known>(1 << 8);
    std::size_t count_ = 0;
  };

  // of an element's word: which size above, which operation below, from 1
  static constexpr int kOperationBits = 36;
  static constexpr std::uint64_t kOperation = (std::uint64_t(1) << kOperationBits) - 1;
  static std::uint64_t indexOf(PrimeField a) { return a.word_ >> kOperationBits; }
  static std::uint64_t operationOf(PrimeField a) { return a.word_ & kOperation; }

  PrimeField made(std::uint64_t index);  ///< the value of a new operation
  PrimeField made(double degree, double bits, int denominator) {
    return made(kept({degree, bits, denominator}));
  }
  std::uint64_t kept(const Value& value);  ///< its index
  static std::uint64_t hashOf(const Value& value);
  void growPlaces();
  Value sumOf(const Value& a, const Value& b);
  Value productOf(const Value& a, const Value& b);
  using OfSizes = Value (FormulaSizes::*)(const Value&, const Value&);
  /// The value of a new operation on two, neither of them zero, that commutes.
  template <OfSizes Make>
  PrimeField commuting(PrimeField a, PrimeField b);

  int intern(const Power* powers, std::size_t count);
  int intern(const Powers& powers) { return intern(powers.data(), powers.size()); }
  Powers powersOf(int denominator) const;
  int timesDenominator(int a, int b);
  int common(int a, int b);  ///< least common multiple
  int combined(int a, int b, bool add);
  void growIndex();
  static std::uint64_t hashOf(const Power* powers, std::size_t count);
  int newDivisor(Size size);
  int divisorOf(PrimeField value);  ///< the divisor that value's numerator is
  /// (N / E) (X / (N F)) = X / (E F), where N was divided by before. @return whether it was
  bool cancelled(PrimeField n, PrimeField x, PrimeField* out);
  bool mayDivide(PrimeField n) const {
    return may_divide_.test(operationOf(n) % may_divide_.size());
  }
  int constantDivisor(const scene::Integer& n);
  int denominatorOf(const scene::Rational& constant);

  FormulaSizes* outer_;
  std::vector<Value> values_;          ///< 0 is the size of zero
  std::vector<std::uint32_t> places_;  ///< of values_, found by hash; 0: empty
  /// What two sizes made, the last two with this hash: by the places of both.
  struct Made {
    std::uint64_t of = 0, index = 0;
  };
  std::vector<Made> made_lately_;
  std::vector<Size> divisors_;
  std::vector<Denominator> denominators_;  ///< 0 is 1
  std::vector<Power> powers_;              ///< of all denominators
  std::vector<int> index_;                 ///< of denominators, found by hash; 0: empty
  OfTwo products_, commons_;
  std::unordered_map<std::uint64_t, int> divisor_of_operation_;
  std::bitset<1 << 14> may_divide_;  ///< by the last bits of the operation
  std::map<scene::Integer, int> constants_;
  /// The last rational with this hash: its denominator, one word, and which of denominators_ it is.
  struct OfConstant {
    std::uint64_t word = 1;
    int denominator = 0;
  };
  std::array<OfConstant, 64> of_constants_;
  std::vector<Power> both_;  ///< of two denominators, while they are looked for
  std::uint64_t operations_ = 0;
  double total_degree_ = 0, total_bits_ = 0;
};

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

    @param difference  left - right, in the scope of `sizes`
    @return the chance, infinite when the field is too small to say anything */
double errorProbability(const PrimeField& difference, const FormulaSizes& sizes);

/// The fewest points at which a chance p of one point becomes at most `target`, p^k <= target, but
/// at least one. @throws std::invalid_argument unless 0 <= p < 1 and 0 < target < 1.
int pointsNeeded(double p, double target);

}  // namespace dynwitness::crosscheck
