// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/growth/ours.hpp"

#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/fast/dynamics.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Keeps fast::Dynamics as every caller does: plan, joint positions and what the sweeps write on,
/// that of the mass matrix too. The model is let go once the plan stands.
class Fast : public GrowthMethod {
 public:
  explicit Fast(const scene::Mechanism& m)
      : sweeps_(recursive::buildModel(m, scene::RealNumbers<double>(m))) {}
  void set(const scene::State<double>& s) override {
    q_.resize(s.x.size());
    for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = s.x[i].q;
    qd_ = s.qd;
    qdd_ = s.qdd;
    tau_ = s.tau;
    out_.resize(sweeps_.plan().dof, 1);
  }
  void inverseDynamics() override {
    sweeps_.inverseDynamics(q_.data(), qd_.data(), qdd_.data(), out_.data());
  }
  void forwardDynamics() override {
    sweeps_.forwardDynamics(q_.data(), qd_.data(), tau_.data(), out_.data());
  }
  const Eigen::MatrixXd& result() const override { return out_; }

 private:
  recursive::fast::Dynamics sweeps_;
  std::vector<double> q_, qd_, qdd_, tau_;
  Eigen::MatrixXd out_;
};

class Textbook : public GrowthMethod {
 public:
  explicit Textbook(const scene::Mechanism& m)
      : setup_(recursive::buildModel(m, scene::RealNumbers<double>(m))) {}
  void set(const scene::State<double>& s) override { state_ = s; }
  void inverseDynamics() override {
    turn();
    out_ = NewtonEuler::answer(setup_, Quantity::kTau, state_);
  }
  void forwardDynamics() override {
    turn();
    out_ = ArticulatedBody::answer(setup_, Quantity::kQdd, state_);
  }
  const Eigen::MatrixXd& result() const override { return out_; }

 private:
  /// Cosines and sines are paid for here as everywhere.
  void turn() {
    for (scene::JointPosition<double>& x : state_.x) x = scene::jointPosition(x.q);
  }
  Setup<double> setup_;
  scene::State<double> state_;
  Eigen::MatrixXd out_;
};

}  // namespace

std::unique_ptr<GrowthMethod> fastForGrowth(const scene::Mechanism& mechanism) {
  return std::make_unique<Fast>(mechanism);
}
std::unique_ptr<GrowthMethod> textbookForGrowth(const scene::Mechanism& mechanism) {
  return std::make_unique<Textbook>(mechanism);
}

}  // namespace dynwitness::crosscheck
