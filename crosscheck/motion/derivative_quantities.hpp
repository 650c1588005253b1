// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a tree's equations of motion that `evaluate` answers.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** n x n each, row i of tau_i or qdd_i, column j by q_j, qd_j or tau_j; d tau/dqdd is M.
      dtau_dq    of the tau that the state's qdd takes
      dtau_dqd   whatever qdd
      dqdd_dq    of the qdd that the state's tau makes
      dqdd_dqd   whatever tau
      dqdd_dtau  1/M
      C          the matrix of the Christoffel symbols (recursive::coriolisMatrix): c = C qd, and
                 dM/dt - 2 C is skew-symmetric
      Y          n x p, the regressor (recursive/regressor.hpp): d tau by the inertial parameters,
                 tau = Y pi less springs, friction and loads, of the state's qdd
    and n x n^2 each the second derivatives (recursive/second_derivatives.hpp) that are not zero by
    nature: column (j - 1) n + k has what changes along j of the derivative by the k-th
      d2tau_dq_dq    of the tau that the state's qdd takes
      d2tau_dq_dqd, d2tau_dqd_dqd, d2tau_dq_dqdd (dM/dq)         whatever qdd
      d2qdd_dq_dq    of the qdd that the state's tau makes
      d2qdd_dq_dqd, d2qdd_dqd_dqd, d2qdd_dq_dtau (d(1/M)/dq)     whatever tau
    Of spherical and floating joints q_j moves as at a unit rate qd_j: along the body's axes. */
enum class DerivativeQuantity {
  kDtauDq,
  kDtauDqd,
  kDqddDq,
  kDqddDqd,
  kDqddDtau,
  kCoriolis,
  kRegressor,
  kD2tauDqDq,
  kD2tauDqDqd,
  kD2tauDqdDqd,
  kD2tauDqDqdd,
  kD2qddDqDq,
  kD2qddDqDqd,
  kD2qddDqdDqd,
  kD2qddDqDtau
};
const char* name(DerivativeQuantity quantity);
std::optional<DerivativeQuantity> derivativeQuantityNamed(const std::string& name);
std::vector<std::string> derivativeQuantityNames();

/// By the sweeps of recursive/derivatives.hpp and second_derivatives.hpp.
class DerivativeQuantities {
 public:
  /// @throws scene::InputError  what Command::kEvaluateDerivatives refuses
  explicit DerivativeQuantities(const scene::Scene& scene);
  ~DerivativeQuantities();

  /// @throws scene::InputError  second derivatives of more than kMostNumbers numbers a state, or of
  ///   a scene with rotors geared to several rates
  void require(DerivativeQuantity quantity) const;
  static constexpr long kMostNumbers = 10'000'000;

  /// "dtau1_dq2", "d2tau1_dq2_dqd3", "C12", "Y2_mcx(forearm)", row by row.
  std::vector<std::string> columns(DerivativeQuantity quantity) const;
  /// Their units, "N m/rad".
  std::vector<std::string> units(DerivativeQuantity quantity) const;

  /// n x n, n x p or n x n^2. @param state  with the qdd or tau that the quantity hangs on
  /// @throws scene::InputError  by a rate of a joint with Coulomb friction that rests, which has no
  ///   derivative there
  Eigen::MatrixXd value(DerivativeQuantity quantity, const scene::State<double>& state);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
