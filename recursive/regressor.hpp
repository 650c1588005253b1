// SPDX-License-Identifier: Apache-2.0
// Joint forces as a linear function of the inertial parameters.
#pragma once

#include <vector>

#include "recursive/build_model.hpp"
#include "recursive/joint_forces.hpp"
#include "scene/inertial_parameters.hpp"

namespace dynwitness::recursive {

/// Six numbers of a rotational inertia, times an angular velocity: column k of L(w), with L(w) I =
/// I w for I = (xx, yy, zz, xy, xz, yz).
template <typename T>
Vector3<T> inertiaColumn(const Vector3<T>& w, int k) {
  const T zero = T(0);
  switch (k) {
    case 0:
      return {w.x(), zero, zero};
    case 1:
      return {zero, w.y(), zero};
    case 2:
      return {zero, zero, w.z()};
    case 3:
      return {w.y(), w.x(), zero};
    case 4:
      return {w.z(), zero, w.x()};
    default:
      return {zero, w.z(), w.y()};
  }
}

/** The force that a body with parameter k = 1 and all others 0 needs to move with velocity v and
    spatial acceleration a (k in the order of scene::InertialParameter): column k of

        A(v, a) (m, h, I) = M a + v x* M v

    With the acceleration of the body's point at the origin, b = a.linear + w x v.linear, that is
        m: (b, 0)   h_k: (w' x e_k + w x (w x e_k), e_k x b)   I_k:  (0, L(w')_k + w x L(w)_k) */
template <typename T>
Force<T> forceColumn(const Motion<T>& v, const Motion<T>& a, int k) {
  const Vector3<T> b = a.linear + v.angular.cross(v.linear);
  if (k == 0) return {b, Vector3<T>::Constant(T(0))};
  if (k > 3)
    return {Vector3<T>::Constant(T(0)),
            inertiaColumn(a.angular, k - 4) + v.angular.cross(inertiaColumn(v.angular, k - 4))};
  Vector3<T> e = Vector3<T>::Constant(T(0));
  e(k - 1) = T(1);
  return {a.angular.cross(e) + v.angular.cross(v.angular.cross(e)), e.cross(b)};
}

/** The regressor Y(q, qd, qdd) [n x p]: the joint forces of inverse dynamics without springs,
    friction and loads are  tau = Y pi,  with pi the inertial parameters, in the order of
    `parameters`.

    Motions go outward as in inverseDynamics(). Each link of the scene then brings the ten forces of
    its parameters, in its own frame; a force on link i is felt by the joints from i inward, and by
    no other:
        (1)  v_i = X v_p + Z qd_i
        (2)  a_i = X a_p + Z qdd_i + v_i x Z qd_i          a_0 = -gravity
        (3)  Y_d,k = Z_d' f,   f = A(v, a)_k at the link, X' f at the next link inboard, ...
        (4)  Y_d,rotor = qdd_d                             at the rotor's joint
        (5)  of a gyroscopic one also z'(dw_p/dt) / n, and inboard Z'(0, qdd z + w_p x qd z) / n
        (6)  of one geared to several rates  n (psi'' + a'dw/dt),  and from its carrier inboard
             Z'(0, psi'' a + w x psi' a)
    Cost: O(n p) where the tree is a chain. Nothing is allocated.

    @tparam T   tested with double, running error bounds, prime field, balls
    @param  x, qd, qdd  as in inverseDynamics()
    @param  parameters  scene::inertialParameters() of the mechanism that the model was built of
    @param  Y   n x p; row units N m (N) per unit of the column's parameter
    @throws std::invalid_argument  a vector or Y is not of its size
    @see C. Atkeson, C. An, J. Hollerbach, Estimation of inertial parameters of manipulator loads
      and
         links, Int. J. Robotics Research 5(3), 1986 */
template <typename T, typename Matrix>
void regressor(const Model<T>& model, const std::vector<scene::InertialParameter>& parameters,
               const std::vector<JointPosition<T>>& x, const std::vector<T>& qd,
               const std::vector<T>& qdd, Workspace<T>& ws, Matrix& Y) {
  requirePositions(model, "regressor", x.size());
  requireSize(model, "regressor", "qd", qd.size());
  requireSize(model, "regressor", "qdd", qdd.size());
  if (Y.rows() != model.dof() || Y.cols() != static_cast<Eigen::Index>(parameters.size()))
    throw std::invalid_argument(
        "regressor: Y: expected one row a joint and one column a parameter");
  Motion<T> a_0 = Motion<T>::zero();
  a_0.linear = -model.gravity;

  // outward: how each link moves
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const LinkModel<T>& link = model.links[i];
    const int p = link.parent;
    ws.X_up[i] = AnyJoints::transform(link, x);
    const Motion<T> v_J = AnyJoints::motion(link, qd);
    ws.v[i] = p < 0 ? v_J : ws.X_up[i] * ws.v[p] + v_J;  // (1)
    ws.a[i] = ws.X_up[i] * (p < 0 ? a_0 : ws.a[p]) + AnyJoints::motion(link, qdd) +
              cross(ws.v[i], v_J);  // (2)
  }

