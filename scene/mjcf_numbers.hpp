// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of MJCF files: exact while they are decimals of the file, and printed where they had to
// be computed. For the reader of MJCF (mjcf_*.cpp) alone.
#pragma once

#include <Eigen/Core>

#include "scene/mechanism.hpp"

namespace dynwitness::scene::mjcf {

using Real = long double;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;

Real valueOf(const Number& n);
Vector3 valueOf(const Vector& v);
bool isZero(const Number& n);
bool isZero(const Vector& v);

/** A computed number as a decimal.
    @param size  of the numbers that it was made of: what their rounding leaves of it is zero */
Number printed(Real x, Real size, const SourceLocation& where);
Vector printed(const Vector3& v, Real size, const SourceLocation& where);

/// a - b, as a decimal where both are, and otherwise as it stands.
Number difference(const Number& a, const Number& b);
Vector difference(const Vector& a, const Vector& b);
Number negative(const Number& n);

/// Degrees as radians, exactly.
Number ofDegrees(const Number& degrees);

/// R of x' = R x for a turn about axis 0, 1 or 2 (x, y, z), quarter turns exactly.
Matrix3 turnAbout(int axis, const Number& angle);
/** R = 1 + 2 (w [v]x + [v]x^2) / (q'q), for a quaternion q = (w, v) of any length but 0. */
Matrix3 turnOf(Real w, const Vector3& v);
/// Of R = Rz(yaw) Ry(pitch) Rx(roll), as expressions.
Vector rollPitchYaw(const Matrix3& R, const SourceLocation& where);

}  // namespace dynwitness::scene::mjcf
