// SPDX-License-Identifier: GPL-3.0-or-later
// A scalar that counts what is done with it.
#pragma once

#include <Eigen/Core>

namespace dynwitness::audit {

/// A number without a value. Every + - * / of two of them counts one, whatever the operands.
struct Counted {
  static inline thread_local long operations = 0;
  Counted() = default;
  Counted(int) {}  // NOLINT(google-explicit-constructor): constants cost nothing

  static Counted one() { return ++operations, Counted(); }
  friend Counted operator+(Counted, Counted) { return one(); }
  friend Counted operator-(Counted, Counted) { return one(); }
  friend Counted operator*(Counted, Counted) { return one(); }
  friend Counted operator/(Counted, Counted) { return one(); }
  Counted operator-() const { return {}; }
  Counted& operator+=(Counted) { return one(), *this; }
  Counted& operator-=(Counted) { return one(), *this; }
  Counted& operator*=(Counted) { return one(), *this; }
  Counted& operator/=(Counted) { return one(), *this; }
};

}  // namespace dynwitness::audit

namespace Eigen {
template <>
struct NumTraits<dynwitness::audit::Counted> : GenericNumTraits<double> {
  using Real = dynwitness::audit::Counted;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1, ReadCost = 1,
         AddCost = 1, MulCost = 1 };
};
}  // namespace Eigen
