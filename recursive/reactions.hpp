// SPDX-License-Identifier: Apache-2.0
// What the joints of a mechanism transmit.
#pragma once

#include <stdexcept>
#include <vector>

#include "recursive/model.hpp"

namespace dynwitness::recursive {

/** The wrench that the parent exerts on the link through each joint, read off the inward sweep: f_i
    of inverseDynamics() (newton_euler.hpp, (3)), which must have run with this model and workspace.

    Z' f_i is tau_i less what rotor, spring and friction take of it; the rest is what bearings hold.
    In a chain of parts (a cylindrical joint, ...) it is the wrench that the last part passes to the
    link: the others are massless and pass the same.

    @param model  built with FixedJoints::kKept where reactions of fixed joints are wanted
    @param out    6 numbers a link of the scene but its root: force [N] and moment [N m] about the
      origin of the moved joint frame, in its axes
    @throws std::invalid_argument  out has another length, or a fixed joint was lumped
    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), equation 5.20 */
template <typename T>
void jointReactions(const Model<T>& model, const Workspace<T>& ws, std::vector<T>& out) {
  if (out.size() != 6 * (model.joints.size() - 1))
    throw std::invalid_argument("jointReactions: out: expected " +
                                std::to_string(6 * (model.joints.size() - 1)) + " numbers, got " +
                                std::to_string(out.size()));
  for (std::size_t i = 1; i < model.joints.size(); ++i) {
    const ScenePlace<T>& joint = model.joints[i];
    if (joint.link < 0)
      throw std::invalid_argument("jointReactions: model: the fixed joint of link " +
                                  std::to_string(i) + " was lumped, expected FixedJoints::kKept");
    const Vector6<T> f = (joint.X * ws.f[joint.link]).vector();
    for (int k = 0; k < 6; ++k) out[6 * (i - 1) + k] = f(k);
  }
}

}  // namespace dynwitness::recursive
