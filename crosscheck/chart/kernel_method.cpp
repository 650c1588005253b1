// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's own kernel in a chart, where there is one.
#include <algorithm>
#include <iterator>

#include "crosscheck/chart/answers.hpp"
#include "crosscheck/chart/timed_apart.hpp"
#include "crosscheck/kernel/kernel.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;

class KernelMethod : public Method {
 public:
  KernelMethod(Quantity quantity, const scene::Mechanism& mechanism, const States& states)
      : Method(MethodName::kKernel, Scalar::kDouble),
        quantity_(quantity),
        kernel_(std::make_shared<kernel::Kernel>(
            mechanism, kernel::KernelOptions{{formula(quantity)}, kernel::chosenLanes()})),
        out_(quantity == Quantity::kM ? mechanism.dof() * mechanism.dof() : mechanism.dof()) {
    for (const scene::State<double>& state : states) {
      inputs_.push_back({{}, state.qd, quantity == Quantity::kQdd ? state.tau : state.qdd});
      for (const scene::JointPosition<double>& x : state.x) inputs_.back().q.push_back(x.q);
    }
  }

  void run(int state) override {
    const Inputs& in = inputs_[state];
    if (quantity_ == Quantity::kM)
      kernel_->massMatrix(in.q.data(), out_.data());
    else if (quantity_ == Quantity::kQdd)
      kernel_->forwardDynamics(in.q.data(), in.qd.data(), in.w.data(), out_.data());
    else
      kernel_->inverseDynamics(in.q.data(), in.qd.data(), in.w.data(), out_.data());
  }
  MatrixX<Ball> answer() const override {
    const int n = kernel_->dof();  // M is symmetric: by rows is by columns
    return exactlyAll<double>(MatrixX<double>(
        Eigen::Map<const MatrixX<double>>(out_.data(), n, quantity_ == Quantity::kM ? n : 1)));
  }

  Quantity quantity() const { return quantity_; }
  const std::shared_ptr<const kernel::Kernel>& code() const { return kernel_; }

 private:
  struct Inputs {
    std::vector<double> q, qd, w;
  };
  static Formula formula(Quantity quantity) {
    if (quantity == Quantity::kM) return Formula::kMassMatrix;
    return quantity == Quantity::kQdd ? Formula::kForwardDynamics : Formula::kInverseDynamics;
  }

  Quantity quantity_;
  std::shared_ptr<const kernel::Kernel> kernel_;
  std::vector<Inputs> inputs_;
  std::vector<double> out_;
};

/// Component i of state k of a batch is at [i * count + k].
class LanesMethod : public TimedApart {
 public:
  LanesMethod(const KernelMethod& one, const States& states, int batches)
      : TimedApart(kLanesMethod, Scalar::kDouble), quantity_(one.quantity()), kernel_(one.code()) {
    const int all = static_cast<int>(states.size());
    const int of = std::min(all, batches);
    for (int b = 0; b < of; ++b) {
      const int first = firstOfBatch(all, of, b), count = firstOfBatch(all, of, b + 1) - first;
      batches_.push_back({first, count, {}, {}, {}});
      Batch& batch = batches_.back();
      for (std::size_t i = 0; i < states.front().x.size(); ++i)
        for (int k = 0; k < count; ++k) batch.q.push_back(states[first + k].x[i].q);
      for (int i = 0; i < kernel_->dof(); ++i)
        for (int k = 0; k < count; ++k) {
          const scene::State<double>& s = states[first + k];
          batch.qd.push_back(s.qd[i]);
          batch.w.push_back(quantity_ == Quantity::kQdd ? s.tau[i] : s.qdd[i]);
        }
    }
    const std::size_t n = kernel_->dof();
    out_.resize((quantity_ == Quantity::kM ? n * n : n) * ((states.size() + of - 1) / of + 1));
  }

  void run(int state) override {
    run(batchOf(state));
    at_ = state;
  }
  void runAll(int first, int) override { run(batchOf(first)); }
  MatrixX<Ball> answer() const override {
    const Batch& batch = batchOf(at_);
    const int n = kernel_->dof(), columns = quantity_ == Quantity::kM ? n : 1;
    MatrixX<double> value(n, columns);  // M is symmetric: by rows is by columns
    for (int i = 0; i < value.size(); ++i)
      value.data()[i] = out_[static_cast<std::size_t>(i) * batch.count + (at_ - batch.first)];
    return exactlyAll<double>(value);
  }

 private:
  struct Batch {
    int first, count;
    std::vector<double> q, qd, w;
  };
  const Batch& batchOf(int state) const {
    return *std::prev(std::upper_bound(batches_.begin(), batches_.end(), state,
                                       [](int k, const Batch& b) { return k < b.first; }));
  }
  void run(const Batch& in) {
    if (quantity_ == Quantity::kM)
      kernel_->massMatrix(in.q.data(), out_.data(), in.count);
    else if (quantity_ == Quantity::kQdd)
      kernel_->forwardDynamics(in.q.data(), in.qd.data(), in.w.data(), out_.data(), in.count);
    else
      kernel_->inverseDynamics(in.q.data(), in.qd.data(), in.w.data(), out_.data(), in.count);
  }

  Quantity quantity_;
  std::shared_ptr<const kernel::Kernel> kernel_;
  std::vector<Batch> batches_;
  std::vector<double> out_;
  int at_ = 0;
};

}  // namespace

std::unique_ptr<Method> lanesMethod(const Method& kernel, const States& states, int batches) {
  return std::make_unique<LanesMethod>(dynamic_cast<const KernelMethod&>(kernel), states, batches);
}

std::unique_ptr<Method> kernelMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                     const States& states) {
  return std::make_unique<KernelMethod>(quantity, mechanism, states);
}

}  // namespace dynwitness::crosscheck
