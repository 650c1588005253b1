// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_orientations.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace dynwitness::scene::mjcf {
namespace {

Turn eulerTurn(const std::vector<Number>& given, const Compiler& compiler,
               const SourceLocation& where) {
  Turn out;
  int turns = 0;
  std::array<Number, 3> angles;
  for (std::size_t k = 0; k < 3; ++k) {
    angles[k] = compiler.angle(given[k]);
    if (!isZero(angles[k])) ++turns;
    const int axis = std::tolower(compiler.euler[k]) - 'x';
    const Matrix3 R = turnAbout(axis, angles[k]);
    if (compiler.euler[k] >= 'x')
      out.R = out.R * R;  // about axes that turn along
    else
      out.R = R * out.R;
  }
  // one turn alone, or the order of roll, pitch, yaw, is what a scene says, too
  if (turns <= 1 || compiler.euler == "XYZ" || compiler.euler == "zyx") {
    for (std::size_t k = 0; k < 3; ++k)
      if (!isZero(angles[k]))
        out.rpy[static_cast<std::size_t>(std::tolower(compiler.euler[k]) - 'x')] = angles[k];
  } else {
    out.rpy = rollPitchYaw(out.R, where);
  }
  return out;
}

}  // namespace

Turn turnSaid(const Said& said, const Compiler& compiler) {
  constexpr const char* kKinds[] = {"quat", "euler", "axisangle", "xyaxes", "zaxis"};
  const char* kind = nullptr;
  for (const char* k : kKinds) {
    if (!said.has(k)) continue;
    if (kind)
      said.fail(k, fmt::format("and {} are both given, by it or its class, allowed: one "
                               "orientation",
                               kind));
    kind = k;
  }
  Turn out;
  if (!kind) return out;
  const std::string what = kind;
  const SourceLocation where = said.where();
  const auto requireLength = [&](const Vector3& v) {
    if (v.isZero(0)) said.fail(kind, "has a vector of zeros, allowed: any other");
  };
  if (what == "euler") return eulerTurn(said.numbers(kind, 3, 3), compiler, where);
  if (what == "quat") {
    const std::vector<Number> q = said.numbers(kind, 4, 4);
    const Vector3 v(valueOf(q[1]), valueOf(q[2]), valueOf(q[3]));
    const Real size = std::max(v.cwiseAbs().maxCoeff(), std::abs(valueOf(q[0])));
    if (size == 0) said.fail(kind, "is 0 0 0 0, allowed: any other");
    out.R = turnOf(valueOf(q[0]) / size, v / size);
    out.rpy = rollPitchYaw(out.R, where);
  } else if (what == "axisangle") {
    const std::vector<Number> a = said.numbers(kind, 4, 4);
    const Vector3 axis(valueOf(a[0]), valueOf(a[1]), valueOf(a[2]));
    requireLength(axis);
    const Number by = compiler.angle(a[3]);
    for (int k = 0; k < 3; ++k) {
      if (axis[(k + 1) % 3] != 0 || axis[(k + 2) % 3] != 0) continue;
      out.rpy[static_cast<std::size_t>(k)] = axis[k] > 0 ? by : negative(by);
      out.R = turnAbout(k, out.rpy[static_cast<std::size_t>(k)]);
      return out;
    }
    const Real half = valueOf(by) / 2;
    out.R = turnOf(std::cos(half), std::sin(half) * axis.stableNormalized());
    out.rpy = rollPitchYaw(out.R, where);
  } else if (what == "xyaxes") {
    const std::vector<Number> a = said.numbers(kind, 6, 6);
    const Vector3 x_given(valueOf(a[0]), valueOf(a[1]), valueOf(a[2])),
        y_given(valueOf(a[3]), valueOf(a[4]), valueOf(a[5]));
    requireLength(x_given);
    const Vector3 x = x_given.stableNormalized();
    const Vector3 across = y_given - x.dot(y_given) * x;
    if (across.norm() < 1e-14L * std::max(y_given.norm(), std::numeric_limits<Real>::min()))
      said.fail(kind, "has y along x, allowed: another direction");
    const Vector3 y = across.stableNormalized();
    out.R << x, y, x.cross(y);
    out.rpy = rollPitchYaw(out.R, where);
  } else {
    const Vector3 z = valueOf(said.vector(kind));
    requireLength(z);
    // the shortest turn that takes z there; of a half turn, that about x
    const Vector3 axis = Vector3::UnitZ().cross(z);
    const Real half = std::atan2(axis.norm(), z[2]) / 2;
    out.R = turnOf(std::cos(half), std::sin(half) * (axis.isZero(0) ? Vector3(Vector3::UnitX())
                                                                    : axis.stableNormalized()));
    out.rpy = rollPitchYaw(out.R, where);
  }
  return out;
}

}  // namespace dynwitness::scene::mjcf
