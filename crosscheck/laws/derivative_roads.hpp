// SPDX-License-Identifier: GPL-3.0-or-later
// The derivatives of a tree's equations of motion by four roads that share no formula of
// differentiation.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/laws/compiled_identities.hpp"
#include "crosscheck/witnesses/fast_derivatives.hpp"
#include "crosscheck/witnesses/lagrange_derivatives.hpp"

namespace dynwitness::crosscheck {

/// n x n each; of qdd at the qdd of the state, which its tau makes. The names are those of
/// `evaluate` (motion/derivative_quantities.hpp), and dtau_dqdd for what is M.
enum class Derivative { kTauByQ, kTauByQd, kTauByQdd, kQddByQ, kQddByQd, kQddByTau };
inline constexpr std::array<Derivative, 6> kDerivatives = {
    Derivative::kTauByQ, Derivative::kTauByQd, Derivative::kTauByQdd,
    Derivative::kQddByQ, Derivative::kQddByQd, Derivative::kQddByTau};
inline const char* name(Derivative quantity) {
  constexpr const char* kNames[] = {"dtau_dq", "dtau_dqd", "dtau_dqdd",
                                    "dqdd_dq", "dqdd_dqd", "dqdd_dtau"};
  return kNames[static_cast<int>(quantity)];
}
inline bool isOfForces(Derivative quantity) {
  return quantity <= Derivative::kTauByQdd;
}

/** Who differentiates:
      lagrange      T and V once more (LagrangeDerivatives), and its own M solved with
      dual_numbers  the sweeps on dual numbers: Newton and Euler for tau, articulated bodies for qdd
      derivatives   the textbook's sweeps (recursive/derivatives.hpp)
      fast          the sweeps made for speed (recursive/fast/derivatives.hpp)
    The first two along one direction, that of SweptMechanism::anyDirection(); the last two have
    every entry. */
enum class DerivativeRoad { kLagrange, kDualNumbers, kTextbook, kFast };
inline const char* name(DerivativeRoad road) {
  constexpr const char* kNames[] = {"lagrange", "dual_numbers", "derivatives", "fast"};
  return kNames[static_cast<int>(road)];
}

/// Why the fast road does not go there; empty: it does.
inline std::string whyNoFastDerivatives(const scene::Mechanism& mechanism) {
  return mechanism.hasCoupledRates()
             ? "the fast derivatives are those of trees whose joints all have rates of their own: "
               "here joints follow others, or rotors are geared to several rates"
             : "";
}

/// A quantity by two roads.
struct DerivativePair {
  Derivative quantity;
  DerivativeRoad left, right;
};
inline std::vector<DerivativePair> derivativePairs(const scene::Mechanism& mechanism) {
  const int roads = whyNoFastDerivatives(mechanism).empty() ? 4 : 3;
  std::vector<DerivativePair> pairs;
  for (const Derivative quantity : kDerivatives)
    for (int a = 0; a < roads; ++a)
      for (int b = a + 1; b < roads; ++b)
        pairs.push_back({quantity, static_cast<DerivativeRoad>(a), static_cast<DerivativeRoad>(b)});
  return pairs;
}

/// One mechanism in the arithmetic of T, moved from state to state; each road is gone once a state.
template <typename T>
class DerivativeRoads {
 public:
  /// @param programs  must outlive it
  template <typename Numbers>
  DerivativeRoads(const scene::Mechanism& mechanism, const LagrangeDerivatives& programs,
                  const Numbers& number)
      : swept_(mechanism, number), lagrange_(programs, number) {
    if (whyNoFastDerivatives(mechanism).empty()) fast_.emplace(swept_.model());
  }

  /// To this state; its tau is any direction.
  DerivativeRoads& at(scene::State<T> state) {
    swept_.at(std::move(state));
    said_.clear();
    return *this;
  }
  /// Entry by entry where both roads have entries, along the direction else.
  TwoSides<T> sides(const DerivativePair& pair) {
    const Said &left = hear(pair.quantity, pair.left), &right = hear(pair.quantity, pair.right);
    const std::string& failure = left.failure.empty() ? right.failure : left.failure;
    if (!failure.empty()) return {{}, {}, failure};
    if (left.is_whole && right.is_whole) return {left.value, right.value};
    return {along(left), along(right)};
  }
  /// All entries, by the textbook's sweeps.
  MatrixX<T> whole(Derivative quantity) { return hear(quantity, DerivativeRoad::kTextbook).value; }

 private:
  /// What a road says of a quantity: the matrix, or what it makes of the direction.
  struct Said {
    MatrixX<T> value;
    bool is_whole = false;
    std::string failure = {};
  };
  using Roads = std::map<std::pair<Derivative, DerivativeRoad>, Said>;

