// SPDX-License-Identifier: GPL-3.0-or-later
// Where a point of a link is and how it moves: sweeps of spatial vectors against homogeneous 4 x 4
// matrices and their derivatives by the coordinates, which share no formula.
#pragma once

#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/witnesses/frame_jacobian.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "recursive/point_motion.hpp"

namespace dynwitness::crosscheck {

/** A point of a link by matrices: with W the place of the body that carries it, x = (point, 1) in
    that body's axes, A' what follows from qd and A'' from qd and qdd,

        position = W x,   velocity = W' x,   acceleration = W'' x
        [w]x = W' R',     [dw/dt]x = W'' R' + W' R''    (R, R': the 3 x 3 parts)
        column k of J:  the same of dW/dpi_k;   of dJ/dt:  of d(dW/dpi_k)/dt

    @see HomogeneousModel */
template <typename T>
recursive::PointMotion<T> pointByMatrices(HomogeneousModel<T>& model, const scene::State<T>& state,
                                          std::size_t link, const Eigen::Matrix<T, 3, 1>& at) {
  using Matrix3 = Eigen::Matrix<T, 3, 3>;
  const auto body = static_cast<std::size_t>(model.body_of_link[link]);
  Vector4<T> x = Vector4<T>::Constant(T(1));
  x.template head<3>() = at;
  x = (model.after_of_link[link] * x).eval();
  const auto R = [](const Matrix4<T>& m) { return Matrix3(m.template topLeftCorner<3, 3>()); };
  const auto of = [&](const Matrix4<T>& m, const Matrix3& turn) {
    recursive::Motion<T> out;
    out.linear = (m * x).template head<3>();
    out.angular = {turn(2, 1), turn(0, 2), turn(1, 0)};
    return out;
  };
  model.place(state.x);
  recursive::PointMotion<T> out;
  const auto moved = model.partialsOf(body, state.qd, state.qd);
  const Matrix4<T>&Wd = moved.first, W = model.places()[body];
  const Matrix3 R_W = R(W), back = R_W.transpose(), back_rate = R(Wd).transpose();
  // Wd is linear in the rates
  const Matrix4<T> Wdd = moved.second + model.partialsOf(body, state.qd, state.qdd).first;
  out.R = R_W * R(model.after_of_link[link]);
  out.position = (W * x).template head<3>();
  out.velocity = of(Wd, R(Wd) * back);
  out.acceleration = of(Wdd, R(Wdd) * back + R(Wd) * back_rate);
  out.J = out.J_rate = MatrixX<T>::Constant(6, model.dof(), T(0));
  std::vector<T> unit(state.qd.size(), T(0));
  for (std::size_t k = 0; k < unit.size(); ++k) {
    unit[k] = T(1);
    const auto [W_k, rate] = model.partialsOf(body, state.qd, unit);
    unit[k] = T(0);
    const auto column = static_cast<Eigen::Index>(k);
    out.J.col(column) = of(W_k, R(W_k) * back).vector();
    out.J_rate.col(column) = of(rate, R(rate) * back + R(W_k) * back_rate).vector();
  }
  return out;
}

/// A point of a mechanism at a state, by both roads: what the laws below are asked about.
template <typename T>
struct PointOfMechanism {
  using Scalar = T;

  recursive::PointMotion<T> swept, by_matrices;
  std::vector<T> qd, qdd;

  template <typename Numbers>
  PointOfMechanism(const scene::Mechanism& mechanism, const recursive::Model<T>& model,
                   const Numbers& number, const scene::State<T>& state)
      : qd(state.qd), qdd(state.qdd) {
    const FramePoint point = farthestPoint(mechanism);
    const auto link = static_cast<std::size_t>(point.link);
    // in eighths: exact in a field, too
    Eigen::Matrix<T, 3, 1> at;
    for (int k = 0; k < 3; ++k) at(k) = T(static_cast<int>(8 * point.at(k))) / T(8);
    recursive::Workspace<T> ws(model);
    swept = recursive::pointMotion(model, state.x, state.qd, state.qdd, link, at, ws);
    HomogeneousModel<T> matrices(mechanism, number);
    by_matrices = pointByMatrices(matrices, state, link, at);
  }
};

struct PlaceOfAPoint : Law {
  static constexpr LawWords kWords = {"place of a point",
                                      "position and axes by sweeps = by 4 x 4 matrices", "position",
                                      "sweeps", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(const PointOfMechanism<T>& at) {
    const auto all = [](const recursive::PointMotion<T>& m) {
      MatrixX<T> out(3, 4);
      out << m.R, m.position;
      return out;
    };
    return {all(at.swept), all(at.by_matrices)};
  }
};

struct MotionOfAPoint : Law {
  static constexpr LawWords kWords = {"motion of a point",
                                      "velocity and acceleration by sweeps = by 4 x 4 matrices",
                                      "velocity", "sweeps", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(const PointOfMechanism<T>& at) {
    const auto all = [](const recursive::PointMotion<T>& m) {
      MatrixX<T> out(6, 2);
      out << m.velocity.vector(), m.acceleration.vector();
      return out;
    };
    return {all(at.swept), all(at.by_matrices)};
  }
};

struct JacobianOfAPoint : Law {
  static constexpr LawWords kWords = {"Jacobian of a point",
                                      "J and dJ/dt by sweeps = by 4 x 4 matrices", "jacobian",
                                      "sweeps", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(const PointOfMechanism<T>& at) {
    const auto all = [](const recursive::PointMotion<T>& m) {
      MatrixX<T> out(12, m.J.cols());
      out << m.J, m.J_rate;
      return out;
    };
    return {all(at.swept), all(at.by_matrices)};
  }
};

struct JacobianMakesTheMotion : Law {
  static constexpr LawWords kWords = {"the Jacobian makes the motion",
                                      "velocity = J qd, acceleration = J qdd + dJ/dt qd",
                                      "jacobian", "sweeps", ""};
  template <typename T>
  static TwoSides<T> sides(const PointOfMechanism<T>& at) {
    const MatrixX<T> qd = column(at.qd), qdd = column(at.qdd);
    TwoSides<T> out = {MatrixX<T>(6, 2), MatrixX<T>(6, 2)};
    out.left << at.swept.velocity.vector(), at.swept.acceleration.vector();
    out.right << at.swept.J * qd, at.swept.J * qdd + at.swept.J_rate * qd;
    return out;
  }
};

using PointLaws = Laws<PlaceOfAPoint, MotionOfAPoint, JacobianOfAPoint, JacobianMakesTheMotion>;

}  // namespace dynwitness::crosscheck
