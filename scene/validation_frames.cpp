// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers and frames of a scene as rationals, while a scene is validated (validation.cpp says how
// they are rounded).
#include "scene/validator.hpp"

namespace dynwitness::scene::validation {
namespace {

/** The number itself while it is short; of a long one its first 256 bits, and *is_exact is false
    then. Sums and products over many links grow by the denominators of all: without this a row of
    1000 fixed links takes hours. n roundings of 2^-256 stay below the slack of 1e-40 for any n. */
Rational bounded(const Rational& x, bool* is_exact) {
  constexpr unsigned kMostBits = 2048, kKeptBits = 256;
  if (x.is_zero()) return x;
  const unsigned above = msb(abs(numerator(x))), below = msb(denominator(x));
  if (above <= kMostBits && below <= kMostBits) return x;
  *is_exact = false;
  const int shift = static_cast<int>(kKeptBits) + static_cast<int>(below) - static_cast<int>(above);
  if (shift >= 0) return Rational((numerator(x) << shift) / denominator(x), Integer(1) << shift);
  return Rational(numerator(x) / (denominator(x) << -shift)) * (Integer(1) << -shift);
}

struct SineAndCosine {
  Rational sine, cosine;
  bool is_exact;
};

/// Exact for multiples of pi/2, otherwise with an error below 1e-60.
SineAndCosine sineAndCosine(const Exact& angle) {
  constexpr unsigned kBits = 256;  // of fixed point: plain rationals would grow without bound
  const FixedSineCosine fixed = fixedSineCosine(angle, kBits);
  const Integer one = Integer(1) << kBits;
  return {Rational(fixed.sine, one), Rational(fixed.cosine, one), fixed.error == 0};
}

}  // namespace

Frame operator*(const Frame& a, const Frame& b) {
  const RationalVector moved = a.R * b.p;
  return {a.R * b.R, {a.p[0] + moved[0], a.p[1] + moved[1], a.p[2] + moved[2]}};
}

Rational Validator::value(const Number& n) {
  const Exact x = exactValue(n, values_, file_);
  is_exact_ = is_exact_ && x.isRational() &&
              errorOfFunctions(n, values_, parameter_errors_, file_).is_zero();
  return x.approximation();
}

Rational Validator::shortened(const Rational& x) {
  return bounded(x, &is_exact_);
}

Frame Validator::shortened(Frame f) {
  for (std::size_t i = 0; i < 3; ++i) {
    f.p[i] = shortened(f.p[i]);
    for (Rational& element : f.R[i]) element = shortened(element);
  }
  return f;
}

Frame Validator::frame(const std::vector<Step>& steps) {
  Frame result;
  for (const Step& step : steps) {
    if (step.kind == Step::Kind::kTranslate) {
      result = result * Frame{identity(), vector(step.translation)};
      continue;
    }
    result = result * Frame{turn(step), {0, 0, 0}};
  }
  return result;
}

RationalMatrix Validator::turn(const Step& step) {
  const auto [s, c, is_exact] = sineAndCosine(exactValue(step.angle, values_, file_));
  is_exact_ = is_exact_ && is_exact;
  switch (step.kind) {
    case Step::Kind::kRotateX:
      return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
    case Step::Kind::kRotateY:
      return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
    default:
      return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
  }
}

RationalVector Validator::turned(const std::vector<Step>& steps, RationalVector v) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step)
    if (step->kind != Step::Kind::kTranslate) v = turn(*step) * v;
  return v;
}

RationalMatrix Validator::turnOf(const Vector& rpy) {
  Placement turn;
  turn.rpy = rpy;
  return frame(turn.beforeJoint()).R;
}

Rational Validator::slack(const Rational& scale) const {
  return is_exact_ ? Rational(0) : scale / boost::multiprecision::pow(Integer(10), 40);
}

}  // namespace dynwitness::scene::validation
