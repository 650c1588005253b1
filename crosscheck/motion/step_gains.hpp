// SPDX-License-Identifier: GPL-3.0-or-later
// What steps of a length add to a motion's energy, told without a run of such steps.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/tree_motion.hpp"

namespace dynwitness::crosscheck {

/// States (q, qd, work) of a motion at equal times, each for what is until the next.
struct StatesAlong {
  std::vector<std::vector<double>> states;
  double apart = 0;  ///< [s]
};

/// No eigenvalue ends its steps. Such methods are implicit.
bool isAStable(const Integrator& method);

struct StepGain {
  double gained = 0;         ///< [J]; infinity: it left the numbers
  bool is_unsolved = false;  ///< of an implicit step there is no solution at a state of the motion
};

/** Single steps from states of the motion, nonlinear terms and all:

        largest sum up to a state  (apart / h) (E(Phi_h(y)) - E(y)).

    Along a motion that keeps its energy this is what steps add to it. Of a symplectic method each
    term is a difference of what its modified energy is apart from E (Hairer, Lubich, Wanner,
    Geometric Numerical Integration, 2006, IX.3), and the sum is how far E swings; states have to be
    a fraction of the fastest oscillation apart for that. But its steps go along levels of the
    modified energy, and from those of E they gain on the whole, to the second order in what these
    are apart. A step back gains as much, so that of these methods, which are symmetric, Phi_-h
    being the inverse of Phi_h,

        (apart / h) (E(Phi_h(y)) - E(Phi_-h(y))) / 2   is added up.

    Asked are states that are h apart, or as near to each other as there are: as many as a run of
    such steps would come by, so that a step without a solution is met as often as there.
    @param enough  the sum ends there [J] */
StepGain gainAlong(TreeMotion<double>& motion, const StatesAlong& along, const std::string& method,
                   double h, double enough);

/** The motion that steps follow where they gain at any length, which they leave for others that
    gain otherwise: the modified equation to its first terms. What a step does beside the motion is
    taken in its middle,

        y + d(y) = phi_-h/2(Phi_h(phi_-h/2(y))),
        y' = f(y) + (d(y) - (d(y + d(y)) - d(y)) / 2) / h,

    phi the motion itself, back (by Dormand and Prince's step, of order 5: for methods of order 1
    and 2). The bracket is the logarithm of 1 + d to its second order, and stands in the middle so
    that it and f commute to that order (Strang's splitting). Its own steps are as long as its
    solution allows, whatever h is.
    @return the largest gain of energy up to `duration` or `enough`; infinity: it left the numbers,
      or was not followed to its end in 65536 steps of its own, and is not called stable
    @see Hairer, Lubich, Wanner, IX.1 */
StepGain gainOfModified(TreeMotion<double>& motion, const std::vector<double>& start,
                        const std::string& method, double duration, double h, double enough);

}  // namespace dynwitness::crosscheck
