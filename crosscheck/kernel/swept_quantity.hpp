// SPDX-License-Identifier: GPL-3.0-or-later
// The quantities of controller code by the sweeps of recursive/, on any scalar: traced they are
// programs, on RunningError what code has to answer.
#pragma once

#include <optional>
#include <vector>

#include "crosscheck/kernel/controller_code.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/composite_body.hpp"
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

/// A quantity by the sweeps of recursive/, row by row, on any scalar.
template <typename T, typename Numbers>
std::vector<T> swept(CodeQuantity quantity, const recursive::Model<T>& model,
                     const scene::State<T>& s, const Numbers& number,
                     const std::vector<scene::InertialParameter>& parameters,
                     const std::optional<CodePoint>& point) {
  using recursive::Terms;
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
