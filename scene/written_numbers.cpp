// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/written_numbers.hpp"
#include "scene/turn.hpp"

#include <tinyxml.h>

#include <fmt/format.h>

namespace dynwitness::scene::written {

Real settled(const Real& x, const Real& size) {
  return abs(x) < size * Real("1e-40") ? Real(0) : x;
}

std::string text(const Real& x) {
  return x == 0 ? "0" : x.str(17, std::ios_base::fmtflags(0));
}
std::string text(const Vector3& v) {
  return fmt::format("{} {} {}", text(v[0]), text(v[1]), text(v[2]));
}

std::string escaped(const std::string& name) {
  std::string encoded;  // TinyXML is built with TIXML_USE_STL wherever urdfdom is packaged
  TiXmlBase::EncodeString(name, &encoded);
  return encoded;
}

Vector3 vector(const Vector& v, const Numbers& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

Matrix3 turn(const Vector& rpy, const Numbers& number) {
  return turnAbout(2, number.angle(rpy[2])) * turnAbout(1, number.angle(rpy[1])) *
         turnAbout(0, number.angle(rpy[0]));
}

Vector3 rollPitchYaw(const Matrix3& R) {
  return scene::rollPitchYaw(R, [](const Real& y, const Real& x) -> Real { return atan2(y, x); })
      .unaryExpr([](const Real& x) { return settled(x, Real(1)); });
}

Frame frameOf(const std::vector<Step>& steps, const Numbers& number) {
  Frame out;
  for (const Step& step : steps) {
    if (step.kind == Step::Kind::kTranslate) {
      const Vector3 d = vector(step.translation, number);
      out.p += out.R * d;
      out.size += d.lpNorm<1>();
    } else {
      const int axis = static_cast<int>(step.kind) - static_cast<int>(Step::Kind::kRotateX);
      out.R = out.R * turnAbout(axis, number.angle(step.angle));
    }
  }
  out.p = out.p.unaryExpr([&](const Real& x) { return settled(x, out.size); }).eval();
  return out;
}

Origin composed(const std::vector<Step>& steps, const Numbers& number) {
  const Frame frame = frameOf(steps, number);
  return {frame.p, rollPitchYaw(frame.R)};
}

Origin jointOrigin(const Placement& placement, const Numbers& number) {
  if (placement.convention != Placement::Convention::kXyzRpy)
    return composed(placement.beforeJoint(), number);
  return {vector(placement.xyz, number), vector(placement.rpy, number)};
}

namespace {

Matrix3 inertiaMatrix(const MassProperties& p, const Numbers& number) {
  const Real xx = number(p.xx), yy = number(p.yy), zz = number(p.zz), xy = number(p.xy),
             xz = number(p.xz), yz = number(p.yz);
  return (Matrix3() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished();
}

}  // namespace

Inertial aboutCenterOfMass(const MassProperties& p, const Numbers& number) {
  Inertial out{
      number(p.mass), {vector(p.com, number), vector(p.rpy, number)}, inertiaMatrix(p, number)};
  const Vector3& com = out.origin.xyz;
  if (p.about != MassProperties::About::kLinkOrigin || out.mass == 0 || com.isZero(0)) return out;
  const Matrix3 R = turn(p.rpy, number);
  const Matrix3 at_origin = R * out.I * R.transpose();
  out.I = at_origin - out.mass * (com.squaredNorm() * Matrix3::Identity() - com * com.transpose());
  const Real size = at_origin.trace();
  out.I = out.I.unaryExpr([&](const Real& x) { return settled(x, size); }).eval();
  out.origin.rpy.setZero();
  return out;
}

}  // namespace dynwitness::scene::written
