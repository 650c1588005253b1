// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/methods.hpp"

namespace dynwitness::crosscheck {
namespace {

class EngineMethod : public Method {
 public:
  EngineMethod(std::unique_ptr<Witness> witness, Quantity quantity, const States& states)
      : Method(witness->name(), Scalar::kDouble),
        witness_(std::move(witness)),
        quantity_(quantity),
        states_(states) {}
  void run(int state) override { value_ = witness_->value(quantity_, states_[state]); }
  MatrixOf<Ball> answer() const override { return exactlyAll<double>(value_); }

 private:
  std::unique_ptr<Witness> witness_;
  Quantity quantity_;
  States states_;
  Eigen::MatrixXd value_;
};

}  // namespace

std::unique_ptr<Method> engineMethod(std::unique_ptr<Witness> witness, Quantity quantity,
                                     const States& states) {
  return std::make_unique<EngineMethod>(std::move(witness), quantity, states);
}

}  // namespace dynwitness::crosscheck
