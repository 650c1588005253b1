// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_keyframes.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <Eigen/Core>

#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_numbers.hpp"

namespace dynwitness::scene::mjcf {

void readKeyframes(const Node& node, const Bodies& bodies, const Equalities& equalities,
                   Scene* scene, LeftOut* left_out) {
  requireKnown(node, {"key"});
  for (const Node& child : node.children) {
    requireKnown(child.element, {"name", "qpos", "qvel"}, {"time", "act", "ctrl", "mpos", "mquat"});
    if (left_out->elements["keyframe"]++ > 0) continue;
    const Said said(child.element, kNone);
    const std::string name = said.text("name");
    left_out->lines.push_back(fmt::format(
        "keyframe {} is the start; what else it says not modelled", name.empty() ? "1" : name));
    if (said.has("qpos")) {
      const auto count = static_cast<std::size_t>(scene->mechanism.positions());
      scene->start_q = said.numbers("qpos", count, count);
      std::size_t slot = 0;
      for (const MovingJoint& joint : bodies.moving) {
        if (joint.kind == JointKind::kRevolute)
          scene->start_q[slot] = angleOf(scene->start_q[slot]);
        if (!isZero(joint.ref)) scene->start_q[slot] = difference(scene->start_q[slot], joint.ref);
        slot += positionSlots(joint.kind).size();
      }
    }
    if (!said.has("qvel")) continue;
    std::size_t count = 0;
    for (const MovingJoint& joint : bodies.moving)
      count += static_cast<std::size_t>(degreesOfFreedom(joint.kind));
    const std::vector<Number> given = said.numbers("qvel", count, count);
    scene->start_qd.clear();
    std::size_t slot = 0, rate = 0;
    for (const MovingJoint& joint : bodies.moving) {
      const auto dof = static_cast<std::size_t>(degreesOfFreedom(joint.kind));
      Vector v = {0, 0, 0};
      for (std::size_t k = 0; k < std::min<std::size_t>(dof, 3); ++k) v[k] = given[rate + k];
      if (joint.kind == JointKind::kFloating && !isZero(v)) {
        const auto q = [&](std::size_t k) { return valueOf(scene->start_q[slot + k]); };
        const Matrix3 R = turnOf(q(3), {q(4), q(5), q(6)});
        v = printed(Vector3(R.transpose() * valueOf(v)), valueOf(v).norm(), said.where());
      }
      const bool follows = equalities.follows.count(joint.name) > 0;
      for (std::size_t k = 0; k < dof && !follows; ++k)
        scene->start_qd.push_back(k < 3 ? v[k] : given[rate + k]);
      rate += dof;
      slot += positionSlots(joint.kind).size();
    }
  }
}

}  // namespace dynwitness::scene::mjcf
