// SPDX-License-Identifier: GPL-3.0-or-later
// Which second derivatives of the equations of motion are asked about.
#pragma once

#include <array>
#include <string>

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

/// Why the sweep does not go there; empty: it does.
inline std::string whyNoSecondSweep(const scene::Mechanism& mechanism) {
  return mechanism.hasGearedRotors()
             ? "the sweep for second derivatives knows no rotors that are geared to several rates"
             : "";
}

}  // namespace dynwitness::crosscheck
