// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/growth/ours.hpp"

#include <stdexcept>

#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/fast/dynamics.hpp"

namespace dynwitness::crosscheck {
namespace {

class Ours : public Witness {
 public:
  explicit Ours(const char* name) : name_(name) {}
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    return quantity == Quantity::kTau || quantity == Quantity::kQdd;
  }
  Answer answer(Quantity, const scene::State<double>&) override {
    throw std::logic_error("growth has no use for bounds");
  }

 private:
  std::string name_;
};

class Fast : public Ours {
 public:
  explicit Fast(const scene::Mechanism& m)
      : Ours(kFastMethod), sweeps_(recursive::buildModel(m, scene::RealNumbers<double>(m))) {}
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& s) override {
    q_.resize(s.x.size());
    for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = s.x[i].q;
    Eigen::MatrixXd out(sweeps_.plan().dof, 1);
    if (quantity == Quantity::kTau)
      sweeps_.inverseDynamics(q_.data(), s.qd.data(), s.qdd.data(), out.data());
    else
      sweeps_.forwardDynamics(q_.data(), s.qd.data(), s.tau.data(), out.data());
    return out;
  }

 private:
  recursive::fast::Dynamics sweeps_;
  std::vector<double> q_;
};

class Textbook : public Ours {
 public:
  explicit Textbook(const scene::Mechanism& m)
      : Ours(kTextbookMethod), setup_(recursive::buildModel(m, scene::RealNumbers<double>(m))) {}
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& s) override {
    // cosines and sines are paid for here as everywhere
    for (scene::JointPosition<double>& x : (state_ = s).x) x = scene::jointPosition(x.q);
    if (quantity == Quantity::kTau) return NewtonEuler::answer(setup_, quantity, state_);
    return ArticulatedBody::answer(setup_, quantity, state_);
  }

 private:
  Setup<double> setup_;
  scene::State<double> state_;
};

}  // namespace

std::unique_ptr<Witness> fastForGrowth(const scene::Mechanism& mechanism) {
  return std::make_unique<Fast>(mechanism);
}
std::unique_ptr<Witness> textbookForGrowth(const scene::Mechanism& mechanism) {
  return std::make_unique<Textbook>(mechanism);
}

}  // namespace dynwitness::crosscheck
