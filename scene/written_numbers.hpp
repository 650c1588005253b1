// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers and frames for formats that have decimals and no expressions (URDF, MJCF).
//
// They are formed exactly or with 50 digits, and printed with 17: decimals of the scene stay the
// decimals that they are.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include "scene/numbers.hpp"

namespace dynwitness::scene::written {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_50::backend_type,
                                           boost::multiprecision::et_off>;
using Numbers = RealNumbers<Real>;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;

/// x, or zero where x is what the roundings of 50 digits leave of numbers of this size.
Real settled(const Real& x, const Real& size);
/// 17 significant digits, no more than it takes.
std::string text(const Real& x);
std::string text(const Vector3& v);
/// A name as the value of an attribute.
std::string escaped(const std::string& name);

Vector3 vector(const Vector& v, const Numbers& number);
/// R = Rz(yaw) Ry(pitch) Rx(roll)
Matrix3 turn(const Vector& rpy, const Numbers& number);

/// Roll, pitch and yaw of R = Rz(yaw) Ry(pitch) Rx(roll) (turn.hpp), settled.
Vector3 rollPitchYaw(const Matrix3& R);

/// A frame on another one: moved by xyz, then turned by rpy.
struct Origin {
  Vector3 xyz = Vector3::Zero(), rpy = Vector3::Zero();
  bool isNone() const { return xyz.isZero(0) && rpy.isZero(0); }
};

struct Frame {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
  Real size = 0;  ///< of the translations that it was made of
};
Frame frameOf(const std::vector<Step>& steps, const Numbers& number);
Origin composed(const std::vector<Step>& steps, const Numbers& number);
/// Parent's link frame to joint frame.
Origin jointOrigin(const Placement& placement, const Numbers& number);

/// Mass properties about the centre of mass: `origin` is the frame on the link's in which I is
/// given.
struct Inertial {
  Real mass;
  Origin origin;
  Matrix3 I;
};
Inertial aboutCenterOfMass(const MassProperties& p, const Numbers& number);

}  // namespace dynwitness::scene::written
