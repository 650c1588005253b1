// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/held_joints.hpp"

#include <algorithm>
#include <cstddef>

namespace dynwitness::scene {
namespace {

bool isHeld(const JointRanges& r) {
  return r.q.most() == 0 && r.qd.most() == 0 && r.qdd.most() == 0;
}

/// Of one rate that is the derivative of its position.
bool canBeHeld(const Joint& joint) {
  return joint.kind == JointKind::kRevolute || joint.kind == JointKind::kPrismatic ||
         joint.kind == JointKind::kHelical;
}

void fix(Joint* joint) {
  Joint fixed;
  fixed.name = joint->name;
  fixed.placement = joint->placement;
  *joint = fixed;
}

}  // namespace

std::vector<std::string> fixHeldJoints(Scene* scene, std::vector<JointRanges>* ranges) {
  Mechanism& mechanism = scene->mechanism;
  const std::vector<int> moving = mechanism.movingLinks();
  const auto joint = [&](int link) -> Joint& {
    return mechanism.links[static_cast<std::size_t>(link)].joint;
  };
  // rates and positions are counted alike only where every joint has one of its own
  const bool is_plain = std::all_of(moving.begin(), moving.end(), [&](int link) {
    return canBeHeld(joint(link)) && !joint(link).mimic;
  });
  if (!is_plain || ranges->size() != moving.size() ||
      std::all_of(ranges->begin(), ranges->end(), isHeld))
    return {};
  std::vector<std::string> held;
  std::vector<JointRanges> left;
  std::vector<Number> q, qd;
  for (std::size_t k = 0; k < moving.size(); ++k) {
    if (isHeld((*ranges)[k])) {
      held.push_back(joint(moving[k]).name);
      fix(&joint(moving[k]));
      continue;
    }
    left.push_back((*ranges)[k]);
    q.push_back(scene->start_q[k]);
    qd.push_back(scene->start_qd[k]);
  }
  *ranges = left;
  scene->start_q = q;
  scene->start_qd = qd;
  return held;
}

}  // namespace dynwitness::scene
