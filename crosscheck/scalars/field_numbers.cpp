// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's numbers in the prime field: rationals as they are, and indeterminates.
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
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

/** What follows from numbers without parameters alone, by their text: every model and program of a
    mechanism asks for the same again, at each point. So many at most, so that memory stays flat. */
template <typename Value>
class ByText {
 public:
  template <typename Make>
  const Value& operator()(const std::string& text, const Make& make) {
    const auto it = known_.find(text);
    if (it != known_.end()) return it->second;
    if (known_.size() >= kMost) known_.clear();
    return known_.emplace(text, make()).first->second;
  }

 private:
  static constexpr std::size_t kMost = 1000;
  std::unordered_map<std::string, Value> known_;
};

/// Without parameters: its text says all.
bool isPlain(const scene::Number& number) {
  return number.kind() == scene::Number::Kind::kNumber || number.parameters().empty();
}

/// reduced(), and the name of its rest, "" for a quarter turn.
struct AngleInWords {
  bool negative, mirrored;
  int quarters;
  std::string rest;
};
AngleInWords inWords(const scene::Exact& angle) {
  const ReducedAngle a = reduced(angle);
  const bool is_quarter = scene::isZero(a.rest.rational) && scene::isZero(a.rest.pi_multiple);
  return {a.negative, a.mirrored, a.quarters,
          is_quarter ? ""
                     : "angle " + a.rest.rational.str() + " + " + a.rest.pi_multiple.str() + " pi"};
}

/// One turn of an AxisTurn: cos and sin as rationals, or signs before a point of the circle.
struct TurnInWords {
  std::string circle = {};  ///< the point's name; empty: c and s themselves
  scene::Rational c = 1, s = 0;
};
struct AxisInWords {
  TurnInWords alpha, beta;
};
int signOf(const scene::Rational& x) {
  return scene::isNegative(x) ? -1 : 1;
}

/** The turns of a rational axis. Parallel axes share their points, whatever their lengths and
    signs; where components are zero the turns are quarter turns.
    @throws std::invalid_argument  the zero vector */
AxisInWords inWords(const scene::Rational& x, const scene::Rational& y, const scene::Rational& z) {
  AxisInWords turn;
  TurnInWords &alpha = turn.alpha, &beta = turn.beta;
  if (scene::isZero(x) && scene::isZero(y)) {
    if (scene::isZero(z)) throw std::invalid_argument("axisTurn: axis: expected a non-zero vector");
    beta.c = signOf(z);
    return turn;
  }
  const scene::Rational rho2 = x * x + y * y;
  scene::Rational rho, length;
  const bool rho_rational = rationalRoot(rho2, &rho);
  if (scene::isZero(x)) {
    alpha = {"", 0, signOf(y)};
  } else if (scene::isZero(y)) {
    alpha = {"", signOf(x), 0};
  } else if (rho_rational) {
    alpha = {"", x / rho, y / rho};
  } else {
    const scene::Rational slope = abs(y / x);
    alpha = {"alpha of slope " + slope.str(), signOf(x), signOf(y)};
  }
  if (scene::isZero(z)) {
    beta = {"", 0, 1};
  } else if (rho_rational && rationalRoot(rho2 + z * z, &length)) {
    beta = {"", z / length, rho / length};
  } else {
    const scene::Rational slope2 = z * z / rho2;
    beta = {"beta of squared slope " + slope2.str(), signOf(z), 1};
  }
  return turn;
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
  if (radians.isLiteralZero()) return {PrimeField(1), PrimeField(0)};
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
  const auto inRationals = [&]() -> std::optional<AxisInWords> {
    for (int i = 0; i < 3; ++i) {
      v[i] = exactly(axis[i]);
      if (!isKnown(axis[i]) || !scene::isZero(v[i].pi_multiple)) return {};
    }
    return inWords(v[0].rational, v[1].rational, v[2].rational);
  };
  const std::string text = axis[0].text() + ", " + axis[1].text() + ", " + axis[2].text();
  static thread_local ByText<std::optional<AxisInWords>> axes;
  const bool is_plain = isPlain(axis[0]) && isPlain(axis[1]) && isPlain(axis[2]);
  const auto turned = [&](const TurnInWords& turn) -> Point {
    if (turn.circle.empty()) return {source_.constant(turn.c), source_.constant(turn.s)};
    const Point p = source_.circlePoint(turn.circle);
    return {PrimeField(signOf(turn.c)) * p.c, PrimeField(signOf(turn.s)) * p.s};
  };
  if (const auto words = is_plain ? axes(text, inRationals) : inRationals())
    return {turned(words->alpha), turned(words->beta)};

  std::array<bool, 3> is_zero;
  for (int i = 0; i < 3; ++i) {
    v[i] = exactly(axis[i]);
    is_zero[i] =
        isKnown(axis[i]) && scene::isZero(v[i].pi_multiple) && scene::isZero(v[i].rational);
  }
  const auto sign = [&](int i) { return PrimeField(scene::isNegative(v[i]) ? -1 : 1); };
  // where components are zero the turns are quarter turns, whatever the others are
  const bool alpha_known = is_zero[0] || is_zero[1];
  const bool beta_known = is_zero[2] || (is_zero[0] && is_zero[1]);
  scene::AxisTurn<PrimeField> turn{{PrimeField(1), PrimeField(0)}, {PrimeField(0), PrimeField(1)}};
  if (is_zero[0] && !is_zero[1]) turn.alpha = {PrimeField(0), sign(1)};
  if (is_zero[1] && !is_zero[0]) turn.alpha = {sign(0), PrimeField(0)};
  if (is_zero[0] && is_zero[1]) turn.beta = {sign(2), PrimeField(0)};
  if (!alpha_known) turn.alpha = source_.circlePoint("alpha of " + text);
  if (!beta_known) turn.beta = source_.circlePoint("beta of " + text);
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
  const auto make = [&] { return inWords(exactly(radians)); };
  static thread_local ByText<AngleInWords> angles;
  const AngleInWords a = isPlain(radians) ? angles(radians.text(), make) : make();
  Point point = scene::quarterTurns<PrimeField>(a.quarters);
  if (!a.rest.empty()) {
    point = source_.circlePoint(a.rest);
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
