// SPDX-License-Identifier: GPL-3.0-or-later
// Motions that start beside one, by the steps on duals: conjugate times.
#pragma once

#include <vector>

#include "crosscheck/studies/action_problem.hpp"
#include "crosscheck/studies/order_of_steps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck::hamilton {

/** By how much rounding the state moves A'P - P'A, at most: P refers to the motion's own place and
    rates, and moves with them.
    @param now  neighbours, in coordinates */
double movedByRounding(const Problem& problem, const std::vector<PhasePoint<D>>& now);

struct JacobiFields {
  std::vector<Action::Conjugate> conjugates;
  StepResidual unsymmetric, late;  ///< A'P - P'A, J - (q', qd') of the later motion
  double size_late = 0;
  double size_state = 0, growth = 1;  ///< largest |q|, |qd|; largest entry of a neighbour
  std::vector<std::vector<PhasePoint<D>>> shared;  ///< neighbours where every size of steps is
};

/// @param work  of all numbers of steps up to this one: 1, 2, 4, ... times the first
JacobiFields jacobiFields(const Problem& problem, int steps, scene::Work& work);

}  // namespace dynwitness::crosscheck::hamilton
