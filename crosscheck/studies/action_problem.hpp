// SPDX-License-Identifier: GPL-3.0-or-later
// A motion whose action is looked at: what stays the same over all sizes of steps, and what is
// known at one instant.
#pragma once

#include <limits>
#include <type_traits>
#include <vector>

#include "crosscheck/scalars/lifted_closures.hpp"
#include "crosscheck/studies/flow.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/studies/hamilton.hpp"

namespace dynwitness::crosscheck::hamilton {

using D = Dual<double>;
using DD = Dual<D>;
using Values = std::vector<double>;

constexpr int kFirstSteps = 64, kMostSteps = 8192;
constexpr double kAmplitude = 0.01;  // of varied paths [rad, m]
/// Steps are halved until conjugate times are known to duration / this.
constexpr double kSharp = 1000;
/// A step adds to the state four times, each sum rounded by half an eps of it at most.
constexpr double kRoundedByStep = 2 * std::numeric_limits<double>::epsilon();

/// The motion at one instant.
struct Node {
  double time, weight;  ///< Simpson's [s]
  Values slots, slot_rates, qd, Q;
};

/// What stays the same over all step sizes.
struct Problem {
  recursive::Model<double> model;
  recursive::Terms terms;
  double damping, duration;
  bool coordinates;  ///< all rates are independent, and the derivatives of q
  bool conservative;
  PhasePoint<double> start;
  recursive::Constraints<double> closures;
  Surface surface;  ///< where the start is

  int n() const { return static_cast<int>(surface.rates.size()); }  ///< freedoms
  int dof() const { return model.dof(); }
  bool isClosed() const { return !surface.rows.empty(); }
  template <typename T>
  Flow<T> flow() const {
    if constexpr (std::is_same_v<T, double>)
      return {model, terms, damping, closures, surface.rows};
    else
      return {lifted<T>(model), terms, damping, lifted<T>(closures, dof()), surface.rows};
  }
};

/// @throws scene::InputError  as measureAction(), but for motions that leave the numbers
Problem problemOf(const scene::Scene& scene, const ActionOptions& options);
/// @throws scene::InputError  the message, unless it holds
void require(bool holds, const std::string& message);

bool isFinite(const Values& slots, const Values& qd);

}  // namespace dynwitness::crosscheck::hamilton
