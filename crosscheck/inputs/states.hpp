// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded states: the same scene, seed and index give the same state on every machine.
#pragma once

#include <cstdint>
#include <string>

#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// A stream of random numbers that is a pure function of (name, seed, index): SplitMix64 started at
/// a hash of the three. (The distributions of <random> differ between standard libraries.)
class RandomStream {
 public:
  RandomStream(const std::string& name, std::uint64_t seed, std::uint64_t index);
  std::uint64_t next();
  double uniform(double low, double high);  ///< in [low, high), 53 random bits

 private:
  std::uint64_t state_;
};

/// State number `index`: joint angles in [-pi, pi), slides in [-1, 1) m, quaternions of any
/// direction and a length between 1/2 and 1 (they need not be of length 1), velocities in [-3, 3),
/// accelerations in [-10, 10), joint forces in [-10, 10), SI units.
scene::State<double> drawState(const scene::Mechanism& mechanism, const std::string& scene_name,
                               std::uint64_t seed, std::uint64_t index);

}  // namespace dynwitness::crosscheck
