// SPDX-License-Identifier: GPL-3.0-or-later
// The derived equations as programs, one a quantity, run on any scalar.
#pragma once

#include <vector>

#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/factorization.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {

/// What the Lagrangian of a mechanism gives, compiled once for all arithmetics.
class DerivedPrograms {
 public:
  /// @param fold_parameters  see symbolic::Options
  DerivedPrograms(const scene::Mechanism& mechanism, bool fold_parameters);

  static bool answers(Quantity quantity) { return quantity != Quantity::kMomentum; }
  int dof() const { return dof_; }
  /// M row by row; qdd and momentum have no program.
  const symbolic::Program& operator[](Quantity quantity) const {
    return programs_[static_cast<int>(quantity)];
  }

 private:
  symbolic::Program programs_[std::size(kAllQuantities)];
  int dof_ = 0;
};

/// The programs in one arithmetic. They must outlive it.
template <typename T>
class DerivedAnswers {
 public:
  template <typename Numbers>
  DerivedAnswers(const DerivedPrograms& programs, const Numbers& number) : dof_(programs.dof()) {
    for (const Quantity quantity : kAllQuantities) runs_.emplace_back(programs[quantity], number);
  }

  MatrixOf<T> operator()(Quantity quantity, const scene::State<T>& state) {
    if (quantity == Quantity::kM) return massMatrix(state);
    if (quantity != Quantity::kQdd) return column(run(quantity, state));
    // M qdd = tau - tau at qdd = 0
    scene::State<T> coasting = state;
    coasting.qdd.assign(state.qd.size(), T(0));
    const std::vector<T> bias = run(Quantity::kTau, coasting);
    std::vector<T> qdd = state.tau;
    for (std::size_t i = 0; i < qdd.size(); ++i) qdd[i] -= bias[i];
    MatrixOf<T> M = massMatrix(state);
    recursive::factorize(M);
    recursive::solve(M, qdd);
    return column(qdd);
  }

 private:
  std::vector<T> run(Quantity quantity, const scene::State<T>& state) {
    return runs_[static_cast<int>(quantity)](state);
  }
  MatrixOf<T> massMatrix(const scene::State<T>& state) {
    const std::vector<T> entries = run(Quantity::kM, state);
    return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        entries.data(), dof_, dof_);
  }

  std::vector<symbolic::ProgramRun<T>> runs_;  ///< in the order of kAllQuantities
  int dof_;
};

}  // namespace dynwitness::crosscheck
