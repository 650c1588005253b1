// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/LU>

#include "crosscheck/motion/collocation.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/step_makers.hpp"

namespace dynwitness::crosscheck {
namespace {

template <typename T>
class SemiImplicitEuler : public Steps<T> {
 public:
  using State = std::vector<T>;
  explicit SemiImplicitEuler(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    const int first = equations_.positions(), n = equations_.dof();
    State rate(y->size()), u(n);
    equations_.rate(*y, time, &rate);
    for (int i = 0; i < n; ++i) {
      (*y)[first + i] += h * rate[first + i];
      u[i] = h * (*y)[first + i];
    }
    y->back() += h * rate.back();
    equations_.move(y, u);
  }

 private:
  MotionEquations<T>& equations_;
};

template <typename T>
class StormerVerlet : public Steps<T> {
 public:
  using State = std::vector<T>;
  explicit StormerVerlet(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    constexpr int kMostIterations = 60;
    const int first = equations_.positions(), n = equations_.dof();
    p_0_ = equations_.momentum(*y);
    start_ = end_ = *y;
    const T work = equations_.power(*y, time);
    Vector v = Eigen::Map<const Vector>(y->data() + first, n);
    Eigen::PartialPivLU<Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>> lu;
    T before = std::numeric_limits<T>::infinity();
    for (int k = 0;; ++k) {
      const Vector left = residual(v, h);
      // M(q_0) stands for the derivative, which it is where M is constant and nothing damps; where
      // that does not do, it is made of differences
      if (k == kDifferences) lu.compute(derivative(v, left, h));
      Vector change;
      if (k < kDifferences) {
        const State solved = equations_.velocity(start_, State(left.data(), left.data() + n));
        change = Eigen::Map<const Vector>(solved.data(), n);
      } else {
        change = lu.solve(left);
      }
      T now = 0;
      for (int i = 0; i < n; ++i)
        keepWorse(&now, T(std::abs(h * change(i)) / (1 + std::abs(start_[i]))));
      if (!std::isfinite(now) || k == kMostIterations)
        throw std::runtime_error(
            fmt::format("the discrete Euler-Lagrange equations have no solution near by: the step "
                        "of {} s at t = {} s is too long",
                        static_cast<double>(h), static_cast<double>(time)));
      // it ends where the change is nothing that y can show, or falls no more, which is rounding
      if (now <= std::numeric_limits<T>::epsilon() / kSomeRoundings ||
          (!(now < before) && now <= sqrtOfEps<T>()))
        break;
      before = now;
      v += change;
    }
    residual(v, h);  // leaves start_, end_, half_ at v
    const State pull = equations_.pull(end_);
    State p_1(n);
    for (int i = 0; i < n; ++i) p_1[i] = half_[i] + h / 2 * pull[i];
    const State qd = equations_.velocity(end_, p_1);
    std::copy(qd.begin(), qd.end(), end_.begin() + first);
    end_.back() += h / 2 * (work + equations_.power(end_, time + h));
    *y = end_;
  }

 private:
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  static constexpr int kDifferences = 12;  ///< iterations before the derivative is made

  /// p_0 + h/2 pull(q_0, v) - (M(q_0) + M(q_1)) v / 2
  Vector residual(const Vector& v, T h) {
    const int first = equations_.positions(), n = equations_.dof();
    for (int i = 0; i < n; ++i) {
      start_[first + i] = end_[first + i] = v(i);
      end_[i] = start_[i] + h * v(i);
    }
    const State p = equations_.momentum(start_), q = equations_.momentum(end_),
                pull = equations_.pull(start_);
    Vector left(n);
    half_.resize(n);
    for (int i = 0; i < n; ++i) {
      half_[i] = (p[i] + q[i]) / 2;
      left(i) = p_0_[i] + h / 2 * pull[i] - half_[i];
    }
    return left;
  }
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> derivative(const Vector& v, const Vector& left,
                                                              T h) {
    const auto n = v.size();
    Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> J(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      Vector moved = v;
      moved(j) += sqrtOfEps<T>() * (1 + std::abs(v(j)));
      J.col(j) = (left - residual(moved, h)) / (moved(j) - v(j));
    }
    return J;
  }

  MotionEquations<T>& equations_;
  State p_0_, start_, end_, half_;
};

template <typename T>
class LieRungeKutta : public Steps<T> {
 public:
  using State = std::vector<T>;
  explicit LieRungeKutta(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    const int n = equations_.dof();
    const Slope k_1 = slope(*y, State(n, T(0)), time),
                k_2 = slope(moved(*y, k_1, h / 2), scaled(k_1.u, h / 2), time + h / 2),
                k_3 = slope(moved(*y, k_2, h / 2), scaled(k_2.u, h / 2), time + h / 2),
                k_4 = slope(moved(*y, k_3, h), scaled(k_3.u, h), time + h);
    Slope all = k_1;
    const auto add = [](State* sum, const State& a, const State& b, const State& c) {
      for (std::size_t i = 0; i < sum->size(); ++i)
        (*sum)[i] = ((*sum)[i] + 2 * a[i] + 2 * b[i] + c[i]) / 6;
    };
    add(&all.u, k_2.u, k_3.u, k_4.u);
    add(&all.rest, k_2.rest, k_3.rest, k_4.rest);
    *y = moved(*y, all, h);
  }

 private:
  struct Slope {
    State u, rest;  ///< of exp's argument; of rates and work
  };
  static State scaled(State u, T h) {
    for (T& x : u) x *= h;
    return u;
  }
  State moved(State y, const Slope& slope, T h) const {
    equations_.move(&y, scaled(slope.u, h));
    for (std::size_t i = 0; i < slope.rest.size(); ++i)
      y[equations_.positions() + i] += h * slope.rest[i];
    return y;
  }
  Slope slope(const State& y, const State& u, T time) const {
    const int first = equations_.positions();
    State rate(y.size());
    equations_.rate(y, time, &rate);
    Slope out{State(y.begin() + first, y.end() - 1), State(rate.begin() + first, rate.end())};
    const State once = equations_.commutator(u, out.u), twice = equations_.commutator(u, once);
    for (std::size_t i = 0; i < out.u.size(); ++i) out.u[i] += once[i] / 2 + twice[i] / 12;
    return out;
  }

  MotionEquations<T>& equations_;
};

template <template <typename> class Made>
struct Ours {
  template <typename T>
  static std::unique_ptr<Steps<T>> make(MotionEquations<T>& equations) {
    return std::make_unique<Made<T>>(equations);
  }
};
template <typename T, int Stages, Nodes Kind>
std::unique_ptr<Steps<T>> collocated(MotionEquations<T>& equations) {
  return std::make_unique<Collocation<T>>(equations, Stages, Kind);
}

}  // namespace

template <typename T>
std::vector<StepMaker<T>> ownSteps() {
  return {Ours<SemiImplicitEuler>::make<T>, Ours<StormerVerlet>::make<T>,
          collocated<T, 1, Nodes::kGauss>,  collocated<T, 2, Nodes::kGauss>,
          collocated<T, 3, Nodes::kGauss>,  collocated<T, 1, Nodes::kRadau>,
          collocated<T, 2, Nodes::kRadau>,  collocated<T, 3, Nodes::kRadau>,
          Ours<LieRungeKutta>::make<T>};
}

template std::vector<StepMaker<double>> ownSteps();
template std::vector<StepMaker<long double>> ownSteps();

}  // namespace dynwitness::crosscheck
