// SPDX-License-Identifier: GPL-3.0-or-later
// Running error bounds where they are sharp, and where they run away those of the adjoint.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"

namespace dynwitness::crosscheck {

/// Bounds beyond so many ulp of the largest entry are looked at more closely, which takes a pass
/// over everything that was computed for every eight results; for many results (M, reactions)
/// beyond four times as many. Both are less than half of what a limit may be of an error of 1 ulp
/// (kWidestLimit).
inline constexpr double kWideBound = 1024;
inline constexpr int kManyResults = 64;
/// The same of a residual, which has but n entries; and where M is computed on the way, entry by
/// entry, so that a pass goes over n times as much.
inline constexpr double kWideResidual = 64, kWideResidualOfProgram = 4 * kWideBound;

inline bool isWide(const MatrixX<RunningError>& bounded) {
  double size = 0, widest = 0;
  for (const RunningError& x : bounded.reshaped()) {
    size = std::max(size, std::abs(x.value()));
    widest = std::max(widest, x.bound());
  }
  const double wide = bounded.size() > kManyResults ? 4 * kWideBound : kWideBound;
  return widest > wide * std::numeric_limits<double>::epsilon() * size;
}

/** The same computation on AdjointError, made when it is first needed. It must do what the one on
    RunningError does, number by number, on the same numbers.
    @tparam Computation  what keeps its numbers between answers: a Setup, the run of a program */
template <typename Computation>
class SharpBounds {
 public:
  /// @param make  makes it; called while recording
  explicit SharpBounds(std::function<std::unique_ptr<Computation>()> make)
      : make_(std::move(make)) {}

  /** The bounds of `bounded`, sharper where they are wide.
      @param answer  (Computation&) -> the same answer on AdjointError */
  template <typename Run>
  Eigen::MatrixXd operator()(const MatrixX<RunningError>& bounded, const Run& answer) {
    if (!isWide(bounded)) return boundedAnswer({}, bounded).bound;
    const AdjointTape::Recording recording(tape_);
    return tape_.bounds(answer(restarted()));
  }

  /** Bounds of the residual of an answer qdd, to first order (AdjointTape::firstOrder).
      @param answer  (Computation&) -> qdd on AdjointError */
  template <typename Run>
  Eigen::VectorXd residual(const Eigen::MatrixXd& M, const Run& answer) {
    const AdjointTape::Recording recording(tape_);
    return tape_.firstOrder(M, answer(restarted()));
  }

 private:
  Computation& restarted() {
    if (!computation_) {
      computation_ = make_();
      start_ = tape_.size();
    }
    tape_.rewind(start_);
    return *computation_;
  }

  std::function<std::unique_ptr<Computation>()> make_;
  AdjointTape tape_;
  std::size_t start_ = 0;  ///< of the tape: behind the numbers that are kept
  std::unique_ptr<Computation> computation_;
};

}  // namespace dynwitness::crosscheck
