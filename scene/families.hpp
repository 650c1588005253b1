// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanisms of any size, made on demand: how time, memory and digits grow.
#pragma once

#include <string>

#include "scene/scene.hpp"

namespace dynwitness::scene {

inline constexpr int kMostFamilyLinks = 1000000;

/** `links` equal links in a row, each on the end of the one before by a revolute joint, the axes in
    turn across each other; 0.1 m and 1 kg each, their centres of mass and inertias in no symmetry.
    */
Scene chainOf(int links);

/// The same with parallel axes, in an upright plane: the worse M is to solve with, the longer it
/// is.
Scene flatChainOf(int links);

/// The same links as a balanced binary tree: link k hangs on the end of link (k - 1) / 2.
Scene treeOf(int links);

/// chain_N, flat_chain_N or tree_N with N from 1 to kMostFamilyLinks, as findScene() knows them.
/// @return whether the name is one of them
bool findFamily(const std::string& name, Scene* scene);

}  // namespace dynwitness::scene
