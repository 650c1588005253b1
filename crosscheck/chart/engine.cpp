// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/timed_apart.hpp"

namespace dynwitness::crosscheck {
namespace {

class EngineMethod : public Method {
 public:
  EngineMethod(std::unique_ptr<Witness> witness, Quantity quantity, const States& states)
      : Method(witness->name() + kByItsWitness, Scalar::kDouble),
        witness_(std::move(witness)),
        quantity_(quantity),
        states_(states) {}
  void run(int state) override { value_ = witness_->value(quantity_, states_[state]); }
  MatrixX<Ball> answer() const override { return exactlyAll<double>(value_); }

 private:
  std::unique_ptr<Witness> witness_;
  Quantity quantity_;
  States states_;
  Eigen::MatrixXd value_;
};

class RawEngineMethod : public TimedApart {
 public:
  RawEngineMethod(std::unique_ptr<Witness> witness, Quantity quantity, const States& states,
                  RawCalls raw)
      : TimedApart(witness->name(), Scalar::kDouble),
        witness_(std::move(witness)),
        quantity_(quantity),
        states_(states),
        raw_(std::move(raw)) {
    for (const scene::State<double>& state : states) {
      q_.emplace_back();
      for (const scene::JointPosition<double>& x : state.x) q_.back().push_back(x.q);
    }
  }
  void run(int state) override { value_ = witness_->value(quantity_, states_[state]); }
  void runAll(int first, int last) override {
    for (int k = first; k < last; ++k) raw_.call(states_[k], q_[k]);
  }
  MatrixX<Ball> answer() const override { return exactlyAll<double>(value_); }

 private:
  std::unique_ptr<Witness> witness_;
  Quantity quantity_;
  States states_;
  std::vector<std::vector<double>> q_;
  RawCalls raw_;
  Eigen::MatrixXd value_;
};

}  // namespace

std::unique_ptr<Method> engineMethod(std::unique_ptr<Witness> witness, Quantity quantity,
                                     const States& states) {
  return std::make_unique<EngineMethod>(std::move(witness), quantity, states);
}

std::unique_ptr<Method> rawEngineMethod(std::unique_ptr<Witness> witness, Quantity quantity,
                                        const States& states, RawCalls raw) {
  return std::make_unique<RawEngineMethod>(std::move(witness), quantity, states, std::move(raw));
}

}  // namespace dynwitness::crosscheck
