// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/implicit.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/motion/collocation.hpp"

namespace dynwitness::crosscheck {
namespace {

using State = ClosedMotion::State;

}  // namespace

RadauIIA::RadauIIA(ClosedMotion& motion, int stages, Formulation formulation)
    : motion_(motion), s_(stages), formulation_(formulation) {
  const Tableau<double> tableau(Nodes::kRadau, stages);
  c_ = tableau.c;
  A_ = tableau.A;
  lambda_ = Vector::Zero(motion.rows());
}

int RadauIIA::size() const {
  const int rows = static_cast<int>(motion_.chosen().size());
  return static_cast<int>(motion_.freePositions().size()) + motion_.freedoms() +
         (formulation_ == Formulation::kGgl ? 2 : 1) * rows;
}

void RadauIIA::start(const State& y, double time) {
  const auto solution = motion_.accelerations(y, time);
  State rate(y.size());
  motion_(y, rate, time);
  last_ = Vector::Zero(size());
  const auto& slots = motion_.freePositions();
  const int np = static_cast<int>(slots.size()), n = motion_.freedoms();
  for (int k = 0; k < np; ++k) last_(k) = rate[slots[k]];
  last_.segment(np, n) = solution.qdd(motion_.freeRates());
  last_.segment(np + n, motion_.chosen().size()) = solution.lambda(motion_.chosen());
  lambda_ = solution.lambda;
  rows_ = motion_.chosen();
  linearized_for_ = 0;
}

RadauIIA::Vector RadauIIA::residual(const State& at, const Vector& unknown, double time, double h,
                                    double* power) {
  const auto& slots = motion_.freePositions();
  const Eigen::Index np = static_cast<Eigen::Index>(slots.size()), n = motion_.freedoms(),
                     m = static_cast<Eigen::Index>(motion_.chosen().size());
  const bool ggl = formulation_ == Formulation::kGgl;
  const auto r = motion_.residuals(at, unknown.segment(np, n), unknown.segment(np + n, m),
                                   ggl ? Vector(unknown.tail(m)) : Vector(), time);
  if (power) *power = r.power;
  Vector out(size());
  out.head(np) = unknown.head(np) - r.position_rates(slots);  // (2)
  out.segment(np, n) = r.force(motion_.freeRates());          // (3)
  switch (formulation_) {                                     // (4)
    case Formulation::kIndex1:
      out.tail(m) = r.second;
      break;
    case Formulation::kIndex2:
      out.tail(m) = r.rate / h;
      break;
    case Formulation::kIndex3:
      out.tail(m) = r.phi / (h * h);
      break;
    case Formulation::kGgl:
      out.segment(np + n, m) = r.rate / h;
      out.tail(m) = r.phi / h;
      break;
  }
  return out;
}

State RadauIIA::stage(const State& from, const Vector& unknowns, int i, double h) const {
  const auto &slots = motion_.freePositions(), &rates = motion_.freeRates();
  const int np = static_cast<int>(slots.size()), n = static_cast<int>(rates.size()), N = size();
  State at = from;
  for (int j = 0; j < s_; ++j) {  // (1)
    for (int k = 0; k < np; ++k) at[slots[k]] += h * A_(i, j) * unknowns(j * N + k);
    for (int k = 0; k < n; ++k)
      at[motion_.positions() + rates[k]] += h * A_(i, j) * unknowns(j * N + np + k);
  }
  return at;
}

/// The matrix of Newton's method at these unknowns: each stage's own derivatives, by differences.
void RadauIIA::linearize(const State& y, const Vector& unknowns, double time, double h) {
  const auto &slots = motion_.freePositions(), &rates = motion_.freeRates();
  const int np = static_cast<int>(slots.size()), n = static_cast<int>(rates.size()), N = size();
  const double small = std::sqrt(std::numeric_limits<double>::epsilon());
  Matrix all = Matrix::Zero(s_ * N, s_ * N);
  for (int i = 0; i < s_; ++i) {
    const State at = stage(y, unknowns, i, h);
    const Vector unknown = unknowns.segment(i * N, N);
    const double t = time + c_[i] * h;
    const Vector here = residual(at, unknown, t, h);
    Matrix by_state(N, np + n), direct(N, N);
    for (int k = 0; k < np + n; ++k) {
      State moved = at;
      double& value = k < np ? moved[slots[k]] : moved[motion_.positions() + rates[k - np]];
      const double before = value;
      value += small * (1 + std::abs(before));
      by_state.col(k) = (residual(moved, unknown, t, h) - here) / (value - before);
    }
    for (int k = 0; k < N; ++k) {  // linear: a step of one
      Vector moved = unknown;
      moved(k) += 1;
      direct.col(k) = residual(at, moved, t, h) - here;
    }
    all.block(i * N, i * N, N, N) = direct;
    for (int j = 0; j < s_; ++j) all.block(i * N, j * N, N, np + n) += h * A_(i, j) * by_state;
  }
  lu_.compute(all);
  linearized_for_ = h;
}

/** Newton's method. While an update is less than half the one before, the matrix is kept; when it
    is not, that is either rounding, and the end, or the matrix is too old and is made anew. */
bool RadauIIA::solve(const State& y, double time, double h, Vector* unknowns) {
  constexpr int kMostSteps = 60;
  const int N = size();
  const double eps = std::numeric_limits<double>::epsilon();
  bool is_fresh = false;
  if (!(std::abs(linearized_for_ - h) <= h * std::sqrt(eps))) {
    linearize(y, *unknowns, time, h);
    is_fresh = true;
  }
  double before = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kMostSteps; ++k) {
    Vector r(s_ * N);
    for (int i = 0; i < s_; ++i)
      r.segment(i * N, N) =
          residual(stage(y, *unknowns, i, h), unknowns->segment(i * N, N), time + c_[i] * h, h);
    const Vector change = lu_.solve(r);
    // what it moves the positions: there rounding is eps, whatever the index (eps / h^2 in
    // accelerations)
    double now = 0;
    const auto &slots = motion_.freePositions(), &rates = motion_.freeRates();
    const int np = static_cast<int>(slots.size()), n = static_cast<int>(rates.size());
    for (int i = 0; i < s_; ++i) {
      for (int e = 0; e < np; ++e)
        now = std::max(now, h * std::abs(change(i * N + e)) / (1 + std::abs(y[slots[e]])));
      now = std::max(now, h * h * change.segment(i * N + np, n).cwiseAbs().maxCoeff());
    }
    if (!std::isfinite(now)) return false;
    if (!(now < before / 2)) {
      constexpr double kSomeRoundings =
          64;  // of sums of that many terms; an old matrix may stall above
      if (before <= (is_fresh ? std::sqrt(eps) : kSomeRoundings * eps)) return true;
      linearize(y, *unknowns, time, h);
      is_fresh = true;
      before = std::numeric_limits<double>::infinity();
      continue;
    }
    *unknowns -= change;
    if (now == 0) return true;
    before = now;
  }
  return false;
}

