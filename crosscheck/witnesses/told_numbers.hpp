// SPDX-License-Identifier: GPL-3.0-or-later
// What engines are told of a scene where it is written for them: frames and inertias as numbers,
// formed in long double, so that their rounding to double is all that is lost.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

class ToldNumbers {
 public:
  using Real = long double;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  using Matrix3 = Eigen::Matrix<Real, 3, 3>;

  /// Frame to frame: x_outer = R x_inner + p.
  struct Frame {
    Matrix3 R = Matrix3::Identity();
    Vector3 p = Vector3::Zero();
    Frame operator*(const Frame& next) const { return {R * next.R, p + R * next.p}; }
  };
  /// In link axes; I about the centre of mass.
  struct Inertia {
    Real mass;
    Vector3 com;
    Matrix3 I;
  };

  explicit ToldNumbers(const scene::Mechanism& mechanism) : number_(mechanism) {}

  Real operator()(const scene::Number& x) const { return number_(x); }
  Vector3 vector(const scene::Vector& v) const {
    return {number_(v[0]), number_(v[1]), number_(v[2])};
  }
  /// Rz(alpha) Ry(beta) takes z to this axis.
  scene::AxisTurn<Real> axisTurn(const scene::Vector& axis) const { return number_.axisTurn(axis); }

  Frame frame(const std::vector<scene::Step>& steps) const {
    using Kind = scene::Step::Kind;
    Frame X;
    for (const scene::Step& step : steps) {
      if (step.kind == Kind::kTranslate)
        X.p += X.R * vector(step.translation);
      else
        X.R =
            X.R * turn(static_cast<int>(step.kind) - static_cast<int>(Kind::kRotateX), step.angle);
    }
    return X;
  }

  /// I = R I_given R', less m ((c'c) 1 - c c') where it is given about the link's origin.
  Inertia inertia(const scene::MassProperties& given) const {
    Matrix3 I;
    I << number_(given.xx), number_(given.xy), number_(given.xz),  //
        number_(given.xy), number_(given.yy), number_(given.yz),   //
        number_(given.xz), number_(given.yz), number_(given.zz);
    const Matrix3 R = turn(2, given.rpy[2]) * turn(1, given.rpy[1]) * turn(0, given.rpy[0]);
    Inertia out{number_(given.mass), vector(given.com), R * I * R.transpose()};
    if (given.about == scene::MassProperties::About::kLinkOrigin)
      out.I -=
          out.mass * (out.com.squaredNorm() * Matrix3::Identity() - out.com * out.com.transpose());
    return out;
  }

 private:
  /// About an axis of the frame: 0 x, 1 y, 2 z.
  Matrix3 turn(int axis, const scene::Number& angle) const {
    const scene::CosSin<Real> a = number_.angle(angle);
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    Matrix3 R = Matrix3::Identity();
    R(j, j) = R(k, k) = a.c;
    R(j, k) = -a.s;
    R(k, j) = a.s;
    return R;
  }

  scene::RealNumbers<Real> number_;
};

}  // namespace dynwitness::crosscheck
