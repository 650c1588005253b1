// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's numbers as rational numbers and indeterminates: what the exact checks compute with.
#pragma once

#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "scene/mimic.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

/// Whether the parameters of a scene are the numbers that it gives, or indeterminates: then the
/// verdict covers every robot with that structure.
enum class Parameters { kAsWritten, kRandom };
/// "as written", "random"
const char* name(Parameters parameters);

namespace detail {

/// A fixed angle as  sign (quarters pi/2 + rest):  equal up to quarter turns and sign, same rest.
struct ReducedAngle {
  bool negative;
  int quarters;       ///< 0 ... 3
  bool mirrored;      ///< the point of `rest` enters as that of -rest
  scene::Exact rest;  ///< zero: a quarter turn
};

ReducedAngle reduced(const scene::Exact& angle);

/// The square root of a rational that has a rational one.
bool rationalRoot(const scene::Rational& square, scene::Rational* root);

}  // namespace detail

/** Gives a scene's numbers to a field (the "Numbers" concept of scene/numbers.hpp).

    Rationals stay what they are. What has no rational value becomes an indeterminate, the same one
    wherever the same number occurs: pi; the point (cos, sin) of the circle of a fixed angle that is
    no quarter turn, where a x and -x + k pi/2 share one indeterminate point; and cos and sin of the
    turns that take z to a slanted axis, where they are irrational. A formula that uses no more of
    them than c^2 + s^2 = 1 cannot tell the difference, and what holds for the indeterminates holds
    for the scene's numbers.

    @tparam Source  supplies constant(rational), element(name), circlePoint(name) as its Scalar */
template <typename Source>
class IndeterminateNumbers {
 public:
  using Scalar = typename Source::Scalar;
  using Point = scene::CosSin<Scalar>;

  IndeterminateNumbers(const scene::Mechanism& mechanism, Source source,
                       Parameters parameters = Parameters::kAsWritten)
      : values_(mechanism.parameterValues()), source_(std::move(source)), parameters_(parameters) {}

  Scalar operator()(const scene::Number& number) const {
    if (!isKnown(number)) return scene::evaluateIn<Scalar>(number, Algebra{source_});
    const scene::Exact exact = exactly(number);
    const Scalar value = source_.constant(exact.rational);
    if (exact.pi_multiple == 0) return value;
    return value + source_.constant(exact.pi_multiple) * source_.element("pi");
  }

  Point angle(const scene::Number& radians) const {
    const auto [it, is_new] = points_.try_emplace(radians.text());
    if (is_new) it->second = pointOf(radians);
    return it->second;
  }

  scene::AxisTurn<Scalar> axisTurn(const scene::Vector& axis) const {
    std::array<scene::Exact, 3> v;
    std::array<bool, 3> is_zero;
    bool rational = true;
    for (int i = 0; i < 3; ++i) {
      v[i] = exactly(axis[i]);
      is_zero[i] = isKnown(axis[i]) && v[i].isZero();
      rational = rational && isKnown(axis[i]) && v[i].isRational();
    }
    if (is_zero[0] && is_zero[1] && is_zero[2])
      throw std::invalid_argument("axisTurn: axis: expected a non-zero vector");
    const auto sign = [&](int i) { return Scalar(v[i].approximation() < 0 ? -1 : 1); };

    // where components are zero the turns are quarter turns, whatever the others are
    const bool alpha_known = is_zero[0] || is_zero[1];
    const bool beta_known = is_zero[2] || (is_zero[0] && is_zero[1]);
    scene::AxisTurn<Scalar> turn{{Scalar(1), Scalar(0)}, {Scalar(0), Scalar(1)}};
    if (is_zero[0] && !is_zero[1]) turn.alpha = {Scalar(0), sign(1)};
    if (is_zero[1] && !is_zero[0]) turn.alpha = {sign(0), Scalar(0)};
    if (is_zero[0] && is_zero[1]) turn.beta = {sign(2), Scalar(0)};
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
    const bool rho_rational = detail::rationalRoot(rho2, &rho);
    if (!alpha_known && rho_rational) {
      turn.alpha = {source_.constant(x / rho), source_.constant(y / rho)};
    } else if (!alpha_known) {
      const scene::Rational slope = abs(y / x);
      const Point p = source_.circlePoint("alpha of slope " + slope.str());
      turn.alpha = {sign(0) * p.c, sign(1) * p.s};
    }
    if (!beta_known && rho_rational && detail::rationalRoot(rho2 + z * z, &length)) {
      turn.beta = {source_.constant(z / length), source_.constant(rho / length)};
    } else if (!beta_known) {
      const scene::Rational slope2 = z * z / rho2;
      const Point p = source_.circlePoint("beta of squared slope " + slope2.str());
      turn.beta = {sign(2) * p.c, p.s};
    }
    return turn;
  }

 private:
  /// Expressions in parameters, each parameter an indeterminate.
  struct Algebra {
    const Source& source;
    Scalar number(const scene::Rational& value) const { return source.constant(value); }
    Scalar parameter(const std::string& name) const { return source.element("parameter " + name); }
    Scalar pi() const { return source.element("pi"); }
  };

  bool isKnown(const scene::Number& number) const {
    return parameters_ == Parameters::kAsWritten || number.parameters().empty();
  }
  /// exactValue(), quickly for plain numbers.
  scene::Exact exactly(const scene::Number& number) const {
    if (number.kind() == scene::Number::Kind::kNumber) return {number.number(), 0};
    return exactValue(number, values_);
  }
  Point pointOf(const scene::Number& radians) const {
    if (radians.kind() == scene::Number::Kind::kNegate) return mirrored(angle(radians.left()));
    if (!isKnown(radians)) return source_.circlePoint("angle " + radians.text());
    const detail::ReducedAngle a = detail::reduced(exactly(radians));
    Point point = scene::quarterTurns<Scalar>(a.quarters);
    if (!a.rest.isZero()) {
      point = source_.circlePoint("angle " + a.rest.rational.str() + " + " +
                                  a.rest.pi_multiple.str() + " pi");
      if (a.mirrored) point = mirrored(point);
      for (int k = 0; k < a.quarters; ++k) point = {-point.s, point.c};
    }
    return a.negative ? mirrored(point) : point;
  }
  static Point mirrored(const Point& p) { return {p.c, -p.s}; }

  scene::ParameterValues values_;
  Source source_;
  Parameters parameters_;
  mutable std::map<std::string, Point> points_;  ///< angles that were asked for, by their text
};

/** A state of indeterminates: joint positions as points of the circle beside an element for q
    (which is all that a component of a quaternion has), and elements for velocities, accelerations
    and forces.

    The q of a joint that follows another is  multiplier q_leader + offset;  its point is one of its
    own. No formula knows the offset but through that point (and q), and whatever the point, some
    offset leads to it: what holds for every point holds for every offset. */
template <typename Source>
scene::State<typename Source::Scalar> indeterminateState(
    const scene::Mechanism& mechanism, const Source& source,
    Parameters parameters = Parameters::kAsWritten) {
  scene::State<typename Source::Scalar> state;
  const std::vector<scene::SlotKind> slots = mechanism.slots();
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const std::string joint = " of joint " + std::to_string(i);
    scene::CosSin<typename Source::Scalar> point{};
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
  const IndeterminateNumbers<Source> number(mechanism, source, parameters);
  for (const scene::Follower& f : scene::followers(mechanism))
    state.x[f.slot].q =
        number(scene::Number(f.multiplier)) * state.x[f.leader_slot].q + number(f.offset);
  return state;
}

}  // namespace dynwitness::crosscheck
