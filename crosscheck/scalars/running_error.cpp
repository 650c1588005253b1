// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/running_error.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::Exact;
using scene::Rational;

/// cos and sin of a double, each within 1 ulp of the real value.
scene::CosSin<RunningError> cosSin(const RunningError& angle) {
  const double c = std::cos(angle.value()), s = std::sin(angle.value());
  const double ulp = 2 * RunningError::kUnitRoundoff;
  // |cos' | <= 1 and |sin'| <= 1: an error of the angle moves them by no more than itself
  return {{c, (angle.value() == 0 ? 0 : ulp * std::abs(c)) + angle.bound()},
          {s, ulp * std::abs(s) + angle.bound()}};
}

}  // namespace

RunningError RunningErrorNumbers::operator()(const scene::Number& number) const {
  const Exact exact = scene::exactValue(number, values_);
  const double value = exact.toDouble();
  if (exact.isRational() && Rational(value) == exact.rational) return value;
  return {value, RunningError::kUnitRoundoff * std::abs(value)};  // correctly rounded
}

scene::CosSin<RunningError> RunningErrorNumbers::angle(const scene::Number& radians) const {
  int k = 0;
  if (scene::isQuarterTurn(scene::exactValue(radians, values_), &k))
    return scene::quarterTurns<RunningError>(k);
  return cosSin((*this)(radians));
}

scene::AxisTurn<RunningError> RunningErrorNumbers::axisTurn(const scene::Vector& axis) const {
  const RunningError x = (*this)(axis[0]), y = (*this)(axis[1]), z = (*this)(axis[2]);
  const bool along_z = x.value() == 0 && y.value() == 0;
  const bool in_one_plane = (x.value() == 0) || (y.value() == 0);
  // square roots of squares, taken without rounding where the axis is a coordinate axis
  const RunningError rho = along_z        ? RunningError(0)
                           : in_one_plane ? abs(x + y)
                                          : sqrt(x * x + y * y);
  const RunningError length = along_z ? abs(z) : z.value() == 0 ? rho : sqrt(x * x + y * y + z * z);
  const scene::CosSin<RunningError> alpha =
      along_z ? scene::CosSin<RunningError>{1, 0} : scene::CosSin<RunningError>{x / rho, y / rho};
  return {alpha, {z / length, rho / length}};
}

scene::JointPosition<RunningError> runningErrorPosition(double q) {
  return runningErrorPosition(RunningError(q));
}

scene::JointPosition<RunningError> runningErrorPosition(const RunningError& q) {
  const scene::CosSin<RunningError> point = cosSin(q);
  return {q, point.c, point.s};
}

}  // namespace dynwitness::crosscheck
