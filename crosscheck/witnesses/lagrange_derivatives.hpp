// SPDX-License-Identifier: GPL-3.0-or-later
// The Lagrangian's own derivatives of the equations of motion, as programs, run on any scalar.
#pragma once

#include <vector>

#include "crosscheck/witnesses/bounded_answer.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {

/** What differentiating tau(q, qd, qdd) of Lagrange's equations once more gives, along one
    direction u, which a program reads in the place of the state's tau [one number a rate]:

        forces   (dtau/dq) u, then (dtau/dqd) u, then (dtau/dqdd) u, by forward mode
        momenta  d(dT/dqd) along u = M u

    3 n and n outputs, O(n) operations of a chain. Along q positions move as at the rates u: where
    rates are no derivatives of coordinates (spherical, floating), along the body's axes. */
struct LagrangeDerivatives {
  /// @param fold_parameters  see symbolic::Options
  LagrangeDerivatives(const scene::Mechanism& mechanism, bool fold_parameters);
  /// Adds to the graph of what was derived already.
  explicit LagrangeDerivatives(symbolic::Equations& equations);

  symbolic::Program forces, momenta;
  int dof;
};

/// Both on numbers. The programs must outlive it.
template <typename T>
class LagrangeDerivativesRun {
 public:
  template <typename Numbers>
  LagrangeDerivativesRun(const LagrangeDerivatives& programs, const Numbers& number)
      : forces_(programs.forces, number), momenta_(programs.momenta, number), dof_(programs.dof) {}

  /// n x 3, a column each by q, qd and qdd. @param state  with u for tau
  MatrixX<T> ofForces(const scene::State<T>& state) {
    return Eigen::Map<const MatrixX<T>>(forces_(state).data(), dof_, 3);
  }
  /// M, one column at a time.
  MatrixX<T> M(scene::State<T> state) {
    MatrixX<T> out(dof_, dof_);
    state.tau.assign(static_cast<std::size_t>(dof_), T(0));
    for (int k = 0; k < dof_; ++k) {
      state.tau[static_cast<std::size_t>(k)] = T(1);
      out.col(k) = column(momenta_(state));
      state.tau[static_cast<std::size_t>(k)] = T(0);
    }
    return out;
  }

 private:
  symbolic::ProgramRun<T> forces_, momenta_;
  int dof_;
};

}  // namespace dynwitness::crosscheck
