// SPDX-License-Identifier: GPL-3.0-or-later
// The quantities of controller code by the sweeps of recursive/, on any scalar: traced they are
// programs, on RunningError what code has to answer.
#pragma once

#include <optional>
#include <vector>

#include "crosscheck/kernel/controller_code.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/point_motion.hpp"
#include "recursive/regressor.hpp"

namespace dynwitness::crosscheck::kernel {

template <typename T>
std::vector<T> rows(const recursive::MatrixX<T>& m) {
  std::vector<T> out;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) out.push_back(m(i, j));
  return out;
}

/// One of the derivatives of tau and qdd; of dqdd_dq at the qdd that the state's tau makes.
template <typename T>
std::vector<T> sweptDerivative(CodeQuantity quantity, const recursive::Model<T>& model,
                               const scene::State<T>& s) {
  recursive::DerivativesWorkspace<T> room(model);
  recursive::InverseDynamicsDerivatives<T> of_tau(model);
  recursive::ForwardDynamicsDerivatives<T> of_qdd(model);
  std::vector<T> qdd(model.dof(), T(0));
  if (quantity == CodeQuantity::kDtauDq) qdd = s.qdd;
  if (quantity == CodeQuantity::kDqddDq)
    recursive::forwardDynamics(model, s.x, s.qd, s.tau, room.ws, qdd);
  // 1/M hangs on no rates
  const std::vector<T> qd = quantity == CodeQuantity::kDqddDtau ? qdd : s.qd;
  recursive::inverseDynamicsDerivatives(model, s.x, qd, qdd, room, of_tau);
  if (quantity == CodeQuantity::kDtauDq) return rows<T>(of_tau.dtau_dq);
  if (quantity == CodeQuantity::kDtauDqd) return rows<T>(of_tau.dtau_dqd);
  recursive::solveForAccelerations(model, room, of_tau, of_qdd);
  return rows<T>(quantity == CodeQuantity::kDqddDq    ? of_qdd.dqdd_dq
                 : quantity == CodeQuantity::kDqddDqd ? of_qdd.dqdd_dqd
                                                      : of_qdd.dqdd_dtau);
}

/// A quantity by the sweeps of recursive/, row by row, on any scalar.
template <typename T, typename Numbers>
std::vector<T> swept(CodeQuantity quantity, const recursive::Model<T>& model,
                     const scene::State<T>& s, const Numbers& number,
                     const std::vector<scene::InertialParameter>& parameters,
                     const std::optional<CodePoint>& point) {
  using recursive::Terms;
  if (isDerivative(quantity)) return sweptDerivative(quantity, model, s);
  recursive::Workspace<T> ws(model);
  const std::vector<T> none(model.dof(), T(0));
  std::vector<T> out(none);
  const auto inverse = [&](const std::vector<T>& qd, const std::vector<T>& qdd, Terms terms) {
    recursive::inverseDynamics(model, s.x, qd, qdd, ws, out, terms);
    return out;
  };
  switch (quantity) {
    case CodeQuantity::kTau:
      return inverse(s.qd, s.qdd, Terms::all());
    case CodeQuantity::kQdd:
      recursive::forwardDynamics(model, s.x, s.qd, s.tau, ws, out);
      return out;
    case CodeQuantity::kM: {
      recursive::MatrixX<T> M(model.dof(), model.dof());
      recursive::massMatrix(model, s.x, ws, M);
      return rows(M);
    }
    case CodeQuantity::kC:
      return rows<T>(recursive::coriolisMatrix(model, s.x, s.qd, ws));
    case CodeQuantity::kc:
      return inverse(s.qd, none, Terms::none());
    case CodeQuantity::kg:
      return inverse(none, none, Terms::potential());
    case CodeQuantity::kY: {
      recursive::MatrixX<T> Y(model.dof(), static_cast<Eigen::Index>(parameters.size()));
      recursive::regressor(model, parameters, s.x, s.qd, s.qdd, ws, Y);
      return rows(Y);
    }
    default:
      break;
  }
  const recursive::Vector3<T> at(number(point->at[0]), number(point->at[1]), number(point->at[2]));
  const recursive::PointMotion<T> motion =
      recursive::pointMotion(model, s.x, s.qd, none, static_cast<std::size_t>(point->link), at, ws);
  switch (quantity) {
    case CodeQuantity::kPosition:
      return {motion.position.x(), motion.position.y(), motion.position.z()};
    case CodeQuantity::kOrientation:
      return rows<T>(motion.R);
    case CodeQuantity::kJacobian:
      return rows(motion.J);
    default:
      return rows(motion.J_rate);
  }
}

}  // namespace dynwitness::crosscheck::kernel
