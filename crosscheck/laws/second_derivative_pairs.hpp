// SPDX-License-Identifier: GPL-3.0-or-later
// Which second derivatives of the equations of motion are asked about, and of whom.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/// n x n x n each (recursive/second_derivatives.hpp); of qdd at the qdd of the state, which its tau
/// makes. The names are those of `evaluate`.
enum class SecondDerivative {
  kTauByQQ,
  kTauByQQd,
  kTauByQdQd,
  kTauByQQdd,
  kQddByQQ,
  kQddByQQd,
  kQddByQdQd,
  kQddByQTau
};
inline constexpr std::array<const char*, 8> kSecondDerivativeNames = {
    "d2tau_dq_dq", "d2tau_dq_dqd", "d2tau_dqd_dqd", "d2tau_dq_dqdd",
    "d2qdd_dq_dq", "d2qdd_dq_dqd", "d2qdd_dqd_dqd", "d2qdd_dq_dtau"};
inline const char* name(SecondDerivative quantity) {
  return kSecondDerivativeNames[static_cast<std::size_t>(quantity)];
}
inline bool isOfForces(SecondDerivative quantity) {
  return quantity <= SecondDerivative::kTauByQQdd;
}

/// The sweep is asked up to here: n^3 numbers a quantity, and n^4 operations for qdd.
constexpr int kMostSecondRates = 40;

/// Why the sweep does not go there; empty: it does.
inline std::string whyNoSecondSweep(const scene::Mechanism& mechanism) {
  if (mechanism.hasGearedRotors())
    return "the sweep for second derivatives knows no rotors that are geared to several rates";
  const int n = mechanism.dof();
  return n <= kMostSecondRates
             ? ""
             : fmt::format(
                   "{} rates have second derivatives of {} numbers each: the sweep for them "
                   "is asked of at most {} rates",
                   n, 1L * n * n * n, kMostSecondRates);
}

/** Who differentiates twice:
      lagrange      T and V once more (LagrangeDerivatives), those on dual numbers; for qdd its own
                    M solved with
      dual_numbers  the sweeps on dual numbers of dual numbers: Newton and Euler for tau,
                    articulated bodies for qdd
      derivatives   the sweep of recursive/second_derivatives.hpp
    The first two along a first direction w, then a second u; the last has every entry. */
enum class SecondRoad { kLagrange, kDualNumbers, kSweep };
inline const char* name(SecondRoad road) {
  constexpr const char* kNames[] = {"lagrange", "dual_numbers", "derivatives"};
  return kNames[static_cast<int>(road)];
}

/// A quantity by two roads.
struct SecondPair {
  SecondDerivative quantity;
  SecondRoad left, right;
};
inline std::vector<SecondPair> secondPairs(const scene::Mechanism& mechanism) {
  const bool has_sweep = whyNoSecondSweep(mechanism).empty();
  std::vector<SecondPair> pairs;
  for (std::size_t k = 0; k < kSecondDerivativeNames.size(); ++k) {
    const auto quantity = static_cast<SecondDerivative>(k);
    pairs.push_back({quantity, SecondRoad::kLagrange, SecondRoad::kDualNumbers});
    if (!has_sweep) continue;
    pairs.push_back({quantity, SecondRoad::kLagrange, SecondRoad::kSweep});
    pairs.push_back({quantity, SecondRoad::kDualNumbers, SecondRoad::kSweep});
  }
  return pairs;
}

}  // namespace dynwitness::crosscheck
