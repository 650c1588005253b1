// SPDX-License-Identifier: GPL-3.0-or-later
// The field with one operation that goes wrong, and the identities over it: compiled in files of
// their own (faulty_field_*.cpp), as those over the field are.
#pragma once

#include "crosscheck/laws/compiled_identities.hpp"
#include "crosscheck/scalars/eigen_scalar.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "recursive/compiled_sweeps.hpp"

namespace dynwitness::fixtures {

using crosscheck::FieldNumbers;
using crosscheck::PrimeField;

/// An element of the field whose arithmetic fails once: the result of operation number `wrong` is
/// one more.
class Faulty {
 public:
  static inline long done = 0, wrong = -1;

  Faulty() = default;
  Faulty(int value) : x_(value) {}  // NOLINT(google-explicit-constructor): as for the field
  Faulty(PrimeField x) : x_(x) {}   // NOLINT(google-explicit-constructor)
  PrimeField inner() const { return x_; }

  friend Faulty operator+(Faulty a, Faulty b) { return after(a.x_ + b.x_); }
  friend Faulty operator-(Faulty a, Faulty b) { return after(a.x_ - b.x_); }
  friend Faulty operator*(Faulty a, Faulty b) { return after(a.x_ * b.x_); }
  friend Faulty operator/(Faulty a, Faulty b) { return after(a.x_ / b.x_); }
  Faulty operator-() const { return Faulty(-x_); }
  Faulty& operator+=(Faulty b) { return *this = *this + b; }
  Faulty& operator-=(Faulty b) { return *this = *this - b; }
  Faulty& operator*=(Faulty b) { return *this = *this * b; }
  Faulty& operator/=(Faulty b) { return *this = *this / b; }
  friend bool operator==(Faulty a, Faulty b) { return a.x_ == b.x_; }
  friend bool operator!=(Faulty a, Faulty b) { return a.x_ != b.x_; }

 private:
  static Faulty after(PrimeField x) {
    return done++ == wrong ? Faulty(x + PrimeField(1)) : Faulty(x);
  }
  PrimeField x_;
};

/// The scene's numbers for it.
class FaultyNumbers {
 public:
  using Scalar = Faulty;
  explicit FaultyNumbers(const FieldNumbers& inner) : inner_(inner) {}
  Scalar operator()(const scene::Number& number) const { return inner_(number); }
  scene::CosSin<Scalar> angle(const scene::Number& radians) const {
    return lifted(inner_.angle(radians));
  }
  scene::AxisTurn<Scalar> axisTurn(const scene::Vector& axis) const {
    const auto turn = inner_.axisTurn(axis);
    return {lifted(turn.alpha), lifted(turn.beta)};
  }

 private:
  static scene::CosSin<Scalar> lifted(const scene::CosSin<PrimeField>& p) { return {p.c, p.s}; }
  const FieldNumbers& inner_;
};

}  // namespace dynwitness::fixtures

namespace Eigen {
template <>
struct NumTraits<dynwitness::fixtures::Faulty>
    : dynwitness::crosscheck::EigenScalar<dynwitness::fixtures::Faulty, 1, 2, 6> {};
}  // namespace Eigen

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(extern, fixtures::Faulty);
DYNWITNESS_MODELS(extern, fixtures::Faulty, fixtures::FaultyNumbers);

}  // namespace dynwitness::recursive

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(extern, fixtures::Faulty, fixtures::FaultyNumbers);
DYNWITNESS_IDENTITIES(extern, fixtures::Faulty);

}  // namespace dynwitness::crosscheck
