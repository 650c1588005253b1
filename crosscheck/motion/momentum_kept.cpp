// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/momentum_kept.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "crosscheck/motion/tree_motion.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

bool keepsMomentum(const scene::Mechanism& mechanism) {
  const scene::RealNumbers<double> number(mechanism);
  const bool has_gravity =
      mechanism.has_gravity && std::any_of(mechanism.gravity.begin(), mechanism.gravity.end(),
                                           [&](const scene::Number& g) { return number(g) != 0; });
  if (has_gravity || !mechanism.wrenches.empty() || !mechanism.isOpenTree()) return false;
  std::vector<bool> rests;
  for (const scene::Link& link : mechanism.links) {
    const bool on_ground = link.parent < 0 || rests[static_cast<std::size_t>(link.parent)];
    const scene::JointKind kind = link.joint.kind;
    rests.push_back(on_ground && (link.parent < 0 || kind == scene::JointKind::kFixed));
    if (on_ground && !rests.back() && kind != scene::JointKind::kFloating) return false;
  }
  return true;
}

std::optional<double> momentumMoved(const scene::Scene& scene, const std::vector<double>& end) {
  if (!keepsMomentum(scene.mechanism)) return std::nullopt;
  TreeMotion<double> motion(scene.mechanism);
  const std::vector<double> before = motion.totalMomentum(startOf<double>(scene)),
                            after = motion.totalMomentum(end);
  double size = 0, moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    size = std::max(size, std::abs(before[i]));
    moved = std::max(moved, std::abs(after[i] - before[i]));
  }
  if (size == 0) return std::nullopt;
  return moved / size;
}

double roundingOfMomentum(const scene::Mechanism& mechanism, double steps) {
  return steps * std::numeric_limits<double>::epsilon() * mechanism.dof();
}

}  // namespace dynwitness::crosscheck
