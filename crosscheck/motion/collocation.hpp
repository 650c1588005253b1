// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit Runge-Kutta methods by collocation at Gauss's or Radau's nodes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <Eigen/LU>

#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"

namespace dynwitness::crosscheck {

enum class Nodes { kGauss, kRadau };

/// Of sums of that many terms.
inline constexpr int kSomeRoundings = 64;
template <typename T>
T sqrtOfEps() {
  return std::sqrt(std::numeric_limits<T>::epsilon());
}

/// Zeros of Legendre's or Radau's polynomial in [0, 1], one to three stages.
template <typename T>
std::vector<T> nodesOf(Nodes kind, int stages) {
  using std::sqrt;
  const T half = T(1) / 2;
  if (kind == Nodes::kGauss) {
    if (stages == 1) return {half};
    if (stages == 2) return {half - sqrt(T(3)) / 6, half + sqrt(T(3)) / 6};
    return {half - sqrt(T(15)) / 10, half, half + sqrt(T(15)) / 10};
  }
  if (stages == 1) return {T(1)};
  if (stages == 2) return {T(1) / 3, T(1)};
  return {(4 - sqrt(T(6))) / 10, (4 + sqrt(T(6))) / 10, T(1)};
}

/// c, A and b of the method at these nodes:
///     sum_j a_ij c_j^(m-1) = c_i^m / m,  b the same at c = 1.
template <typename T>
struct Tableau {
  std::vector<T> c;
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> A;
  Eigen::Matrix<T, Eigen::Dynamic, 1> b;

  Tableau(Nodes kind, int stages) : c(nodesOf<T>(kind, stages)) {
    using std::pow;
    using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
    Matrix powers(stages, stages), integrals(stages, stages);
    Eigen::Matrix<T, Eigen::Dynamic, 1> whole(stages);
    for (int m = 1; m <= stages; ++m) {
      for (int j = 0; j < stages; ++j) {
        powers(j, m - 1) = pow(c[j], T(m - 1));
        integrals(j, m - 1) = pow(c[j], T(m)) / m;
      }
      whole(m - 1) = T(1) / m;
    }
    const Matrix back = powers.inverse();
    A = integrals * back;
    b = back.transpose() * whole;
  }
};

/** A step is a polynomial that fulfils the equations at the nodes c_i:

        k_i = f(z_0 + h sum_j a_ij k_j),   z_1 = z_0 + h sum_j b_j k_j

    with sum_j a_ij c_j^(m-1) = c_i^m / m and b the same at c = 1. At Gauss's nodes z is (q, p,
    work) where there are momenta; otherwise, and at Radau's, y. Newton's method with a matrix that
    is kept as long as the updates fall to half; with a new one it ends where they fall no more. */
template <typename T>
class Collocation : public Steps<T> {
 public:
  using State = std::vector<T>;
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

  Collocation(MotionEquations<T>& equations, int stages, Nodes kind)
      : equations_(equations),
        s_(stages),
        canonical_(kind == Nodes::kGauss && equations.hasMomenta()),
        tableau_(kind, stages) {}

  void step(State* y, T time, T h) override {
    z_ = *y;
    if (canonical_) replaceRates(&z_, equations_.momentum(*y));
    if (last_.size() != static_cast<Eigen::Index>(z_.size())) last_ = slope(z_, time);
    Matrix k = last_.replicate(1, s_);
    if (!solve(time, h, &k)) {
      linearized_for_ = 0;
      k = slope(z_, time).replicate(1, s_);
      if (!solve(time, h, &k))
        throw std::runtime_error(
            fmt::format("Newton's method does not converge in the step of {} s at t = {} s, "
                        "allowed: shorter steps",
                        static_cast<double>(h), static_cast<double>(time)));
    }
    last_ = k.col(s_ - 1);
    const Vector change = h * (k * tableau_.b);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] += change(i);
    *y = z_;
    if (canonical_) {
      const int first = equations_.positions();
      replaceRates(y, equations_.velocity(
                          z_, State(z_.begin() + first, z_.begin() + first + equations_.dof())));
    }
  }
  void forget() override { last_.resize(0); }

