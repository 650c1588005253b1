// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a state closes the closures of its scene.
#pragma once

#include <memory>
#include <string>

#include "crosscheck/witnesses/prepared_scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// How far a state leaves closures open.
struct ClosureGap {
  double phi = 0, phi_rate = 0;  ///< largest |phi| [m, 1] and |J qd| [m/s, 1/s]
  bool is_open = false;          ///< beyond rounding

  /// "|phi| = 0.0731, |J qd| = 0"
  std::string text() const;
};

/** phi and J qd of all closures at a state, on running error bounds. Nobody can give q and qd
    better than to half a unit in their last place, so the state stands for all that round to it:
    closures are open where |phi| or |J qd| of an equation is above the bound of phi and J qd over
    these states, the computation's own rounding included. */
class ClosureGaps {
 public:
  explicit ClosureGaps(const PreparedScene& scene);
  ~ClosureGaps();

  ClosureGap at(const scene::State<double>& state);
  /// The gap of the scene's start, driven joints where they are at t = 0.
  static ClosureGap ofStart(const PreparedScene& scene);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
