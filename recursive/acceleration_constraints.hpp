// SPDX-License-Identifier: Apache-2.0
// The scene's constraints on accelerations in the words of the sweeps.
#pragma once

#include "recursive/build_model.hpp"
#include "recursive/constrained_dynamics.hpp"
#include "recursive/energy.hpp"

namespace dynwitness::recursive {

/** The acceleration constraints of a mechanism at a state (scene::AccelerationConstraint): with r
    the point, u the direction and d the rotation in link axes, v and w the link's velocity,

        A = (u, r x u + d),   b = value - u . (w x (v + w x r)),   C = compliance

    because  u . xdd + d . wd  is  u . (a + wd x r + w x (v + w x r)) + d . wd.
    @param ws  linkVelocities() writes on it, and on R_W */
template <typename Numbers, typename T = typename Numbers::Scalar>
std::vector<LinkConstraint<T>> accelerationConstraints(const scene::Mechanism& mechanism,
                                                       const Numbers& number, const Model<T>& model,
                                                       const std::vector<JointPosition<T>>& x,
                                                       const std::vector<T>& qd, Workspace<T>& ws) {
  using Axes = scene::AccelerationConstraint::Axes;
  linkVelocities(model, x, qd, ws);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const int p = model.links[i].parent;
    ws.R_W[i] = p < 0 ? ws.X_up[i].R : Matrix3<T>(ws.X_up[i].R * ws.R_W[p]);
  }
  std::vector<LinkConstraint<T>> out;
  for (const scene::AccelerationConstraint& held : mechanism.acceleration_constraints) {
    const ScenePlace<T>& place = model.places[held.link];
    if (place.link < 0)
      throw std::invalid_argument(
          "accelerationConstraints: \"" + held.name +
          "\": expected a link that moves, got one that rests in the world");
    const Matrix3<T> R =
        held.axes == Axes::kWorld ? ws.R_W[place.link] : Matrix3<T>(place.X.R.transpose());
    const Vector3<T> u = R * detail::vector<T>(held.direction, number),
                     d = R * detail::vector<T>(held.rotation, number),
                     r = place.X.p + place.X.R.transpose() * detail::vector<T>(held.at, number);
    const Motion<T>& v = ws.v[place.link];
    const Vector3<T> v_point = v.linear + v.angular.cross(r);
    LinkConstraint<T> constraint;
    constraint.link = place.link;
    constraint.A = Force<T>{u, r.cross(u) + d}.vector();
    constraint.b.resize(1);
    constraint.b(0) = number(held.value) - u.dot(v.angular.cross(v_point));
    constraint.compliance.resize(1);
    constraint.compliance(0) = number(held.compliance);
    out.push_back(constraint);
  }
  return out;
}

}  // namespace dynwitness::recursive
