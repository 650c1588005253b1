// SPDX-License-Identifier: GPL-3.0-or-later
// Motions whose accelerations come from compiled code: the C that
// `derive --format c --quantity qdd` writes, or the scene's kernel in lanes.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/kernel/controller_code.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/motion/tree_motion.hpp"

namespace dynwitness::crosscheck {

/// qdd of a scene as C, with what it counts.
class AccelerationCode {
 public:
  /// @throws kernel::NotUsed  it would be too long
  explicit AccelerationCode(const scene::Scene& scene);
  const kernel::ControllerCode& code() const { return code_; }
  kernel::CodeCount count() const { return code_.count(code_.functions().front()); }
  /// Multiplications, additions, divisions, comparisons, cosines and sines of a call.
  int operations() const;

 private:
  kernel::ControllerCode code_;
};

/** Equations of motion of a tree by that code, compiled: qdd in double, or in float; positions,
    rates and the integrator's sums are kept in double either way. */
class CodeMotion : public MotionEquations<double> {
 public:
  /// @throws kernel::CannotCompile  no C compiler, or no cache folder
  CodeMotion(const scene::Scene& scene, const AccelerationCode& code, kernel::CodeScalar scalar);

  int positions() const override { return tree_.positions(); }
  int dof() const override { return tree_.dof(); }
  void rate(const State& y, double time, State* rate) override;
  void move(State* y, const State& u) const override { tree_.move(y, u); }
  State commutator(const State& u, const State& v) const override { return tree_.commutator(u, v); }

 private:
  template <typename T>
  void accelerate(const State& y, State* rate);

  TreeMotion<double> tree_;
  recursive::Model<double> model_;
  std::shared_ptr<class LoadedCode> loaded_;
  void* function_ = nullptr;
  bool is_float_;
  std::vector<scene::JointPosition<double>> x_;
  State qd_, q_rate_;
};

/** The same by the scene's kernel, which answers for as many motions side by side as a vector of
    this processor has doubles, in the time of one. Here all of them are the same motion. */
class LaneMotion : public MotionEquations<double> {
 public:
  /// @throws kernel::NotUsed  no straight line is worth having; kernel::CannotCompile; as
  ///   kernel::smallestRoad()
  explicit LaneMotion(const scene::Scene& scene);

  int lanes() const { return kernel_.lanes(); }
  /// Of one call for all lanes: those of vectors, cosines and sines among them.
  int operations() const;

  int positions() const override { return tree_.positions(); }
  int dof() const override { return tree_.dof(); }
  void rate(const State& y, double time, State* rate) override;
  void move(State* y, const State& u) const override { tree_.move(y, u); }
  State commutator(const State& u, const State& v) const override { return tree_.commutator(u, v); }

 private:
  TreeMotion<double> tree_;
  recursive::Model<double> model_;
  kernel::Kernel kernel_;
  std::vector<scene::JointPosition<double>> x_;
  State one_qd_, q_rate_, q_, qd_, tau_, qdd_;  ///< the last four of all lanes
};

}  // namespace dynwitness::crosscheck
