// SPDX-License-Identifier: GPL-3.0-or-later
// The formulas of our own roads to a whole mechanism (mechanism_roads.hpp), in any scalar. Compiled
// once a scalar: mechanism_formulas_*.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/dense_equations.hpp"
#include "crosscheck/witnesses/mechanism_roads.hpp"
#include "recursive/hybrid_dynamics.hpp"

namespace dynwitness::crosscheck {

template <typename T>
using PartsOf = std::array<VectorX<T>, std::size(kMechanismQuantities)>;

template <typename T>
VectorX<T>& part(PartsOf<T>& parts, MechanismQuantity quantity) {
  return parts[static_cast<std::size_t>(quantity)];
}

/// Of the rates that drives give.
template <typename T>
VectorX<T> ofDriven(const std::vector<char>& driven, const VectorX<T>& all) {
  VectorX<T> out(std::count(driven.begin(), driven.end(), 1));
  for (std::size_t i = 0, k = 0; i < driven.size(); ++i)
    if (driven[i]) out(static_cast<Eigen::Index>(k++)) = all(static_cast<Eigen::Index>(i));
  return out;
}

/// The dense system of a whole mechanism, solved for the rows that stand for all.
template <typename T>
struct Solved {
  Solved(DenseEquations<T> e, const scene::Mechanism& mechanism, const MechanismState& at,
         const scene::State<T>& state)
      : forces(VectorX<T>::Constant(e.J.rows(), T(0))) {
    const int k = static_cast<int>(mechanism.acceleration_constraints.size()),
              m = static_cast<int>(e.J.rows()) - k;
    std::vector<int> rows = at.rows;
    for (int i = 0; i < k; ++i) rows.push_back(m + i);
    keepRows(rows, e);
    const std::vector<char> driven = recursive::drivenRates(mechanism);
    const DenseSolution<T> x = solveDense(e, driven, state.tau, state.qdd);
    const int chosen = static_cast<int>(at.rows.size());
    qdd = x.qdd;
    for (std::size_t i = 0; i < rows.size(); ++i)
      forces(rows[i]) = x.nu(static_cast<Eigen::Index>(i));
    part(parts, MechanismQuantity::kQdd) = x.qdd;
    part(parts, MechanismQuantity::kConstraintForce) = e.J.transpose() * x.nu;
    if (!at.is_redundant) part(parts, MechanismQuantity::kLambda) = x.nu.head(chosen);
    part(parts, MechanismQuantity::kNu) = x.nu.tail(k);
    part(parts, MechanismQuantity::kDrive) = ofDriven(driven, x.tau);
  }
  PartsOf<T> parts;        ///< without reactions
  VectorX<T> qdd, forces;  ///< n; of all equations, 0 of those that others stand for
};

/// @throws std::invalid_argument  joints follow others, and these sweeps solve for each where they
///   pass it
void requireOwnRates(const scene::Mechanism& mechanism);

struct LagrangeMultipliers {
  static constexpr const char* kName = "lagrange_multipliers";
  explicit LagrangeMultipliers(const scene::Mechanism& mechanism)
      : derived(std::make_shared<DerivedConstraints>(mechanism, true, true)),
        cut(std::make_shared<DerivedReactions>(mechanism, true)) {}

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const;
  std::shared_ptr<const DerivedConstraints> derived;
  std::shared_ptr<const DerivedReactions> cut;
};

struct DenseSystem {
  static constexpr const char* kName = "dense_system";
  explicit DenseSystem(const scene::Mechanism& mechanism) {
    if (!mechanism.hasMimics()) cut = symbolic::freed(mechanism);
  }

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const;
  /// None where joints follow others: no sweep that solves holds these, and lagrange_multipliers
  /// would be compared with its own cuts alone.
  std::optional<symbolic::Freed> cut;
};

struct LoopsEliminated {
  static constexpr const char* kName = "loops_eliminated";
  explicit LoopsEliminated(const scene::Mechanism& mechanism) {
    requireOwnRates(mechanism);
    if (!mechanism.acceleration_constraints.empty())
      throw std::invalid_argument("no sweep eliminates loops under acceleration constraints");
  }

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const;
};

struct HybridSweep {
  static constexpr const char* kName = "hybrid_sweep";
  explicit HybridSweep(const scene::Mechanism& mechanism) { requireOwnRates(mechanism); }

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState&, const scene::State<T>& state) const;
};

// NOLINTBEGIN(bugprone-macro-parentheses) PREFIX extern: compiled elsewhere; empty: here
#define DYNWITNESS_FORMULAS(PREFIX, FORMULAS, NUMBERS)                                     \
  PREFIX template PartsOf<NUMBERS::Scalar> FORMULAS::operator()<NUMBERS, NUMBERS::Scalar>( \
      const scene::Mechanism&, const NUMBERS&, const MechanismState&,                      \
      const scene::State<NUMBERS::Scalar>&) const
// NOLINTEND(bugprone-macro-parentheses)

DYNWITNESS_FORMULAS(extern, LagrangeMultipliers, scene::RealNumbers<double>);
DYNWITNESS_FORMULAS(extern, DenseSystem, scene::RealNumbers<double>);
DYNWITNESS_FORMULAS(extern, LoopsEliminated, scene::RealNumbers<double>);
DYNWITNESS_FORMULAS(extern, HybridSweep, scene::RealNumbers<double>);
DYNWITNESS_FORMULAS(extern, LagrangeMultipliers, AdjointErrorNumbers);
DYNWITNESS_FORMULAS(extern, DenseSystem, AdjointErrorNumbers);
DYNWITNESS_FORMULAS(extern, LoopsEliminated, AdjointErrorNumbers);
DYNWITNESS_FORMULAS(extern, HybridSweep, AdjointErrorNumbers);
DYNWITNESS_FORMULAS(extern, LagrangeMultipliers, BallNumbers);

}  // namespace dynwitness::crosscheck
