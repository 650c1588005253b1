// SPDX-License-Identifier: GPL-3.0-or-later
// Two models of a geared rotor, and how far they are apart.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** tau of a scene with all its rotors as inertias n^2 J of their joints, and with all of them
    gyroscopic (scene::Joint), at seeded states.

    The models differ by  n J qd z'w  in T, w being the parent's angular velocity: in tau by terms
    with n J, where the inertia of the joint has n^2 J. So they agree where no parent turns (w = 0:
    the first joint of an arm on the ground, parents that only slide), and at a given n^2 J the
    difference falls as 1/n. */
struct RotorModels {
  struct Joint {
    std::string name;  ///< label of the rate
    bool has_rotor = false;
    double largest = 0;       ///< of |difference of tau| over the states [N m], [N]
    double largest_tau = 0;   ///< of |tau| of the gyroscopic model over the states
    int worst_state = 0;      ///< index of the state of `largest`
    double at_ten_times = 0;  ///< `largest` once more with gear ratios 10 n and inertias J / 100
    double share() const { return largest_tau > 0 ? largest / largest_tau : 0; }
  };
  std::vector<Joint> joints;  ///< one a rate
  int states = 0;
  std::uint64_t seed = 0;

  const Joint& worst() const;  ///< of the largest share
};

/// @throws scene::InputError  the scene has no rotor
RotorModels compareRotorModels(const scene::Scene& scene, int states, std::uint64_t seed);

}  // namespace dynwitness::crosscheck