  // inward: what each parameter's force does to the joints that carry it
  std::size_t next_rotor = 0;  // geared rotors come in the order of the model's
  for (Eigen::Index j = 0; j < Y.cols(); ++j) {
    for (Eigen::Index d = 0; d < Y.rows(); ++d) Y(d, j) = T(0);
    const scene::InertialParameter& parameter = parameters[j];
    const ScenePlace<T>& place = model.places[parameter.link];
    int i = place.link;
    Force<T> f = Force<T>::zero();
    if (parameter.rotor >= 0) {
      const GearedRotor<T>& rotor = model.rotors[next_rotor++];
      const T acceleration = rotorRate(rotor, qdd), per_rotor = T(1) / rotor.inertia;
      T moment = acceleration;
      i = rotor.carrier;
      if (i >= 0) {
        moment += dot(ws.a[i], spinAxis(rotor)) * per_rotor;
        f = spinForce(rotor, rotorRate(rotor, qd), acceleration, ws.v[i]) * per_rotor;
      }
      for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
        Y(rotor.dof + static_cast<int>(k), j) += rotor.ratio[k] * moment;  // (6)
    } else if (parameter.kind == scene::InertialParameter::Kind::kRotor) {
      const LinkModel<T>& link = model.links[i];
      const T k2 = link.follows ? T(link.ratio * link.ratio) : T(1);  // as in link.rotor
      Y(link.dof, j) = k2 * qdd[link.dof];                            // (4)
      if (!model.gyroscopic || link.parent < 0) continue;
      const T per_rotor = k2 / link.rotor;
      const Motion<T> v_p = ws.X_up[i] * ws.v[link.parent], a_p = ws.X_up[i] * ws.a[link.parent];
      Y(link.dof, j) += dot(a_p, spinAxis(link)) * per_rotor;  // (5)
      f = ws.X_up[i].inverseTimes(spinForce(link, qd[link.dof], qdd[link.dof], v_p) * per_rotor);
      i = link.parent;
    } else {
      f = place.X.inverseTimes(
          forceColumn(place.X * ws.v[i], place.X * ws.a[i], static_cast<int>(parameter.kind)));
    }
    for (; i >= 0; f = ws.X_up[i].inverseTimes(f), i = model.links[i].parent)
      for (int k = 0; k < AnyJoints::axes(model.links[i]); ++k)
        Y(model.links[i].dof + k, j) += AnyJoints::force(model.links[i], k, f);  // (3)
  }
}

/// The values pi of the parameters, as the scene has them, in the scalar of `number`.
template <typename Numbers, typename T = typename Numbers::Scalar>
std::vector<T> inertialValues(const scene::Mechanism& mechanism,
                              const std::vector<scene::InertialParameter>& parameters,
                              const Numbers& number) {
  std::vector<T> pi;
  for (const scene::InertialParameter& parameter : parameters) {
    const scene::Link& link = mechanism.links[parameter.link];
    if (parameter.kind == scene::InertialParameter::Kind::kRotor) {
      if (parameter.rotor >= 0) {
        pi.push_back(number(link.joint.rotors[static_cast<std::size_t>(parameter.rotor)].inertia));
        continue;
      }
      const T gear = number(link.joint.gear_ratio);
      pi.push_back(gear * gear * number(link.joint.rotor_inertia));
      continue;
    }
    const RigidInertia<T> M = detail::rigidInertia<T>(link.inertia, number);
    const T ten[] = {M.mass, M.h.x(), M.h.y(), M.h.z(), M.I.xx,
                     M.I.yy, M.I.zz,  M.I.xy,  M.I.xz,  M.I.yz};
    pi.push_back(ten[static_cast<int>(parameter.kind)]);
  }
  return pi;
}

/// Gives the model these values: links that move have what pi says and nothing else; a rotor that
/// is no parameter stays as it is.
template <typename T>
void setInertialValues(Model<T>& model, const std::vector<scene::InertialParameter>& parameters,
                       const std::vector<T>& pi) {
  for (LinkModel<T>& link : model.links) link.M = RigidInertia<T>::zero();
  std::size_t next_rotor = 0;
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const ScenePlace<T>& place = model.places[parameters[j].link];
    LinkModel<T>& link = model.links[place.link];
    if (parameters[j].rotor >= 0) {
      model.rotors[next_rotor++].inertia = pi[j];
    } else if (parameters[j].kind == scene::InertialParameter::Kind::kRotor) {
      const T rotor = link.follows ? T(link.ratio * link.ratio * pi[j]) : pi[j];
      if (model.gyroscopic) link.spin *= rotor / link.rotor;
      link.rotor = rotor;
    }
    if (parameters[j].kind != scene::InertialParameter::Kind::kMass) continue;
    const T* k = &pi[j];
    link.M = link.M + place.X.inverseTimes(RigidInertia<T>{
                          k[0], {k[1], k[2], k[3]}, {k[4], k[5], k[6], k[7], k[8], k[9]}});
  }
}

}  // namespace dynwitness::recursive