  MatrixX<T> u() const { return swept_.column(swept_.anyDirection()); }
  MatrixX<T> along(const Said& said) const {
    return said.is_whole ? MatrixX<T>(said.value * u()) : said.value;
  }
  const Said& hear(Derivative quantity, DerivativeRoad road) {
    const auto it = said_.find({quantity, road});
    if (it != said_.end()) return it->second;
    Said said;
    try {
      said = ask(quantity, road);
    } catch (const std::domain_error& error) {
      said.failure = error.what();
    }
    return said_[{quantity, road}] = std::move(said);
  }
  Said ask(Derivative quantity, DerivativeRoad road) {
    switch (road) {
      case DerivativeRoad::kLagrange:
        return {byLagrange(quantity)};
      case DerivativeRoad::kDualNumbers:
        return {byDuals(quantity)};
      case DerivativeRoad::kTextbook:
        return {byTextbook(quantity), true};
      case DerivativeRoad::kFast:
        return {byFast(quantity), true};
    }
    return {};
  }

  MatrixX<T> byLagrange(Derivative quantity);
  MatrixX<T> byDuals(Derivative quantity);
  MatrixX<T> byTextbook(Derivative quantity);
  MatrixX<T> byFast(Derivative quantity);

  SweptMechanism<T> swept_;
  LagrangeDerivativesRun<T> lagrange_;
  std::optional<FastDerivatives<T>> fast_;
  Roads said_;
};

template <typename T>
MatrixX<T> DerivativeRoads<T>::byLagrange(Derivative quantity) {
  if (isOfForces(quantity)) {
    // asked once for the three
    const MatrixX<T> all = lagrange_.ofForces(swept_.state());
    for (int k = 0; k < 3; ++k)
      said_[{static_cast<Derivative>(k), DerivativeRoad::kLagrange}] = {all.col(k)};
    return all.col(static_cast<int>(quantity));
  }
  // -M x = d tau along u by q or qd, M x = u by tau
  MatrixX<T> M = lagrange_.M(swept_.state());
  recursive::factorize(M);
  const auto solved = [&](MatrixX<T> x) {
    Eigen::Ref<Eigen::Matrix<T, Eigen::Dynamic, 1>> b = x.col(0);
    recursive::solve(M, b);
    return x;
  };
  const MatrixX<T> x[] = {solved(-hear(Derivative::kTauByQ, DerivativeRoad::kLagrange).value),
                          solved(-hear(Derivative::kTauByQd, DerivativeRoad::kLagrange).value),
                          solved(u())};
  for (int k = 0; k < 3; ++k)
    said_[{static_cast<Derivative>(3 + k), DerivativeRoad::kLagrange}] = {x[k]};
  return x[static_cast<int>(quantity) - 3];
}

template <typename T>
MatrixX<T> DerivativeRoads<T>::byDuals(Derivative quantity) {
  const std::vector<T>& u = swept_.anyDirection();
  switch (quantity) {
    case Derivative::kTauByQ:
      return swept_.tauRate({u, {}, {}, {}});
    case Derivative::kTauByQd:
      return swept_.tauRate({{}, u, {}, {}});
    case Derivative::kTauByQdd:
      return swept_.tauRate({{}, {}, u, {}});
    case Derivative::kQddByQ:
      return swept_.qddRate({u, {}, {}, {}});
    case Derivative::kQddByQd:
      return swept_.qddRate({{}, u, {}, {}});
    case Derivative::kQddByTau:
      return swept_.qddRate({{}, {}, {}, u});
  }
  return {};
}

template <typename T>
MatrixX<T> DerivativeRoads<T>::byTextbook(Derivative quantity) {
  switch (quantity) {
    case Derivative::kTauByQ:
      return swept_.ofInverse().dtau_dq;
    case Derivative::kTauByQd:
      return swept_.ofInverse().dtau_dqd;
    case Derivative::kTauByQdd:
      return swept_.ofInverse().M;
    case Derivative::kQddByQ:
      return swept_.ofForward().dqdd_dq;
    case Derivative::kQddByQd:
      return swept_.ofForward().dqdd_dqd;
    case Derivative::kQddByTau:
      return swept_.ofForward().dqdd_dtau;
  }
  return {};
}

template <typename T>
MatrixX<T> DerivativeRoads<T>::byFast(Derivative quantity) {
  const int first = isOfForces(quantity) ? 0 : 3;
  auto all = first == 0 ? fast_->ofForces(swept_.state()) : fast_->ofAccelerations(swept_.state());
  const recursive::RowsX<T>* const matrices[] = {&all.by_q, &all.by_qd, &all.by_last};
  for (int k = 0; k < 3; ++k)
    said_[{static_cast<Derivative>(first + k), DerivativeRoad::kFast}] = {*matrices[k], true};
  return *matrices[static_cast<int>(quantity) - first];
}

}  // namespace dynwitness::crosscheck
