// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_numbers.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "scene/numbers.hpp"
#include "scene/turn.hpp"
#include "scene/xml_element.hpp"

namespace dynwitness::scene::mjcf {

Real valueOf(const Number& n) {
  return fromExact<Real>(exactValue(n, {}));
}
bool isZero(const Number& n) {
  return n.isLiteralZero() || exactValue(n, {}).isZero();
}
bool isZero(const Vector& v) {
  return isZero(v[0]) && isZero(v[1]) && isZero(v[2]);
}
Vector3 valueOf(const Vector& v) {
  return {valueOf(v[0]), valueOf(v[1]), valueOf(v[2])};
}

Number printed(Real x, Real size, const SourceLocation& where) {
  if (x == 0 || std::abs(x) < 1e-18L * size) return Number(0);
  const Real magnitude = std::abs(x);
  if (!(magnitude >= std::numeric_limits<double>::min() &&
        magnitude <= std::numeric_limits<double>::max()))
    throw InputError(where,
                     "what follows from its numbers is too large or too small to be finite in a "
                     "double, allowed: sizes of machines");
  return Expression::parse(fmt::format("{:.18g}", x));
}
Vector printed(const Vector3& v, Real size, const SourceLocation& where) {
  return {printed(v[0], size, where), printed(v[1], size, where), printed(v[2], size, where)};
}

Number difference(const Number& a, const Number& b) {
  if (isZero(b)) return a;
  const Exact x = exactValue(a, {}), y = exactValue(b, {});
  if (x.isRational() && y.isRational()) return Number(Rational(x.rational - y.rational));
  return Expression::parse(fmt::format("({}) - ({})", a.text(), b.text()));
}
Vector difference(const Vector& a, const Vector& b) {
  return {difference(a[0], b[0]), difference(a[1], b[1]), difference(a[2], b[2])};
}
Number negative(const Number& n) {
  return isZero(n) ? Number(0) : Expression::parse("-(" + n.text() + ")");
}

Number ofDegrees(const Number& degrees) {
  if (isZero(degrees)) return Number(0);
  const Rational turns = exactValue(degrees, {}).rational / 180;
  if (denominator(turns) > 12) return Expression::parse(fmt::format("{}*pi/180", degrees.text()));
  const Integer n = numerator(turns), d = denominator(turns);
  std::string text = n < 0 ? "-" : "";
  if (abs(n) != 1) text += Integer(abs(n)).str() + "*";
  return Expression::parse(text + "pi" + (d == 1 ? "" : "/" + d.str()));
}

Matrix3 turnAbout(int axis, const Number& angle) {
  static const Mechanism none;
  return scene::turnAbout(axis, RealNumbers<Real>(none).angle(angle));
}

Matrix3 turnOf(Real w, const Vector3& v) {
  Matrix3 cross;
  cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return Matrix3::Identity() + 2 / (w * w + v.squaredNorm()) * (w * cross + cross * cross);
}

Vector rollPitchYaw(const Matrix3& R, const SourceLocation& where) {
  const auto atan = [](Real y, Real x) {  // of what rounding leaves of zero: zero
    return std::atan2(std::abs(y) < 1e-18L ? 0 : y, std::abs(x) < 1e-18L ? 0 : x);
  };
  Vector rpy = printed(scene::rollPitchYaw(R, atan), 1, where);
  for (Number& angle : rpy) angle = angleOf(angle);
  return rpy;
}

}  // namespace dynwitness::scene::mjcf
