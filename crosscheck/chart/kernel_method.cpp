// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's own kernel in a chart, where there is one.
#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/methods.hpp"
#include "crosscheck/kernel/kernel.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;

class KernelMethod : public Method {
 public:
  KernelMethod(Quantity quantity, const scene::Mechanism& mechanism, const States& states)
      : Method(MethodName::kKernel, Scalar::kDouble),
        quantity_(quantity),
        kernel_(mechanism, {{formula(quantity)}, kernel::chosenLanes()}),
        out_(quantity == Quantity::kM ? mechanism.dof() * mechanism.dof() : mechanism.dof()) {
    for (const scene::State<double>& state : states) {
      inputs_.push_back({{}, state.qd, quantity == Quantity::kQdd ? state.tau : state.qdd});
      for (const scene::JointPosition<double>& x : state.x) inputs_.back().q.push_back(x.q);
    }
  }

  void run(int state) override {
    const Inputs& in = inputs_[state];
    if (quantity_ == Quantity::kM)
      kernel_.massMatrix(in.q.data(), out_.data());
    else if (quantity_ == Quantity::kQdd)
      kernel_.forwardDynamics(in.q.data(), in.qd.data(), in.w.data(), out_.data());
    else
      kernel_.inverseDynamics(in.q.data(), in.qd.data(), in.w.data(), out_.data());
  }
  MatrixOf<Ball> answer() const override {
    const int n = kernel_.dof();  // M is symmetric: by rows is by columns
    return exactlyAll<double>(MatrixOf<double>(
        Eigen::Map<const MatrixOf<double>>(out_.data(), n, quantity_ == Quantity::kM ? n : 1)));
  }

 private:
  struct Inputs {
    std::vector<double> q, qd, w;
  };
  static Formula formula(Quantity quantity) {
    if (quantity == Quantity::kM) return Formula::kMassMatrix;
    return quantity == Quantity::kQdd ? Formula::kForwardDynamics : Formula::kInverseDynamics;
  }

  Quantity quantity_;
  kernel::Kernel kernel_;
  std::vector<Inputs> inputs_;
  std::vector<double> out_;
};

}  // namespace

std::unique_ptr<Method> kernelMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                     const States& states) {
  return std::make_unique<KernelMethod>(quantity, mechanism, states);
}

}  // namespace dynwitness::crosscheck
