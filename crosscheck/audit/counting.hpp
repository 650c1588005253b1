// SPDX-License-Identifier: GPL-3.0-or-later
// What a computation costs: a scalar that counts the operations done on it.
#pragma once

#include <string>

#include <Eigen/Core>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "recursive/spatial.hpp"

namespace dynwitness::audit {

struct Operations {
  long multiplications = 0, additions = 0, divisions = 0;  ///< additions: subtractions too

  long total() const { return multiplications + additions + divisions; }
  std::string text() const {
    return std::to_string(multiplications) + " multiplications, " + std::to_string(additions) +
           " additions, " + std::to_string(divisions) + " division" + (divisions == 1 ? "" : "s");
  }
};

/// A number that is no number: its operations are counted in Counted::operations of the thread.
/// Products with a known 0 or 1 and sums with 0 count like others; changes of sign do not.
struct Counted {
  Counted(int = 0) {}  // NOLINT(google-explicit-constructor): integers are constants
  static Operations& operations() {
    static thread_local Operations count;
    return count;
  }
  friend Counted operator+(Counted, Counted) { return ++operations().additions, Counted(); }
  friend Counted operator-(Counted, Counted) { return ++operations().additions, Counted(); }
  friend Counted operator*(Counted, Counted) { return ++operations().multiplications, Counted(); }
  friend Counted operator/(Counted, Counted) { return ++operations().divisions, Counted(); }
  Counted operator-() const { return {}; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  Counted& operator/=(Counted b) { return *this = *this / b; }
};

/** P M of a revolute joint about z, M symmetric, at the fewest operations that we know: the
    symmetric half only, and nothing for what becomes zero.
    @param with_rotor  d counts: then the last row and column, m_6j d / (d + m_66), are not zero */
template <typename T>
recursive::Matrix6<T> projectThroughZ(const recursive::Matrix6<T>& M, const T& d, bool with_rotor) {
  recursive::Matrix6<T> P_M = M;
  const T inverse_D = T(1) / (with_rotor ? d + M(5, 5) : M(5, 5));
  for (int j = 0; j < 5; ++j) {
    const T share = M(j, 5) * inverse_D;
    for (int i = 0; i <= j; ++i) P_M(i, j) = P_M(j, i) = M(i, j) - M(i, 5) * share;
    P_M(j, 5) = P_M(5, j) = with_rotor ? share * d : T(0);
  }
  P_M(5, 5) = with_rotor ? M(5, 5) * (d * inverse_D) : T(0);
  return P_M;
}

/// Operations of projectThroughZ().
inline Operations projectionCost(bool with_rotor);

}  // namespace dynwitness::audit

namespace Eigen {
template <>
struct NumTraits<dynwitness::audit::Counted>
    : dynwitness::crosscheck::EigenScalar<dynwitness::audit::Counted, 1, 1, 1> {};
}  // namespace Eigen

namespace dynwitness::audit {

inline Operations projectionCost(bool with_rotor) {
  const recursive::Matrix6<Counted> M;
  Counted::operations() = {};
  projectThroughZ<Counted>(M, Counted(), with_rotor);
  return Counted::operations();
}

}  // namespace dynwitness::audit
