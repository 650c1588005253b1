// SPDX-License-Identifier: GPL-3.0-or-later
// A scalar that counts what is done on it, and a scene's numbers of it.
#pragma once

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck::kernel {

/// A double (the plan looks for zeros) whose operations are counted; changes of sign are free.
struct Counted {
  double value = 0;

  Counted() = default;
  Counted(double x) : value(x) {}  // NOLINT(google-explicit-constructor): numbers are constants
  bool isZero() const { return value == 0; }

  inline static thread_local long operations = 0;
  static Counted counted(double x) {
    ++operations;
    return {x};
  }
  friend Counted operator+(Counted a, Counted b) { return counted(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return counted(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return counted(a.value * b.value); }
  friend Counted operator/(Counted a, Counted b) { return counted(a.value / b.value); }
  Counted operator-() const { return {-value}; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  Counted& operator/=(Counted b) { return *this = *this / b; }
  friend bool operator==(Counted a, Counted b) { return a.value == b.value; }
  friend bool operator!=(Counted a, Counted b) { return a.value != b.value; }
};

/// A scene's numbers in double.
class CountedNumbers {
 public:
  using Scalar = Counted;
  explicit CountedNumbers(const scene::Mechanism& mechanism) : numbers_(mechanism) {}
  Counted operator()(const scene::Number& number) const { return {numbers_(number)}; }
  scene::CosSin<Counted> angle(const scene::Number& radians) const {
    return of(numbers_.angle(radians));
  }
  scene::AxisTurn<Counted> axisTurn(const scene::Vector& axis) const {
    const scene::AxisTurn<double> turn = numbers_.axisTurn(axis);
    return {of(turn.alpha), of(turn.beta)};
  }

 private:
  static scene::CosSin<Counted> of(const scene::CosSin<double>& x) { return {{x.c}, {x.s}}; }
  scene::RealNumbers<double> numbers_;
};

}  // namespace dynwitness::crosscheck::kernel

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::kernel::Counted>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::kernel::Counted, 1, 1, 1> {};
}  // namespace Eigen
