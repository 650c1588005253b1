// SPDX-License-Identifier: Apache-2.0
// What acts on joints and links besides inertia, gravity and the given joint forces: springs,
// friction, loads, and the spin of gyroscopic rotors. Every sweep takes them from here.
#pragma once

#include <vector>

#include "recursive/model.hpp"

namespace dynwitness::recursive {

/// By how much a joint's spring is off its rest [rad], [m].
template <typename T>
T springStretch(const LinkModel<T>& link, const std::vector<JointPosition<T>>& x) {
  return x[link.slot + link.spring_from].q - link.rest;
}

/// What friction takes of a joint's force at this rate [N m], [N]: viscous qd + Coulomb's part,
/// which is 0 at rest.
template <typename T>
T frictionForce(const LinkModel<T>& link, const T& qd) {
  using scene::directionOf;
  const int direction = directionOf(qd);
  T force = link.viscous * qd;
  if (direction > 0) force += link.positive;
  if (direction < 0) force -= link.negative;
  return force;
}

/** The joint forces that a joint's own parts take at rate d, one after the other:

        take(k (q - rest)),   take(friction(qd))            [N m], [N]

    Inverse dynamics adds them to tau, forward dynamics takes them off. A joint force that depends
    on position and rate alone is one line more here (and its energy or power a term in energy.hpp).
    @param  terms  springs and friction can be left out */
template <typename T, typename Take>
void passiveForces(const Model<T>& model, const LinkModel<T>& link, int d,
                   const std::vector<JointPosition<T>>& x, const std::vector<T>& qd, Terms terms,
                   const Take& take) {
  if (terms.springs) take(T(link.stiffness * springStretch(link, x)));
  if (model.friction && terms.friction) take(frictionForce(link, qd[d]));
}

/// (0, h z): what a gyroscopic rotor does to its parent by spinning up, and, as a product with a
/// motion of the parent in the link's coordinates, h z'w, what it feels of that motion.
template <typename T>
Force<T> spinAxis(const LinkModel<T>& link) {
  return {Vector3<T>::Constant(T(0)), Vector3<T>(T(0), T(0), link.spin)};
}
/// The rate of change of that rotor's momentum h qd z as it is carried around by its parent, whose
/// motion in the link's coordinates is v_p:  h qdd z + w_p x h qd z.
template <typename T>
Force<T> spinForce(const LinkModel<T>& link, const T& qd, const T& qdd, const Motion<T>& v_p) {
  const Force<T> axis = spinAxis(link);
  return {axis.force, axis.moment * qdd + v_p.angular.cross(axis.moment) * qd};
}
/// Whether link i's joint has a rotor that a link carries: one on the world is felt by nobody.
template <typename T>
bool spinsOnALink(const Model<T>& model, const LinkModel<T>& link) {
  return model.gyroscopic && link.dof >= 0 && link.parent >= 0;
}

/// n'nu of the rates of its joint, or of their accelerations.
template <typename T>
T rotorRate(const GearedRotor<T>& rotor, const std::vector<T>& rates) {
  T rate = T(0);
  for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
    rate += rotor.ratio[k] * rates[rotor.dof + k];
  return rate;
}
/// The momentum (0, J a) that it has at unit rate beside its carrier's, in the carrier's
/// coordinates; as a product with a motion of the carrier, what it feels of that motion.
template <typename T>
Force<T> spinAxis(const GearedRotor<T>& rotor) {
  return {Vector3<T>::Constant(T(0)), rotor.axis * rotor.inertia};
}
/// J psi'' a + w x J psi' a: the rate of change of its spin, w being the carrier's.
template <typename T>
Force<T> spinForce(const GearedRotor<T>& rotor, const T& rate, const T& acceleration,
                   const Motion<T>& v) {
  const Force<T> axis = spinAxis(rotor);
  return {axis.force, axis.moment * acceleration + v.angular.cross(axis.moment) * rate};
}

/// Takes the scene's loads off the forces f that the links need, link by link.
/// ws.X_up must be set; ws.R_W is set when a load in world axes asks for it.
template <typename T>
void subtractLoads(const Model<T>& model, Workspace<T>& ws, std::vector<Force<T>>& f) {
  for (std::size_t i = 0; i < model.links.size(); ++i) f[i] = f[i] - model.links[i].load;
  if (model.world_loads.empty()) return;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const int p = model.links[i].parent;
    ws.R_W[i] = p < 0 ? ws.X_up[i].R : Matrix3<T>(ws.X_up[i].R * ws.R_W[p]);
  }
  for (const WorldLoad<T>& load : model.world_loads) {
    const Matrix3<T>& R = ws.R_W[load.link];
    const Vector3<T> force = R * load.force;
    f[load.link] = f[load.link] - Force<T>{force, R * load.moment + load.at.cross(force)};
  }
}

}  // namespace dynwitness::recursive