 private:
  void replaceRates(State* z, const State& by) const {
    std::copy(by.begin(), by.end(), z->begin() + equations_.positions());
  }

  Vector slope(const State& z, T time) {
    State out(z.size());
    if (!canonical_) {
      equations_.rate(z, time, &out);
    } else {
      const int n = equations_.dof();
      State y = z;
      const State qd = equations_.velocity(z, State(z.begin() + n, z.begin() + 2 * n));
      replaceRates(&y, qd);
      std::copy(qd.begin(), qd.end(), out.begin());
      const State pull = equations_.pull(y);
      std::copy(pull.begin(), pull.end(), out.begin() + n);
      out.back() = equations_.power(y, time);
    }
    return Eigen::Map<const Vector>(out.data(), static_cast<Eigen::Index>(out.size()));
  }

  State stage(const Matrix& k, int i, T h) const {
    State at = z_;
    const Vector change = h * (k * tableau_.A.row(i).transpose());
    for (std::size_t e = 0; e < at.size(); ++e) at[e] += change(e);
    return at;
  }

  /// 1 - h A x df/dz, with df/dz of the start; work feeds nothing back.
  void linearize(T time, T h) {
    const auto d = static_cast<Eigen::Index>(z_.size());
    const Vector here = slope(z_, time);
    Matrix J = Matrix::Zero(d, d);
    for (Eigen::Index j = 0; j + 1 < d; ++j) {
      State moved = z_;
      moved[j] += sqrtOfEps<T>() * (1 + std::abs(moved[j]));
      J.col(j) = (slope(moved, time) - here) / (moved[j] - z_[j]);
    }
    Matrix all = Matrix::Identity(s_ * d, s_ * d);
    for (int i = 0; i < s_; ++i)
      for (int j = 0; j < s_; ++j) all.block(i * d, j * d, d, d) -= h * tableau_.A(i, j) * J;
    lu_.compute(all);
    linearized_for_ = h;
  }

  bool solve(T time, T h, Matrix* k) {
    constexpr int kMostIterations = 60;
    const auto d = static_cast<Eigen::Index>(z_.size());
    const T eps = std::numeric_limits<T>::epsilon();
    bool is_fresh = false;
    if (!(std::abs(linearized_for_ - h) <= h * sqrtOfEps<T>())) {
      linearize(time, h);
      is_fresh = true;
    }
    T before = std::numeric_limits<T>::infinity();
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      Vector left(s_ * d);
      for (int i = 0; i < s_; ++i)
        left.segment(i * d, d) = k->col(i) - slope(stage(*k, i, h), time + tableau_.c[i] * h);
      const Vector change = lu_.solve(left);
      T now = 0;
      for (int i = 0; i < s_; ++i)
        for (Eigen::Index e = 0; e < d; ++e)
          keepWorse(&now, T(std::abs(h * change(i * d + e)) / (1 + std::abs(z_[e]))));
      if (!std::isfinite(now)) return false;
      if (is_fresh ? !(now < before) : !(now < before / 2)) {
        if (before <= (is_fresh ? sqrtOfEps<T>() : kSomeRoundings * eps)) return true;
        if (is_fresh && iteration > 0) return false;
        linearize(time, h);
        is_fresh = true;
        before = std::numeric_limits<T>::infinity();
        continue;
      }
      for (int i = 0; i < s_; ++i) k->col(i) -= change.segment(i * d, d);
      // nothing that z can show: a cyclic momentum's change may shrink on and on
      if (now <= eps / kSomeRoundings) return true;
      before = now;
    }
    return false;
  }

  MotionEquations<T>& equations_;
  int s_;
  bool canonical_;
  Tableau<T> tableau_;
  Vector last_;
  State z_;
  Eigen::PartialPivLU<Matrix> lu_;
  T linearized_for_ = 0;
};

}  // namespace dynwitness::crosscheck
