// SPDX-License-Identifier: Apache-2.0
// Energy and momentum of a mechanism.
#pragma once

#include <vector>

#include "recursive/joint_forces.hpp"

namespace dynwitness::recursive {

/// Velocities of all links into ws.v (and ws.X_up): v_i = X v_p + Z qd_i.
template <typename T>
void linkVelocities(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                    const std::vector<T>& qd, Workspace<T>& ws) {
  requirePositions(model, "linkVelocities", x.size());
  requireSize(model, "linkVelocities", "qd", qd.size());
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const LinkModel<T>& link = model.links[i];
    ws.X_up[i] = AnyJoints::transform(link, x);
    const Motion<T> v_J = AnyJoints::motion(link, qd);
    ws.v[i] = link.parent < 0 ? v_J : ws.X_up[i] * ws.v[link.parent] + v_J;
  }
}

/// Kinetic energy T = sum v' M v / 2 + sum d qd^2 / 2 + sum h qd z'w_p [J], rotors included; of
/// geared ones  J psi'^2 / 2 + J psi' a'w_p.
template <typename T>
T kineticEnergy(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                const std::vector<T>& qd, Workspace<T>& ws) {
  linkVelocities(model, x, qd, ws);
  T twice = T(0);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const LinkModel<T>& link = model.links[i];
    twice += dot(ws.v[i], link.M * ws.v[i]);
    if (link.dof >= 0) twice += link.rotor * qd[link.dof] * qd[link.dof];
    if (spinsOnALink(model, link))
      twice += T(2) * qd[link.dof] * dot(ws.X_up[i] * ws.v[link.parent], spinAxis(link));
  }
  for (const GearedRotor<T>& rotor : model.rotors) {
    const T rate = rotorRate(rotor, qd);
    twice += rotor.inertia * rate * rate;
    if (rotor.carrier >= 0) twice += T(2) * rate * dot(ws.v[rotor.carrier], spinAxis(rotor));
  }
  return twice / T(2);
}

/// What friction takes [W]: sum of viscous qd^2 + coulomb |qd|, never negative.
template <typename T>
T frictionPower(const Model<T>& model, const std::vector<T>& qd) {
  using scene::directionOf;
  requireSize(model, "frictionPower", "qd", qd.size());
  T power = T(0);
  for (const LinkModel<T>& link : model.links) {
    if (link.dof < 0) continue;
    const T& rate = qd[link.dof];
    const int direction = directionOf(rate);
    power += link.viscous * rate * rate;
    if (direction > 0) power += link.positive * rate;
    if (direction < 0) power -= link.negative * rate;
  }
  return power;
}

/** Potential energy V = -gravity' sum m p_c + sum k (q - rest)^2 / 2 [J], zero at the world's
    origin. The first moments of mass are carried inward, so no link needs its place in the world.
    */
template <typename T>
T potentialEnergy(const Model<T>& model, const std::vector<JointPosition<T>>& x, Workspace<T>& ws) {
  requirePositions(model, "potentialEnergy", x.size());
  T twice_springs = T(0);
  Vector3<T> h_world = model.base.h;
  for (std::size_t i = 0; i < model.links.size(); ++i) ws.I_C[i] = model.links[i].M;
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    const Transform<T> X = AnyJoints::transform(link, x);
    const T& mass = ws.I_C[i].mass;
    const Vector3<T> h = X.R.transpose() * ws.I_C[i].h + X.p * mass;
    if (link.parent < 0) {
      h_world += h;
    } else {
      ws.I_C[link.parent].mass += mass;
      ws.I_C[link.parent].h += h;
    }
    if (link.dof >= 0) {
      const T stretch = springStretch(link, x);
      twice_springs += link.stiffness * stretch * stretch;
    }
  }
  return twice_springs / T(2) - model.gravity.dot(h_world);
}

/// Momentum of all links together, in world axes about the world's origin [N s, N m s], with the
/// spin of gyroscopic rotors on links. Other rotors, whose axes the model d = n^2 J does not know,
/// are not in it.
template <typename T>
Force<T> momentum(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                  const std::vector<T>& qd, Workspace<T>& ws) {
  linkVelocities(model, x, qd, ws);
  for (std::size_t i = 0; i < model.links.size(); ++i) ws.f[i] = model.links[i].M * ws.v[i];
  for (const GearedRotor<T>& rotor : model.rotors)
    if (rotor.carrier >= 0)
      ws.f[rotor.carrier] = ws.f[rotor.carrier] + spinAxis(rotor) * rotorRate(rotor, qd);
  Force<T> total = Force<T>::zero();
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    Force<T>& inboard = link.parent < 0 ? total : ws.f[link.parent];
    Force<T> f = ws.f[i];
    if (spinsOnALink(model, link)) f = f + spinAxis(link) * qd[link.dof];
    inboard = inboard + ws.X_up[i].inverseTimes(f);
  }
  return total;
}

/** Rates of change of the position slots at rates qd: qd itself, but for a floating joint's
    position, p' = R v, and for quaternions, q' = q (0, w) / 2, which leaves their length as it is.
    @param rates  one a slot */
template <typename T>
void positionRates(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                   const std::vector<T>& qd, std::vector<T>& rates) {
  requirePositions(model, "positionRates", x.size());
  requirePositions(model, "positionRates", rates.size());
  requireSize(model, "positionRates", "qd", qd.size());
  for (const LinkModel<T>& link : model.links) {
    if (link.dof < 0) continue;
    int slot = link.slot, dof = link.dof;
    if (axisCount(link.kind) == 1) rates[slot] = link.follows ? T(link.ratio * qd[dof]) : qd[dof];
    if (link.kind == JointKind::kFloating) {
      const Vector3<T> p_rate =
          rotation(&x[slot + 3]) * Vector3<T>(qd[dof], qd[dof + 1], qd[dof + 2]);
      for (int k = 0; k < 3; ++k) rates[slot + k] = p_rate(k);
      slot += 3;
      dof += 3;
    }
    if (axisCount(link.kind) < 3) continue;
    const Vector3<T> w(qd[dof], qd[dof + 1], qd[dof + 2]);
    const Vector3<T> v(x[slot + 1].q, x[slot + 2].q, x[slot + 3].q);
    const Vector3<T> v_rate = w * x[slot].q + v.cross(w);
    rates[slot] = -v.dot(w) / T(2);
    for (int k = 0; k < 3; ++k) rates[slot + 1 + k] = v_rate(k) / T(2);
  }
}

}  // namespace dynwitness::recursive
