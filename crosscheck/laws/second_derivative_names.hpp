// SPDX-License-Identifier: GPL-3.0-or-later
// Which second derivatives of the equations of motion are asked about.
#pragma once

#include <array>
#include <cstddef>
#include <string>

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

}  // namespace dynwitness::crosscheck
