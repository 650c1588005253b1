// SPDX-License-Identifier: GPL-3.0-or-later
// The first variation of the action.
#pragma once

#include <cstdint>
#include <vector>

#include "crosscheck/studies/action_problem.hpp"

namespace dynwitness::crosscheck::hamilton {

/// A sum of sines that vanishes at both ends.
/// zeta_i(t) = sum of a_im sin(m pi t / duration), m = 1, 2, ...
struct Sines {
  std::vector<Values> a;  ///< by joint
  double value(int i, double phase) const;
  double rate(int i, double phase, double duration) const;
};
/// One that is drawn, of n coordinates, nowhere above 1.
Sines variation(const scene::Scene& scene, int n, std::uint64_t seed, int index);

/// pi t / duration of a node. At the last one 0, as sin(k pi) is exactly: the ends are kept.
double phaseOf(const Problem& problem, const Node& node, const std::vector<Node>& nodes);

struct FirstVariation {
  double action = 0;       ///< dS
  double with_forces = 0;  ///< dS + integral of Q' zeta
  double with_work = 0;    ///< d(S + integral of W)
  double size = 0;         ///< sum of the magnitudes that it was summed from
};

FirstVariation firstVariation(const Problem& problem, const std::vector<Node>& nodes,
                              const Sines& zeta);

/** By how much rounding the state after each step moves dS(eta), at most: between two steps it is
    [p' eta], and eta, nowhere above 1 (of dependent rates above what they then are), feels each
    jump of p = M qd. */
double movedByRounding(const Problem& problem, const std::vector<Node>& nodes);

}  // namespace dynwitness::crosscheck::hamilton
