// SPDX-License-Identifier: GPL-3.0-or-later
// What the accuracy of a whole simulation costs where loops are closed: the integrators, each with
// the form of the constraints that it solves for.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/motion/simulate.hpp"
#include "crosscheck/motion/work_precision.hpp"

namespace dynwitness::crosscheck {

/// One way to move a closed mechanism.
struct ClosedMethod {
  const char* integrator;
  Formulation formulation;
  Stabilisation stabilisation;
  /** Of the error of q and qd at the end, in the length of equal steps, or in the mean length where
      steps are chosen. Stabilised and unstabilised index 1 have the integrator's order; Radau IIA
      of s stages 2 s - 1 in index 1, index 2 and ggl; in index 3 qd has s at the
      least (implicit.hpp; four_bars_2 keeps 5). */
  int order;

  /// "runge_kutta4 projection" (of index 1, as all that is stabilised), "radau_iia_5 ggl"
  std::string label() const;
};
const std::vector<ClosedMethod>& closedMethods();

/** The end of a motion by Fehlberg's method on index 1 with projection at the smallest step error
    that double serves, and by Radau IIA of order 5 on index 2 with equal steps that are halved
    until the end no longer comes nearer: of the first. Published positions at that time
    (data/reference/motion) are compared with it.
    @throws std::runtime_error  they do not agree to six places, or one does not arrive */
ReferenceMotion closedReference(const scene::Scene& scene, double duration);

/** Each method with steps of duration / 16, halved until a run takes longer than longest_run;
    methods that choose their steps by an error of the step from 1e-2 down, whose point has the mean
    of their steps.
    @param options  methods: integrators, in every form that they have here
    @throws scene::InputError   what Command::kSimulate refuses, no method of that name here
    @throws std::runtime_error  what closedReference() throws */
WorkPrecision measureClosedWork(const scene::Scene& scene, const WorkOptions& options);

}  // namespace dynwitness::crosscheck
