// SPDX-License-Identifier: GPL-3.0-or-later
// How a derivation treats the numbers of a scene.
#pragma once

namespace dynwitness::symbolic {

struct Options {
  /// Parameters become their exact values. Otherwise they stay symbols, and the derivation speaks
  /// in the scene's own letters.
  bool fold_parameters = false;
  /// Moves to the inboard link what a joint's axis cannot tell apart (mass, first moment along the
  /// axis, one moment of inertia), so that T needs fewer operations. The energies stay the same
  /// functions; the share of each link does not.
  bool regroup_inertias = true;
};

}  // namespace dynwitness::symbolic
