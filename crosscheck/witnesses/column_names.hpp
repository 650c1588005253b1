// SPDX-License-Identifier: GPL-3.0-or-later
// What the columns of a table are called that holds a quantity.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/witnesses/witness.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/// M11, M12, ... row by row (M1_1 from ten joints on, where M111 would be two things); c1, c2, ...;
/// a single number has its own name; reactions are those of the joint: elbow.fx, ..., elbow.mz.
std::vector<std::string> columnNames(Quantity quantity, const scene::Mechanism& mechanism);

/// What they are in: "kg m^2", "N m".
std::vector<std::string> columnUnits(Quantity quantity, const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
