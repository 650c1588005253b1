// SPDX-License-Identifier: GPL-3.0-or-later
// Engines that move a scene by their own integrator.
#pragma once

#include <string>
#include <vector>

#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// A motion as somebody else's simulation has it: state by state, with its own accelerations.
struct OwnMotion {
  struct Moment {
    double time;  ///< [s]
    std::vector<double> q, qd, qdd;
  };
  std::string by;  ///< "mujoco, Euler, steps of 0.001 s"
  std::vector<Moment> moments;
};

/// A witness that can do that, for trees without loads and friction whose joints' rates are
/// derivatives of their positions.
class OwnSteps {
 public:
  virtual ~OwnSteps() = default;
  /** @param every  how many steps lie between two moments
      @throws std::runtime_error  it does not step this scene, and why */
  virtual OwnMotion ownMotion(const scene::State<double>& start, double step, long steps,
                              long every) = 0;

 protected:
  OwnSteps() = default;
  OwnSteps(const OwnSteps&) = default;
  OwnSteps& operator=(const OwnSteps&) = default;
};

}  // namespace dynwitness::crosscheck
