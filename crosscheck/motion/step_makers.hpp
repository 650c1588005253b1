// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of integrators(), by where their formulas come from; each list in the order that they
// have there. On double and long double.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/motion/integrators.hpp"

namespace dynwitness::crosscheck {

template <typename T>
using StepMaker = std::unique_ptr<Steps<T>> (*)(MotionEquations<T>&);

/// euler to adams_bashforth_moulton4: explicit steppers of Boost.odeint.
template <typename T>
std::vector<StepMaker<T>> explicitSteps();
/// rosenbrock4, of Boost.odeint too, whose linear algebra is Boost.uBLAS.
template <typename T>
std::vector<StepMaker<T>> rosenbrockSteps();
/// semi_implicit_euler to lie_runge_kutta4: our own.
template <typename T>
std::vector<StepMaker<T>> ownSteps();

}  // namespace dynwitness::crosscheck
