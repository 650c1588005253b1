// SPDX-License-Identifier: GPL-3.0-or-later
// A sweep of ours as a witness: in double, with the bounds of the same sweep.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "crosscheck/witnesses/sharp_bounds.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

/// The setup of sweeps in one arithmetic. What is never asked for is never built: a model, or that
/// with all fixed joints, which is for reactions.
template <typename T>
class LazySetup {
 public:
  explicit LazySetup(const PreparedScene& scene) : scene_(scene) {}

  Setup<T>& operator()(Quantity quantity) {
    if (quantity == Quantity::kReactions && !with_reactions_) with_reactions_.emplace(scene_);
    if (with_reactions_) return *with_reactions_;
    if (!lumped_) lumped_.emplace(scene_.model<T>());
    return *lumped_;
  }

 private:
  PreparedScene scene_;
  std::optional<Setup<T>> lumped_, with_reactions_;
};

/** @tparam Algorithm  as those of sweep_algorithms.hpp; qdd is found by kSolvedBy. The bounds of M
    are the
                      smaller of running error bounds and of SolveBound::massMatrix(). */
template <typename Algorithm>
class SweepWitness : public Witness {
 public:
  explicit SweepWitness(const PreparedScene& scene)
      : in_double_(scene),
        with_bounds_(scene),
        sharp_([mechanism = scene.mechanism()] {
          return std::make_unique<Setup<AdjointError>>(mechanism, AdjointErrorNumbers(mechanism));
        }),
        scene_(scene) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return Algorithm::answers(quantity); }
  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out{value(quantity, state), {}};
    if (quantity == Quantity::kQdd) {
      out.bound = boundedAnswer({}, run<Algorithm>(quantity, state)).bound;
      solveBound().judge(state, bound<NewtonEuler>(Quantity::kTau, moving(state, out.value)), out,
                         sharp_, [&](Setup<AdjointError>& setup) {
                           return Algorithm::answer(
                               setup, quantity,
                               adjointState(runningErrorState(state, scene_.mechanism())));
                         });
    } else {
      out.bound = bound<Algorithm>(quantity, state);
    }
    return out;
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    return Algorithm::answer(in_double_(quantity), quantity, state);
  }

 private:
  SolveBound& solveBound() {
    if (!solve_bound_) solve_bound_.emplace(scene_, Algorithm::kSolvedBy, 1);
    return *solve_bound_;
  }
  template <typename Sweep>
  MatrixX<RunningError> run(Quantity quantity, const scene::State<double>& state) {
    return Sweep::answer(with_bounds_(quantity), quantity,
                         runningErrorState(state, scene_.mechanism()));
  }
  template <typename Sweep>
  Eigen::MatrixXd bound(Quantity quantity, const scene::State<double>& state) {
    const MatrixX<RunningError> bounded = run<Sweep>(quantity, state);
    if (quantity == Quantity::kM) return solveBound().sharper(bounded, state);
    return sharp_(bounded, [&](Setup<AdjointError>& setup) {
      return Sweep::answer(setup, quantity,
                           adjointState(runningErrorState(state, scene_.mechanism())));
    });
  }

  std::string name_ = Algorithm::kName;
  LazySetup<double> in_double_;
  LazySetup<RunningError> with_bounds_;
  SharpBounds<Setup<AdjointError>> sharp_;
  PreparedScene scene_;
  std::optional<SolveBound> solve_bound_;
};

}  // namespace dynwitness::crosscheck
