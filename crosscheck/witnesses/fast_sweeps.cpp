// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps as a witness: answers in double with their own sines and cosines, the same by the
// sweeps at many states, bounds by the same sweeps on RunningError.
#include "crosscheck/witnesses/fast_sweeps.hpp"

#include <cstring>
#include <limits>
#include <memory>

#include "crosscheck/scalars/many_states.hpp"
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

/// Joints up to which the lanes are asked too: M of eight states takes 4 MiB there, and it is the
/// same code for more.
constexpr int kMostInLanes = 256;

class FastWitness : public Witness {
 public:
  explicit FastWitness(const PreparedScene& scene)
      : in_double_(scene.model<double>()),
        in_lanes_(in_double_.plan().dof <= kMostInLanes
                      ? std::make_unique<recursive::fast::ManyStates>(scene.model<double>())
                      : nullptr),
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
    Eigen::MatrixXd out = ofOne(quantity, state);
    if (in_lanes_) requireSameInLanes(quantity, state, out);
    return out;
  }

 private:
  Eigen::MatrixXd ofOne(Quantity quantity, const scene::State<double>& state) {
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

  /// The same state in every lane. An entry whose bits differ in one is no number, for the
  /// comparisons to find.
  void requireSameInLanes(Quantity quantity, const scene::State<double>& state,
                          Eigen::MatrixXd& out) {
    const auto lanes = static_cast<std::size_t>(in_lanes_->width());
    const auto size = static_cast<std::size_t>(out.size());
    lanes_.resize(lanes * size);
    const recursive::fast::Strided<const double> q{q_.data(), 0}, qd{state.qd.data(), 0},
        given{quantity == Quantity::kQdd ? state.tau.data() : state.qdd.data(), 0};
    const recursive::fast::Strided<double> to{lanes_.data(), static_cast<std::ptrdiff_t>(size)};
    if (quantity == Quantity::kM)
      in_lanes_->massMatrix(lanes, q, to);
    else if (quantity == Quantity::kTau)
      in_lanes_->inverseDynamics(lanes, q, qd, given, to);
    else
      in_lanes_->forwardDynamics(lanes, q, qd, given, to);
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      double& one = out.data()[k % size];
      if (std::memcmp(&lanes_[k], &one, sizeof one) != 0)
        one = std::numeric_limits<double>::quiet_NaN();
    }
  }

  std::string name_ = kFastName;
  recursive::fast::Dynamics in_double_;
  std::unique_ptr<recursive::fast::ManyStates> in_lanes_;
  FastSweeps<RunningError> with_bounds_;
  SharpBounds<FastSweeps<AdjointError>> sharp_;
  SolveBound solve_bound_;
  std::vector<double> q_, lanes_;
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
