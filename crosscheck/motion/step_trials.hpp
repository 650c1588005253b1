// SPDX-License-Identifier: GPL-3.0-or-later
// Which step a motion bears, found by running it.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// What became of a run with equal steps.
struct StepRun {
  /** Largest E - E_0, over the largest kinetic energy of the motion; infinity: it left the numbers,
      or an implicit step had no solution. What a step takes off the energy does not count:
      Runge-Kutta 4 takes from every oscillation, the more the longer the step, and stays stable. */
  double gained = 0;
  bool is_unsolved = false;  ///< of an implicit step no solution was found
  long calls = 0;            ///< of the equations of motion

  /// The energy did not double.
  bool holds() const { return gained < 1; }
};
/// @param most_kinetic  largest kinetic energy of the motion [J]
StepRun runWithStep(const scene::Scene& scene, const std::string& method, double duration,
                    double step, double most_kinetic);

/** The largest step of those tried at which, as at all shorter ones that were tried, a run of the
    whole motion holds: in steps growing by a twentieth from half of `first`, or from as many
    halvings below it as it takes until six in a row hold.

    A prediction by one step's map does not see what is tried here: that a run which gains leaves
    the motion and gains more there, that an implicit step has no solution that Newton's method
    finds, and that what holds at a longer step may fail at a shorter one, where a swing's phase is
    met. */
struct TriedStep {
  double step = 0;    ///< [s]; infinity: any up to the duration; 0: none with up to 2^21 steps
  double beyond = 0;  ///< the next step tried, which does not hold [s]
  bool is_unsolved = false;  ///< beyond it an implicit step has no solution
  int runs = 0;
  long calls = 0;  ///< of the equations, in all runs
};
TriedStep largestStepTried(const scene::Scene& scene, const std::string& method, double duration,
                           double first, double most_kinetic);

/// The end of a motion, to see the errors of others by.
struct KnownEnd {
  std::vector<long double> y;  ///< as placed() has it
  double error = 0;            ///< what halving the step changed last [rad, m, rad/s, m/s]
};
/** By Runge-Kutta-Fehlberg 7(8) in long double, whose step is halved until the end changes by less
    than a tenth of `accuracy`.
    @throws std::runtime_error  it does not with 2^16 steps */
KnownEnd knownEnd(const scene::Scene& scene, double duration, double accuracy);

/** The largest step with which the error of the end [rad, m, rad/s, m/s] is at most `accuracy`, to
    a tenth, and its price. Each run says by the method's order which step to try next,
    h (accuracy / error)^(1 / order); what is returned was run, and steps a quarter shorter, too. */
struct AccurateStep {
  double step = 0;   ///< [s]; 0: not found
  double calls = 0;  ///< of the equations, at that step
  /// It would take more than 2^19 steps: by its order from a coarser run, and not run itself.
  bool is_predicted = false;
  long tried_calls = 0;  ///< of the equations, in all runs
  std::string why;       ///< no step was found
};
/// @param largest  no longer step is asked for [s]
AccurateStep accurateStep(const scene::Scene& scene, const std::string& method, double duration,
                          double accuracy, double largest, const KnownEnd& end);

}  // namespace dynwitness::crosscheck
