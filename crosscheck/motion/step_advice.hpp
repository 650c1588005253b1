// SPDX-License-Identifier: GPL-3.0-or-later
// Which step a motion bears: predicted from its spectrum and from single steps, and measured around
// that.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "crosscheck/motion/step_gains.hpp"
#include "crosscheck/motion/step_trials.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Eigenvalues of df/dy along a motion, its states, and how fast it gets.
struct SpectrumAlong {
  struct Moment {
    double time, duration;                      ///< [s]: and until the next
    std::vector<std::complex<double>> fastest;  ///< [1/s], Im >= 0; none that is 0
  };
  std::vector<Moment> moments;
  /// From the start on; half a radian of the fastest eigenvalue or less apart, up to 20 a moment.
  StatesAlong along;
  double most_kinetic = 0;  ///< largest kinetic energy [J]
};
/** At equal times along the motion from the scene's start, which steps that adapt follow.
    @throws std::runtime_error  df/dy is not finite there, or the steps grow too short to arrive */
SpectrumAlong spectrumAlong(const scene::Scene& scene, double duration);

/** The largest step at which a method's energy does not double along this motion, by predictions
    that need no run with that step:

    Where the method has a region of stability, the part along an eigenvalue lambda grows by
    |R(h lambda)| in a step, energy by its square, so

        (1)  sum over moments  (duration / h) max over lambda  2 log |R(h lambda)|  <=  log 2.

    Where the motion itself grows (Re lambda > 0) its own growth is no instability of the step: such
    lambda count with their imaginary part alone.

    And what single steps from states of the motion add to the energy, nonlinear terms and all:

        (2)  gainAlong(h) <= most_kinetic,  with a solution at each state where steps are implicit.

    A-stable methods have (2) alone: no eigenvalue ends their steps, nonlinear terms do. A method
    that grows at any step (Euler's, the modified midpoint) leaves the motion by what it gains, and
    so does semi-implicit Euler where M changes: of them the modified equation is asked in place of
    (2),

        (3)  gainOfModified(h) <= most_kinetic.

    An eigenvalue does not say how much of the energy moves along it; (3) does. A method that goes
    on from earlier steps has (1) alone. */
struct StableStep {
  double step = 0;              ///< [s]; infinity: any up to the duration
  bool by_spectrum = false;     ///< (1) ends it, and not (2) or (3)
  bool is_unsolved = false;     ///< an implicit step has no solution
  std::complex<double> lambda;  ///< that grows most there [1/s]
  double time = 0;              ///< when [s]
  double limit = 0;             ///< h |lambda| of that direction at which one step grows
};
StableStep largestStableStep(const scene::Scene& scene, const SpectrumAlong& spectrum,
                             const std::string& method);

/// h |lambda| in the direction of lambda up to which a step does not grow; infinity: any.
double stabilityLimit(const std::string& method, std::complex<double> lambda);

/// The largest stable step, predicted and measured.
struct StepAdvice {
  StableStep predicted;
  TriedStep
      tried;  ///< in runs around the prediction; of methods that are stable with any step from
              ///< 1 / the largest |lambda| on
};
StepAdvice adviseStep(const scene::Scene& scene, const SpectrumAlong& spectrum,
                      const std::string& method);

/// A step as text of some digits, not above it: what is stable is not rounded to what is not.
std::string roundedDown(double h, int digits);

/// What ends the steps of `tried`: "runs gain energy", "no solution of an implicit step is found".
std::string lossText(const TriedStep& tried);

/** What is to be said of a run that lost its motion's energy. "energy error reached half of the
    largest kinetic energy at t = 3.1 s: runge_kutta4 with h = 0.05 s is unstable here (h |lambda| =
    3.4 at t = 0.2 s, limit 2.78): h <= 0.04 s (measured; predicted 0.041 s), or implicit_midpoint
    with h = 0.05 s (measured)"
    @param when  it did [s]; negative: it left the numbers, nobody knows when */
std::string adviceAfterFailure(const scene::Scene& scene, const std::string& method,
                               double duration, double step, double when);

}  // namespace dynwitness::crosscheck
