// SPDX-License-Identifier: GPL-3.0-or-later
// The derived equations as programs, one a quantity, run on any scalar.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/factorization.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"
#include "symbolic/reactions.hpp"

namespace dynwitness::crosscheck {

/** What the Lagrangian of a mechanism gives, for all arithmetics. A quantity is derived and
    compiled when it is first asked for: M takes O(n^2) operations of a chain, reactions a mechanism
    of 6 n rates, all else O(n). */
class DerivedPrograms {
 public:
  /// @param fold_parameters  see symbolic::Options
  DerivedPrograms(const scene::Mechanism& mechanism, bool fold_parameters);

  static bool answers(Quantity quantity) { return quantity != Quantity::kMomentum; }
  int dof() const { return mechanism_.dof(); }
  /// M row by row; qdd and momentum have no program.
  const symbolic::Program& operator[](Quantity quantity) const;

  // What they are compiled from, for whoever derives more of it: that adds to the graph.
  const scene::Mechanism& mechanism() const { return mechanism_; }
  const symbolic::Options& options() const { return options_; }
  symbolic::Equations& forces() const;     ///< T, V, c, g, Q
  symbolic::Equations& withMass() const;   ///< and M
  const symbolic::Reactions& cut() const;  ///< along constrainedFrames() of dense_equations.hpp

 private:
  std::vector<symbolic::Node> outputs(Quantity quantity) const;

  scene::Mechanism mechanism_;
  symbolic::Options options_;
  mutable std::optional<symbolic::Equations> equations_;
  mutable std::optional<symbolic::Reactions> cut_;
  mutable std::optional<symbolic::Program> programs_[std::size(kAllQuantities)];
};

/// The programs in one arithmetic. They must outlive it.
template <typename T>
class DerivedAnswers {
 public:
  template <typename Numbers>
  DerivedAnswers(const DerivedPrograms& programs, const Numbers& number)
      : start_([&programs, number](Quantity quantity) {
          return symbolic::ProgramRun<T>(programs[quantity], number);
        }),
        runs_(std::size(kAllQuantities)),
        dof_(programs.dof()) {}

  /// Builds every program now and not when it is first asked for: where the numbers of all are kept
  /// in one place.
  void startAll() {
    for (const Quantity quantity : kAllQuantities)
      if (DerivedPrograms::answers(quantity) && quantity != Quantity::kQdd) started(quantity);
  }

  MatrixX<T> operator()(Quantity quantity, const scene::State<T>& state) {
    if (quantity == Quantity::kM) return massMatrix(state);
    if (quantity != Quantity::kQdd) return column(run(quantity, state));
    // M qdd = tau - tau at qdd = 0
    scene::State<T> coasting = state;
    coasting.qdd.assign(state.qd.size(), T(0));
    const std::vector<T> bias = run(Quantity::kTau, coasting);
    std::vector<T> qdd = state.tau;
    for (std::size_t i = 0; i < qdd.size(); ++i) qdd[i] -= bias[i];
    MatrixX<T> M = massMatrix(state);
    recursive::factorize(M);
    recursive::solve(M, qdd);
    return column(qdd);
  }

 private:
  symbolic::ProgramRun<T>& started(Quantity quantity) {
    std::optional<symbolic::ProgramRun<T>>& run = runs_[static_cast<int>(quantity)];
    if (!run) run.emplace(start_(quantity));
    return *run;
  }
  std::vector<T> run(Quantity quantity, const scene::State<T>& state) {
    return started(quantity)(state);
  }
  MatrixX<T> massMatrix(const scene::State<T>& state) {
    const std::vector<T> entries = run(Quantity::kM, state);
    return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        entries.data(), dof_, dof_);
  }

  std::function<symbolic::ProgramRun<T>(Quantity)> start_;
  std::vector<std::optional<symbolic::ProgramRun<T>>> runs_;  ///< in the order of kAllQuantities
  int dof_;
};

}  // namespace dynwitness::crosscheck