void RadauIIA::step(State* y, double time, double end) {
  const double h = end - time;
  motion_.impose(time, y);
  const int N = size();
  if (rows_ != motion_.chosen()) start(*y, time);
  const auto guess = [&] {
    Vector all(s_ * N);
    for (int i = 0; i < s_; ++i) all.segment(i * N, N) = last_;
    return all;
  };
  Vector unknowns = guess();
  if (!solve(*y, time, h, &unknowns)) {
    linearized_for_ = 0;
    unknowns = guess();
    if (!solve(*y, time, h, &unknowns))
      throw std::runtime_error(fmt::format(
          "simulate: Newton's method does not converge in the step of {} s at t = {} s, allowed: "
          "shorter "
          "steps",
          h, time));
  }
  double work = y->back();
  for (int i = 0; i < s_; ++i) {
    double power = 0;
    residual(stage(*y, unknowns, i, h), unknowns.segment(i * N, N), time + c_[i] * h, h, &power);
    work += h * A_(s_ - 1, i) * power;
  }
  *y = stage(*y, unknowns, s_ - 1, h);
  y->back() = work;
  motion_.impose(end, y);
  last_ = unknowns.tail(N);
  const Eigen::Index m = static_cast<Eigen::Index>(motion_.chosen().size());
  lambda_.setZero();
  lambda_(motion_.chosen()) = last_.segment(
      static_cast<Eigen::Index>(motion_.freePositions().size()) + motion_.freedoms(), m);
}

}  // namespace dynwitness::crosscheck
