// SPDX-License-Identifier: Apache-2.0
// What the multipliers of a closure exert on the two links that it joins.
#pragma once

#include "recursive/constraints.hpp"

namespace dynwitness::recursive {

/** The wrenches of a closure's unit multipliers, from how its equations see unit motions of B on A
    (closureRates): their power is lambda' J qd.
    @param constraints  constraintEquations() has run for this state
    @param use  (row of the closure, on_a, on_b), each in its link's axes about its origin; of the
      world: zero */
template <typename T, typename Use>
void closureWrenches(const Constraints<T>& constraints, const Closure<T>& closure, Use&& use) {
  const int a = closure.a, b = closure.b, rows = scene::equationCount(closure.kind);
  const Transform<T> X_AW = a < 0 ? closure.X_A : closure.X_A * constraints.X_W[a];
  const Transform<T> X_BW = b < 0 ? closure.X_B : closure.X_B * constraints.X_W[b];
  const Transform<T> X_BA = X_BW * X_AW.inverse();
  MatrixX<T> w(6, rows);
  for (int k = 0; k < 6; ++k) {
    Motion<T> unit = Motion<T>::zero();
    (k < 3 ? unit.linear(k) : unit.angular(k - 3)) = T(1);
    detail::closureRates(closure, unit, X_BA, [&](int row, const T& rate) { w(k, row) = rate; });
  }
  for (int row = 0; row < rows; ++row) {
    const Force<T> in_A = {w.col(row).template head<3>(), w.col(row).template tail<3>()};
    use(row, a < 0 ? Force<T>::zero() : closure.X_A.inverseTimes(in_A * T(-1)),
        b < 0 ? Force<T>::zero() : closure.X_B.inverseTimes(X_BA * in_A));
  }
}

}  // namespace dynwitness::recursive
