// SPDX-License-Identifier: GPL-3.0-or-later
// What steps of a length add to a motion's energy, told without a run of such steps.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/motion/tree_motion.hpp"

namespace dynwitness::crosscheck {

/// States (q, qd, work) of a motion at equal times, each for what is until the next.
struct StatesAlong {
  std::vector<std::vector<double>> states;
  double apart = 0;  ///< [s]
};

struct StepGain {
  double gained = 0;         ///< [J]; infinity: it left the numbers
  bool is_unsolved = false;  ///< of an implicit step there is no solution at a state of the motion
};

/** Single steps from states of the motion, nonlinear terms and all:

        largest sum up to a state  (apart / h) (E(Phi_h(y)) - E(y)).

    Along a motion that keeps its energy this is what steps add to it. Of a symplectic method each
    term is a difference of the modified energy's distance from E, so that the sum is how far E
    swings (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, IX.3); states have to be
    near enough to each other for that, a fraction of the fastest oscillation apart.
    @param enough  the sum ends there [J] */
StepGain gainAlong(TreeMotion<double>& motion, const StatesAlong& along, const std::string& method,
                   double h, double enough);

/** The motion that steps follow where they gain at any length, which they leave for others that
    gain otherwise: the modified equation to its first term,

        y' = f(y) + (Phi_h(y) - phi_h(y)) / h,

    phi_h the motion itself (by Runge-Kutta-Fehlberg 7(8) in one step of h). Its own steps are as
    long as its solution allows, whatever h is.
    @return the largest gain of energy up to `duration` or `enough`
    @see Hairer, Lubich, Wanner, IX.1 */
StepGain gainOfModified(TreeMotion<double>& motion, const std::vector<double>& start,
                        const std::string& method, double duration, double h, double enough);

}  // namespace dynwitness::crosscheck
