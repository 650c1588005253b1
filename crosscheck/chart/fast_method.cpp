// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps that are made for speed, in a chart.
#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/timed_apart.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/fast/dynamics.hpp"

namespace dynwitness::crosscheck {
namespace {

class FastMethod : public Method {
 public:
  FastMethod(Quantity quantity, const scene::Mechanism& mechanism, const States& states)
      : Method(kFastMethod, Scalar::kDouble),
        quantity_(quantity),
        sweeps_(recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism))),
        states_(states),
        out_(mechanism.dof(), quantity == Quantity::kM ? mechanism.dof() : 1) {
    for (const scene::State<double>& state : states) {
      q_.emplace_back();
      for (const scene::JointPosition<double>& x : state.x) q_.back().push_back(x.q);
    }
  }

  void run(int state) override {
    const double* q = q_[state].data();
    const scene::State<double>& s = states_[state];
    if (quantity_ == Quantity::kM)
      sweeps_.massMatrix(q, out_.data());
    else if (quantity_ == Quantity::kQdd)
      sweeps_.forwardDynamics(q, s.qd.data(), s.tau.data(), out_.data());
    else
      sweeps_.inverseDynamics(q, s.qd.data(), s.qdd.data(), out_.data());
  }
  MatrixX<Ball> answer() const override { return exactlyAll<double>(out_); }

 private:
  Quantity quantity_;
  recursive::fast::Dynamics sweeps_;
  States states_;
  std::vector<std::vector<double>> q_;
  MatrixX<double> out_;
};

}  // namespace

std::unique_ptr<Method> fastMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                   const States& states) {
  return std::make_unique<FastMethod>(quantity, mechanism, states);
}

}  // namespace dynwitness::crosscheck
