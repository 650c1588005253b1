// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest scene that still shows a fault.
#pragma once

#include <functional>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct SmallerScene {
  scene::Scene scene;
  int trials = 0;            ///< scenes that were asked about
  bool is_smallest = false;  ///< nothing that was tried makes it smaller; false: `most` was reached
};

/** Makes a scene smaller while it shows the same: loads, closures, springs and constraints go,
    links are cut from the tips on, joints are fixed or turned into plainer ones, rotors, springs,
    friction, drives and gears go, frames and axes are straightened, and numbers become 0, 1 or 2.
    Each change is kept when the scene that it leaves is a valid file and still `shows`; all are
    tried again until none helps. The same scene and answers give the same result.

    @param shows  asked about each smaller scene; what it throws counts as no
    @param most   trials
    @throws std::invalid_argument  the scene itself does not show it */
SmallerScene smaller(const scene::Scene& scene,
                     const std::function<bool(const scene::Scene&)>& shows, int most);

}  // namespace dynwitness::crosscheck
