// SPDX-License-Identifier: GPL-3.0-or-later
// A sweep of recursive/ as a method of the chart, on any scalar, without any allocation.
#pragma once

#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/methods.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

/// Precision of the sweep in balls [bits].
inline constexpr long kChartBallBits = 128;

template <typename T>
scene::JointPosition<T> positionAt(const T& q) {
  return scene::jointPosition(q);
}
inline scene::JointPosition<Ball> positionAt(const Ball& q) {
  scene::CosSin<Ball> point = cosSin(q);
  return {q, std::move(point.c), std::move(point.s)};
}

template <typename T>
std::vector<T> converted(const std::vector<double>& v) {
  return std::vector<T>(v.begin(), v.end());
}

inline const char* methodName(Sweep sweep) {
  switch (sweep) {
    case Sweep::kNewtonEuler:
      return MethodName::kNewtonEuler;
    case Sweep::kCompositeBody:
      return MethodName::kCompositeBody;
    case Sweep::kCompositeBodySolved:
      return MethodName::kCompositeBodySolved;
    case Sweep::kArticulatedBody:
      return MethodName::kArticulatedBody;
  }
  return "?";
}

template <typename Numbers, typename T = typename Numbers::Scalar>
class SweepMethod : public Method {
 public:
  SweepMethod(Sweep sweep, Scalar scalar, const scene::Mechanism& mechanism, const States& states)
      : Method(methodName(sweep), scalar),
        sweep_(sweep),
        setup_(recursive::buildModel(mechanism, Numbers(mechanism))),
        zeros_(setup_.zeros()),
        out_(zeros_),
        M_(zeros_.size(), zeros_.size()) {
    for (const scene::State<double>& s : states) {
      states_.push_back({{}, converted<T>(s.qd), converted<T>(s.qdd), converted<T>(s.tau)});
      for (const scene::JointPosition<double>& x : s.x)
        states_.back().x.push_back({static_cast<T>(x.q), T(0), T(0)});
    }
  }

  void run(int state) override {
    const BallPrecision precision(kChartBallBits);  // for the one scalar that reads it
    scene::State<T>& s = states_[state];
    for (scene::JointPosition<T>& x : s.x) x = positionAt(x.q);
    switch (sweep_) {
      case Sweep::kNewtonEuler:
        recursive::inverseDynamics(setup_.model, s.x, s.qd, s.qdd, setup_.ws, out_);
        break;
      case Sweep::kCompositeBody:
        recursive::massMatrix(setup_.model, s.x, setup_.ws, M_);
        break;
      case Sweep::kCompositeBodySolved:  // M qdd = tau - (c + g - Q)
        recursive::massMatrix(setup_.model, s.x, setup_.ws, M_);
        recursive::inverseDynamics(setup_.model, s.x, s.qd, zeros_, setup_.ws, out_);
        for (std::size_t i = 0; i < out_.size(); ++i) out_[i] = s.tau[i] - out_[i];
        recursive::factorize(M_);
        recursive::solve(M_, out_);
        break;
      case Sweep::kArticulatedBody:
        recursive::forwardDynamics(setup_.model, s.x, s.qd, s.tau, setup_.ws, out_);
        break;
    }
  }
  MatrixX<Ball> answer() const override {
    return exactlyAll<T>(sweep_ == Sweep::kCompositeBody ? M_ : column(out_));
  }

 private:
  Sweep sweep_;
  Setup<T> setup_;
  std::vector<T> zeros_, out_;
  MatrixX<T> M_;
  std::vector<scene::State<T>> states_;
};

}  // namespace dynwitness::crosscheck
