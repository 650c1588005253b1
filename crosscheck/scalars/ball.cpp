// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/ball.hpp"

#include "scene/mimic.hpp"

#include <iterator>
#include <vector>

namespace dynwitness::crosscheck {
namespace {

using scene::Exact;
using scene::Integer;
using scene::Rational;

/// An integer of FLINT.
class FlintInteger {
 public:
  explicit FlintInteger(const Integer& value) {
    fmpz_init(z_);
    std::vector<mp_limb_t> limbs;
    export_bits(Integer(boost::multiprecision::abs(value)), std::back_inserter(limbs), FLINT_BITS,
                false);
    fmpz_set_ui_array(z_, limbs.data(), static_cast<slong>(limbs.size()));
    if (value < 0) fmpz_neg(z_, z_);
  }
  ~FlintInteger() { fmpz_clear(z_); }
  FlintInteger(const FlintInteger&) = delete;
  FlintInteger& operator=(const FlintInteger&) = delete;
  const fmpz* get() const { return z_; }

 private:
  fmpz_t z_;
};

/// A float of Arb that is cleared at the end of its scope.
struct Float {
  Float() { arf_init(x); }
  ~Float() { arf_clear(x); }
  Float(const Float&) = delete;
  Float& operator=(const Float&) = delete;
  arf_t x;
};

int sign(const Exact& x) {
  if (x.isZero()) return 0;
  return x.approximation() < 0 ? -1 : 1;
}

}  // namespace

Ball::Ball(long double value) : Ball() {
  const double high = static_cast<double>(value), low = static_cast<double>(value - high);
  arb_set_d(x_, high);
  if (low != 0) {
    Float rest;
    arf_set_d(rest.x, low);
    arf_add(arb_midref(x_), arb_midref(x_), rest.x, ARF_PREC_EXACT, ARF_RND_NEAR);
  }
}

Ball::Ball(const Rational& value) : Ball() {
  const FlintInteger top(numerator(value)), bottom(denominator(value));
  arb_fmpz_div_fmpz(x_, top.get(), bottom.get(), BallPrecision::bits());
}

Ball Ball::pi() {
  Ball r;
  arb_const_pi(r.x_, BallPrecision::bits());
  return r;
}

Ball abs(const Ball& a) {
  Ball r;
  arb_abs(r.x_, a.x_);
  return r;
}

Ball sqrt(const Ball& a) {
  Ball r;
  arb_sqrt(r.x_, a.x_, BallPrecision::bits());
  return r;
}

scene::CosSin<Ball> cosSin(const Ball& angle) {
  scene::CosSin<Ball> point;
  arb_sin_cos(point.s.x_, point.c.x_, angle.x_, BallPrecision::bits());
  return point;
}

bool Ball::contains(const Rational& value) const {
  const FlintInteger top(numerator(value)), bottom(denominator(value));
  fmpq_t q;
  fmpq_init(q);
  fmpq_set_fmpz_frac(q, top.get(), bottom.get());
  const bool inside = arb_contains_fmpq(x_, q) != 0;
  fmpq_clear(q);
  return inside;
}

bool Ball::isSharp(long bits) const {
  mag_t smallest, scaled_radius;
  mag_init(smallest);
  mag_init(scaled_radius);
  arb_get_mag_lower(smallest, x_);
  mag_mul_2exp_si(scaled_radius, arb_radref(x_), bits);
  const bool sharp = arb_is_exact(x_) || mag_cmp(scaled_radius, smallest) < 0;
  mag_clear(smallest);
  mag_clear(scaled_radius);
  return sharp;
}

double Ball::mid() const {
  return arf_get_d(arb_midref(x_), ARF_RND_NEAR);
}

double Ball::radius() const {
  Float r;
  arf_set_mag(r.x, arb_radref(x_));
  return arf_get_d(r.x, ARF_RND_UP);
}

double Ball::atLeast() const {
  Float r;
  arb_get_abs_lbound_arf(r.x, x_, 53);
  return arf_get_d(r.x, ARF_RND_DOWN);
}

double Ball::atMost() const {
  Float r;
  arb_get_abs_ubound_arf(r.x, x_, 53);
  return arf_get_d(r.x, ARF_RND_UP);
}

std::string Ball::text(int digits) const {
  char* written = arb_get_str(x_, digits, 0);
  std::string text(written);
  flint_free(written);
  return text;
}

Ball BallNumbers::operator()(const scene::Number& number) const {
  const Exact exact = scene::exactValue(number, values_);
  Ball value(exact.rational);
  if (!exact.isRational()) value += Ball(exact.pi_multiple) * Ball::pi();
  return value;
}

scene::CosSin<Ball> BallNumbers::angle(const scene::Number& radians) const {
  int k = 0;
  if (scene::isQuarterTurn(scene::exactValue(radians, values_), &k))
    return scene::quarterTurns<Ball>(k);
  return cosSin((*this)(radians));
}

scene::AxisTurn<Ball> BallNumbers::axisTurn(const scene::Vector& axis) const {
  int signs[3];
  for (int i = 0; i < 3; ++i) signs[i] = sign(scene::exactValue(axis[i], values_));
  const bool has_x = signs[0] != 0, has_y = signs[1] != 0, has_z = signs[2] != 0;
  if (!has_x && !has_y && !has_z)
    throw std::invalid_argument("axisTurn: axis: expected a non-zero vector");
  const Ball x = (*this)(axis[0]), y = (*this)(axis[1]), z = (*this)(axis[2]);
  const Ball rho = sqrt(x * x + y * y), length = sqrt(x * x + y * y + z * z);
  // quotients that are 0, 1 or -1 whatever the length, without the rounding of its root
  scene::AxisTurn<Ball> turn{{1, 0}, {signs[2], 1}};
  if (has_x && has_y)
    turn.alpha = {x / rho, y / rho};
  else if (has_x || has_y)
    turn.alpha = {signs[0], signs[1]};
  if (has_z) turn.beta.s = 0;
  if (has_z && (has_x || has_y)) turn.beta = {z / length, rho / length};
  return turn;
}

scene::State<Ball> ballState(const scene::State<double>& state) {
  scene::State<Ball> out;
  for (const scene::JointPosition<double>& x : state.x) {
    const Ball q = x.q;
    scene::CosSin<Ball> point = cosSin(q);
    out.x.push_back({q, std::move(point.c), std::move(point.s)});
  }
  out.qd.assign(state.qd.begin(), state.qd.end());
  out.qdd.assign(state.qdd.begin(), state.qdd.end());
  out.tau.assign(state.tau.begin(), state.tau.end());
  return out;
}

scene::State<Ball> ballState(const scene::State<double>& state, const scene::Mechanism& mechanism) {
  scene::State<Ball> out = ballState(state);
  const BallNumbers number(mechanism);
  for (const scene::Follower& f : scene::followers(mechanism)) {
    const Ball q = number(scene::Number(f.multiplier)) * out.x[f.leader_slot].q + number(f.offset);
    scene::CosSin<Ball> point = cosSin(q);
    out.x[f.slot] = {q, std::move(point.c), std::move(point.s)};
  }
  return out;
}

}  // namespace dynwitness::crosscheck
