// SPDX-License-Identifier: GPL-3.0-or-later
// Closures for duals: what it takes to differentiate their equations.
#pragma once

#include "crosscheck/scalars/dual.hpp"
#include "recursive/constraints.hpp"

namespace dynwitness::crosscheck {

/// The same closures in a scalar S made from T (duals, nested duals): their numbers are constants.
template <typename S, typename T>
recursive::Constraints<S> lifted(const recursive::Constraints<T>& constraints, int dof) {
  const auto transform = [](const recursive::Transform<T>& X) {
    recursive::Transform<S> out;
    for (int i = 0; i < 3; ++i) {
      out.p(i) = S(X.p(i));
      for (int j = 0; j < 3; ++j) out.R(i, j) = S(X.R(i, j));
    }
    return out;
  };
  recursive::Constraints<S> out;
  for (const recursive::Closure<T>& c : constraints.closures)
    out.closures.push_back(
        {c.kind, c.a, c.b, transform(c.X_A), transform(c.X_B), c.row, S(c.length)});
  out.phi = recursive::VectorX<S>::Constant(constraints.rows(), S(T(0)));
  out.gamma = out.phi;
  out.J = recursive::MatrixX<S>::Constant(constraints.rows(), dof, S(T(0)));
  out.X_W.assign(constraints.X_W.size(), recursive::Transform<S>::identity());
  out.chain = constraints.chain;
  return out;
}

}  // namespace dynwitness::crosscheck
