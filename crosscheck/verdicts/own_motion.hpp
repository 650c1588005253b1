// SPDX-License-Identifier: GPL-3.0-or-later
// A motion that somebody else's simulation made: a wrong model, or a wrong step?
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "crosscheck/witnesses/own_steps.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** Two questions that have nothing to do with each other.

    Wrong model: do its accelerations solve our equations of motion at its own states? What they
    leave,  M qdd + c + g + friction - Q  in long double, may be what rounding leaves: by
    the engine's own account, which has its known losses (Answer::residual_bound of qdd), or by
    EngineBound and SolveBound. No step has a part in it.

    Wrong step: how far is the next of its moments from where our equations, solved in long double,
    lead from the one before? Where the model is right that is its integration error alone; and how
    far does T + V of ours, exact at its states, go? */
struct OwnMotionVerdict {
  std::string by;
  double residual = 0;       ///< [N m, N]: of the moment at which it exceeds its limit most
  double ratio = 0;          ///< that over its limit
  double residual_time = 0;  ///< [s]
  int residual_joint = 0;    ///< degree of freedom
  double step_error = 0;  ///< largest |q|, |qd| apart at the next moment, a second [1/s of these]
  double step_time = 0;   ///< [s]
  int answered = 0;       ///< intervals between moments that step_error is of
  /// [s]: from, to; where our own solution does not settle, so that nothing is said of the step.
  std::vector<std::pair<double, double>> unanswered;
  double energy_error = 0;                  ///< largest |E - E_0| over the largest kinetic energy
  double most_kinetic = 0;                  ///< [J]: that
  std::vector<double> time, energy_change;  ///< of the moments: t [s], |E - E_0| [J]

  bool isModelWrong() const { return !(ratio <= 1); }
};

/// @param by  who moved, whose bound holds; nullptr: not known
/// @throws scene::InputError  what Command::kDrift refuses; friction; moments of other sizes
OwnMotionVerdict judgeOwnMotion(const scene::Scene& scene, const OwnMotion& motion,
                                Witness* by = nullptr);

/// "kuka by mujoco, ...: wrong model ...", two columns under a heading.
std::string ownMotionTable(const scene::Scene& scene,
                           const std::vector<OwnMotionVerdict>& verdicts);

}  // namespace dynwitness::crosscheck
