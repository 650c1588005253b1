// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps as a witness: answers in double with their own sines and cosines, bounds by the
// same sweeps on RunningError.
#include "crosscheck/witnesses/fast_sweeps.hpp"

#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/sharp_bounds.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "recursive/fast/dynamics.hpp"

namespace dynwitness::crosscheck {
namespace {

class FastWitness : public Witness {
 public:
  explicit FastWitness(const PreparedScene& scene)
      : in_double_(scene.model<double>()),
        with_bounds_(scene.model<RunningError>()),
        sharp_([mechanism = scene.mechanism()] {
          return std::make_unique<FastSweeps<AdjointError>>(
              recursive::buildModel(mechanism, AdjointErrorNumbers(mechanism)));
        }),
        solve_bound_(scene, SolvedBy::kSweep, 1) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return FastSweeps<double>::answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    const scene::State<RunningError> bounded_state = runningErrorState(state);
    const MatrixX<RunningError> bounded = with_bounds_(quantity, bounded_state);
    Answer out = boundedAnswer(value(quantity, state), bounded);
    if (quantity == Quantity::kM) out.bound = solve_bound_.sharper(bounded, state);
    if (quantity == Quantity::kTau)
      out.bound = sharp_(bounded, [&](FastSweeps<AdjointError>& sweeps) {
        return sweeps(quantity, adjointState(bounded_state));
      });
    if (quantity == Quantity::kQdd)
      solve_bound_.judge(state, answer(Quantity::kTau, moving(state, out.value)).bound, out, sharp_,
                         [&](FastSweeps<AdjointError>& sweeps) {
                           return sweeps(quantity, adjointState(bounded_state));
                         });
    return out;
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    q_.clear();
    for (const scene::JointPosition<double>& x : state.x) q_.push_back(x.q);
    const int n = in_double_.plan().dof;
    Eigen::MatrixXd out(n, quantity == Quantity::kM ? n : 1);
    if (quantity == Quantity::kM)
      in_double_.massMatrix(q_.data(), out.data());
    else if (quantity == Quantity::kTau)
      in_double_.inverseDynamics(q_.data(), state.qd.data(), state.qdd.data(), out.data());
    else
      in_double_.forwardDynamics(q_.data(), state.qd.data(), state.tau.data(), out.data());
    return out;
  }

 private:
  std::string name_ = kFastName;
  recursive::fast::Dynamics in_double_;
  FastSweeps<RunningError> with_bounds_;
  SharpBounds<FastSweeps<AdjointError>> sharp_;
  SolveBound solve_bound_;
  std::vector<double> q_;
};

}  // namespace

WitnessKind fastKind() {
  return overTree({{kFastName, DYNWITNESS_VERSION,
                    "the sweeps of recursive/fast/, for any mechanism, made for speed"},
                   [](const PreparedScene& scene) { return makeWitness<FastWitness>(scene); },
                   exactFast},
                  Lacking::kAnswered);
}

}  // namespace dynwitness::crosscheck
