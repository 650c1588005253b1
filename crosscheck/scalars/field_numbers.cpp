// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's numbers in the prime field: rationals as they are, and indeterminates.
#include <array>
#include <stdexcept>
#include <utility>

#include "crosscheck/scalars/prime_field.hpp"
#include "scene/mimic.hpp"
#include "scene/rational_signs.hpp"

namespace dynwitness::crosscheck {
namespace {

/// A fixed angle as  sign (quarters pi/2 + rest):  equal up to quarter turns and sign, same rest.
struct ReducedAngle {
  bool negative;
  int quarters;       ///< 0 ... 3
  bool mirrored;      ///< the point of `rest` enters as that of -rest
  scene::Exact rest;  ///< zero: a quarter turn
};

scene::Integer floorOf(const scene::Rational& x) {
  const scene::Integer n = numerator(x), d = denominator(x), quotient = n / d;
  return n < 0 && quotient * d != n ? scene::Integer(quotient - 1) : quotient;
}

ReducedAngle reduced(const scene::Exact& given) {
  scene::Exact angle = given;
  if (scene::isZero(
          angle.rational))  // between -pi and pi, so that whole turns do not change the sign
    angle.pi_multiple -= 2 * floorOf((angle.pi_multiple + 1) / 2);
  ReducedAngle out{
      scene::isNegative(scene::isZero(angle.rational) ? angle.pi_multiple : angle.rational), 0,
      false, angle};
  if (out.negative) out.rest = {-angle.rational, -angle.pi_multiple};
  scene::Integer quarters = floorOf(out.rest.pi_multiple * 2);
  out.rest.pi_multiple -= scene::Rational(quarters, 2);
  // between pi/4 and pi/2: as far below pi/2
  if (scene::isZero(out.rest.rational) && out.rest.pi_multiple > scene::Rational(1, 4)) {
    out.rest.pi_multiple = scene::Rational(1, 2) - out.rest.pi_multiple;
    out.mirrored = true;
    ++quarters;
  }
  out.quarters = static_cast<int>(scene::Integer(((quarters % 4) + 4) % 4));
  return out;
}

/// Expressions in parameters, each parameter an indeterminate.
struct Algebra {
  const FieldSource& source;
  PrimeField number(const scene::Rational& value) const { return source.constant(value); }
  PrimeField parameter(const std::string& name) const {
    return source.element("parameter " + name);
  }
  PrimeField pi() const { return source.element("pi"); }
};

scene::CosSin<PrimeField> mirrored(const scene::CosSin<PrimeField>& p) {
  return {p.c, -p.s};
}

}  // namespace

FieldNumbers::FieldNumbers(const scene::Mechanism& mechanism, FieldSource source,
                           Parameters parameters)
    : values_(mechanism.parameterValues()), source_(std::move(source)), parameters_(parameters) {}

PrimeField FieldNumbers::operator()(const scene::Number& number) const {
  using Kind = scene::Number::Kind;
  if (number.kind() == Kind::kNumber) return source_.constant(number.number());
  if (number.kind() == Kind::kNegate && number.left().kind() == Kind::kNumber)
    return -source_.constant(number.left().number());
  if (!isKnown(number)) return scene::evaluateIn<PrimeField>(number, Algebra{source_});
  const scene::Exact exact = exactly(number);
  const PrimeField value = source_.constant(exact.rational);
  if (scene::isZero(exact.pi_multiple)) return value;
  return value + source_.constant(exact.pi_multiple) * source_.element("pi");
}

FieldNumbers::Point FieldNumbers::angle(const scene::Number& radians) const {
  const auto [it, is_new] = points_.try_emplace(radians.text());
  if (is_new) it->second = pointOf(radians);
  return it->second;
}

scene::AxisTurn<PrimeField> FieldNumbers::axisTurn(const scene::Vector& axis) const {
  using Kind = scene::Number::Kind;
  if (axis[0].isLiteralZero() && axis[1].isLiteralZero() && axis[2].kind() == Kind::kNumber &&
      scene::top(axis[2].number()).sign() > 0)  // z, as most are
    return {{PrimeField(1), PrimeField(0)}, {PrimeField(1), PrimeField(0)}};
  std::array<scene::Exact, 3> v;
  std::array<bool, 3> is_zero;
  bool rational = true;
  for (int i = 0; i < 3; ++i) {
    v[i] = exactly(axis[i]);
    const bool has_pi = !scene::isZero(v[i].pi_multiple);
    is_zero[i] = isKnown(axis[i]) && !has_pi && scene::isZero(v[i].rational);
    rational = rational && isKnown(axis[i]) && !has_pi;
  }
  if (is_zero[0] && is_zero[1] && is_zero[2])
    throw std::invalid_argument("axisTurn: axis: expected a non-zero vector");
  const auto sign = [&](int i) { return PrimeField(scene::isNegative(v[i]) ? -1 : 1); };

  // where components are zero the turns are quarter turns, whatever the others are
  const bool alpha_known = is_zero[0] || is_zero[1];
  const bool beta_known = is_zero[2] || (is_zero[0] && is_zero[1]);
  scene::AxisTurn<PrimeField> turn{{PrimeField(1), PrimeField(0)}, {PrimeField(0), PrimeField(1)}};
  if (is_zero[0] && !is_zero[1]) turn.alpha = {PrimeField(0), sign(1)};
  if (is_zero[1] && !is_zero[0]) turn.alpha = {sign(0), PrimeField(0)};
  if (is_zero[0] && is_zero[1]) turn.beta = {sign(2), PrimeField(0)};
  if (!rational) {
    const std::string text = axis[0].text() + ", " + axis[1].text() + ", " + axis[2].text();
    if (!alpha_known) turn.alpha = source_.circlePoint("alpha of " + text);
    if (!beta_known) turn.beta = source_.circlePoint("beta of " + text);
    return turn;
  }

  // parallel axes share their points, whatever their lengths and signs
  const scene::Rational x = v[0].rational, y = v[1].rational, z = v[2].rational;
  const scene::Rational rho2 = x * x + y * y;
  scene::Rational rho, length;
  const bool rho_rational = rationalRoot(rho2, &rho);
  if (!alpha_known && rho_rational) {
    turn.alpha = {source_.constant(x / rho), source_.constant(y / rho)};
  } else if (!alpha_known) {
    const scene::Rational slope = abs(y / x);
    const Point p = source_.circlePoint("alpha of slope " + slope.str());
    turn.alpha = {sign(0) * p.c, sign(1) * p.s};
  }
  if (!beta_known && rho_rational && rationalRoot(rho2 + z * z, &length)) {
    turn.beta = {source_.constant(z / length), source_.constant(rho / length)};
  } else if (!beta_known) {
    const scene::Rational slope2 = z * z / rho2;
    const Point p = source_.circlePoint("beta of squared slope " + slope2.str());
    turn.beta = {sign(2) * p.c, p.s};
  }
  return turn;
}

bool FieldNumbers::isKnown(const scene::Number& number) const {
  return parameters_ == Parameters::kAsWritten || number.parameters().empty();
}

/// exactValue(), quickly for plain numbers.
scene::Exact FieldNumbers::exactly(const scene::Number& number) const {
  using Kind = scene::Number::Kind;
  if (number.kind() == Kind::kNumber) return {number.number(), 0};
  if (number.kind() == Kind::kNegate && number.left().kind() == Kind::kNumber)
    return {-number.left().number(), 0};
  return exactValue(number, values_);
}

FieldNumbers::Point FieldNumbers::pointOf(const scene::Number& radians) const {
  if (radians.kind() == scene::Number::Kind::kNegate) return mirrored(angle(radians.left()));
  if (!isKnown(radians)) return source_.circlePoint("angle " + radians.text());
  const ReducedAngle a = reduced(exactly(radians));
  Point point = scene::quarterTurns<PrimeField>(a.quarters);
  if (!scene::isZero(a.rest.rational) || !scene::isZero(a.rest.pi_multiple)) {
    point = source_.circlePoint("angle " + a.rest.rational.str() + " + " +
                                a.rest.pi_multiple.str() + " pi");
    if (a.mirrored) point = mirrored(point);
    for (int k = 0; k < a.quarters; ++k) point = {-point.s, point.c};
  }
  return a.negative ? mirrored(point) : point;
}

scene::State<PrimeField> indeterminateState(const scene::Mechanism& mechanism,
                                            const FieldSource& source, Parameters parameters) {
  scene::State<PrimeField> state;
  const std::vector<scene::SlotKind> slots = mechanism.slots();
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::string joint = " of joint " + std::to_string(i);
    scene::CosSin<PrimeField> point{};
    if (slots[i] != scene::SlotKind::kQuaternion) point = source.circlePoint("position" + joint);
    state.x.push_back({source.element("q" + joint), point.c, point.s});
  }
  for (int i = 0; i < mechanism.dof(); ++i) {
    const std::string joint = " of joint " + std::to_string(i);
    state.qd.push_back(source.element("qd" + joint));
    state.qdd.push_back(source.element("qdd" + joint));
    state.tau.push_back(source.element("tau" + joint));
  }
  if (!mechanism.hasMimics()) return state;
  const FieldNumbers number(mechanism, source, parameters);
  for (const scene::Follower& f : scene::followers(mechanism))
    state.x[f.slot].q =
        number(scene::Number(f.multiplier)) * state.x[f.leader_slot].q + number(f.offset);
  return state;
}

}  // namespace dynwitness::crosscheck
