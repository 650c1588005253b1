// SPDX-License-Identifier: Apache-2.0
// Where a point of a link is, how it moves, and how that follows from the rates.
#pragma once

#include <stdexcept>
#include <vector>

#include "recursive/composite_body.hpp"
#include "recursive/energy.hpp"

namespace dynwitness::recursive {

/// A point of a link of the scene and the link's turn, in world axes.
template <typename T>
struct PointMotion {
  Vector3<T> position;  ///< [m]
  Matrix3<T> R;         ///< link axes to world axes: its columns are the link's axes
  Motion<T> velocity;   ///< of the point, and of the link's turn [m/s, rad/s]
  /// Of the point itself (no spatial acceleration), and dw/dt [m/s^2, rad/s^2]; without gravity.
  Motion<T> acceleration;
  MatrixX<T> J;       ///< 6 x n: velocity = J qd, linear rows first
  MatrixX<T> J_rate;  ///< dJ/dt along qd: acceleration = J qdd + J_rate qd
};

/** The motion of a point at place `at` of a scene's link. By one outward sweep of the links that
    carry it (velocities v, spatial accelerations a without gravity, in link axes), and with X the
    transformation from link i of the chain to the scene's link L, Z an axis of joint i, r = at:

        (1)  velocity      v_L + w_L x r,  w_L
        (2)  acceleration  a_L + wd_L x r + w_L x (v_L + w_L x r),  wd_L
        (3)  column of J   (s, e) = (Z_L.linear + Z_L.angular x r, Z_L.angular),   Z_L = X Z
        (4)  of J_rate     (s', e') + w_L x (s, e),   of  Z_L' = (v_i - v_L) x Z_L

    for Z is constant in link i, which moves with v_i - v_L as the scene's link sees it. All is
    turned into world axes by R. No differences, no division: O(links + depth).

    @tparam T     tested with double, running error bounds and the prime field
    @param  x, qd, qdd  positions, one a slot, rates and accelerations, length n
    @param  link  of the scene, as in model.places; it may rest in the world
    @param  at    of the point, in the link's axes [m]
    @throws std::invalid_argument  other lengths, or no such link */
template <typename T>
PointMotion<T> pointMotion(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                           const std::vector<T>& qd, const std::vector<T>& qdd, std::size_t link,
                           const Vector3<T>& at, Workspace<T>& ws) {
  requireSize(model, "pointMotion", "qdd", qdd.size());
  if (link >= model.places.size())
    throw std::invalid_argument("pointMotion: link: expected one of the scene's " +
                                std::to_string(model.places.size()) + ", got " +
                                std::to_string(link));
  linkVelocities(model, x, qd, ws);
  const ScenePlace<T>& place = model.places[link];
  std::vector<int> chain;  // the last first
  for (int i = place.link; i >= 0; i = model.links[i].parent) chain.push_back(i);
  for (std::size_t k = chain.size(); k-- > 0;) {
    const int i = chain[k], p = model.links[i].parent;
    ws.a[i] = AnyJoints::motion(model.links[i], qdd) +
              cross(ws.v[i], AnyJoints::motion(model.links[i], qd));
    if (p >= 0) ws.a[i] = ws.X_up[i] * ws.a[p] + ws.a[i];
  }

  PointMotion<T> out;
  out.J = out.J_rate = MatrixX<T>::Constant(6, model.dof(), T(0));
  Transform<T> X_LW = place.X;
  for (const int i : chain) X_LW = X_LW * ws.X_up[i];
  out.R = X_LW.R.transpose();
  out.position = X_LW.p + out.R * at;
  const auto inWorld = [&](const Motion<T>& m) {
    return Motion<T>{out.R * m.linear, out.R * m.angular};
  };
  const auto ofPoint = [&](const Motion<T>& m) {
    return Motion<T>{m.linear + m.angular.cross(at), m.angular};
  };
  const Motion<T> none = Motion<T>::zero();
  const Motion<T> v_L = place.link < 0 ? none : place.X * ws.v[place.link];
  const Motion<T> v = ofPoint(v_L);  // (1)
  Motion<T> a = ofPoint(place.link < 0 ? none : place.X * ws.a[place.link]);
  a.linear += v.angular.cross(v.linear);  // (2)
  out.velocity = inWorld(v);
  out.acceleration = inWorld(a);

  Transform<T> X = place.X;
  for (const int i : chain) {
    const Motion<T> seen = X * ws.v[i] - v_L;
    for (int k = 0; k < AnyJoints::axes(model.links[i]); ++k) {
      Motion<T> Z = none;
      AnyJoints::addMotion(model.links[i], k, T(1), Z);
      Z = X * Z;
      const Motion<T> column = ofPoint(Z);  // (3)
      Motion<T> rate = ofPoint(cross(seen, Z));
      rate =
          rate + Motion<T>{v.angular.cross(column.linear), v.angular.cross(column.angular)};  // (4)
      const int d = model.links[i].dof + k;
      out.J.col(d) += inWorld(column).vector();
      out.J_rate.col(d) += inWorld(rate).vector();
    }
    X = X * ws.X_up[i];
  }
  return out;
}

}  // namespace dynwitness::recursive
