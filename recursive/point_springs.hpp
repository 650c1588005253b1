// SPDX-License-Identifier: Apache-2.0
// Springs with dampers between two points of two links.
#pragma once

#include <stdexcept>
#include <vector>

#include "recursive/build_model.hpp"

namespace dynwitness::recursive {

template <typename T>
struct PointSpring {
  int a, b;                    ///< links, -1: the world
  Vector3<T> at_a, at_b;       ///< [m] in link axes
  T stiffness, rest, damping;  ///< [N/m], [m], [N s/m]
};

template <typename Numbers, typename T = typename Numbers::Scalar>
std::vector<PointSpring<T>> buildPointSprings(const scene::Mechanism& mechanism,
                                              const Numbers& number, const Model<T>& model) {
  std::vector<PointSpring<T>> springs;
  const auto point = [&](const scene::Attachment& at) {
    const Transform<T>& X = model.places[at.link].X;
    return Vector3<T>(X.p + X.R.transpose() * detail::vector<T>(at.xyz, number));
  };
  for (const scene::Spring& s : mechanism.springs)
    springs.push_back({model.places[s.a.link].link, model.places[s.b.link].link, point(s.a),
                       point(s.b), number(s.stiffness), number(s.rest), number(s.damping)});
  return springs;
}

/// What the springs hold, and what their dampers take.
template <typename T>
struct SpringState {
  T energy = T(0);       ///< sum k (l - rest)^2 / 2 [J]
  T dissipation = T(0);  ///< sum c (dl/dt)^2 [W], zero or more
};

namespace detail {

/** Adds the joint forces of pulls between the springs' points to tau:  tau_i += Z_i' (forces
    outboard of joint i).
    @param pull  (spring, d, d') -> force on a, its negative acts on b, in world axes; d from a to b
    @see addSpringForces() for the rest */
template <typename T, typename Pull>
void addPulls(const Model<T>& model, const std::vector<PointSpring<T>>& springs,
              const std::vector<Transform<T>>& X_W, Workspace<T>& ws, std::vector<T>& tau,
              const Pull& pull) {
  if (springs.empty()) return;
  for (Force<T>& f : ws.f) f = Force<T>::zero();
  struct End {
    Vector3<T> p, v;  // in the world
  };
  const auto end = [&](int link, const Vector3<T>& at) {
    if (link < 0) return End{at, Vector3<T>::Zero()};
    const Transform<T>& X = X_W[link];
    return End{X.p + X.R.transpose() * at,
               X.R.transpose() * (ws.v[link].linear + ws.v[link].angular.cross(at))};
  };
  for (const PointSpring<T>& s : springs) {
    const End a = end(s.a, s.at_a), b = end(s.b, s.at_b);
    const Vector3<T> on_a = pull(s, Vector3<T>(b.p - a.p), Vector3<T>(b.v - a.v));
    const auto add = [&](int link, const Vector3<T>& at, const Vector3<T>& force_W) {
      if (link < 0) return;
      const Vector3<T> force = X_W[link].R * force_W;
      ws.f[link] = ws.f[link] + Force<T>{force, at.cross(force)};
    };
    add(s.a, s.at_a, on_a);
    add(s.b, s.at_b, -on_a);
  }
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    for (int k = 0; k < AnyJoints::axes(link); ++k)
      tau[link.dof + k] += AnyJoints::force(link, k, ws.f[i]);
    if (link.parent >= 0) ws.f[link.parent] = ws.f[link.parent] + ws.X_up[i].inverseTimes(ws.f[i]);
  }
}

}  // namespace detail

/** Adds the joint forces of the springs to tau: with l and e the distance and direction from a to
    b,
        f = (k (l - rest) + c dl/dt) e   on a, and -f on b
    @param  ws   with X_up and v set (linkVelocities); ws.f is written on
    @param  X_W  world to link, by link
    @throws std::domain_error  a spring with rest > 0 has no length and so no direction */
template <typename T>
SpringState<T> addSpringForces(const Model<T>& model, const std::vector<PointSpring<T>>& springs,
                               const std::vector<Transform<T>>& X_W, Workspace<T>& ws,
                               std::vector<T>& tau) {
  using std::sqrt;
  SpringState<T> state;
  const auto pullOf = [&state](const PointSpring<T>& s, const Vector3<T>& d,
                               const Vector3<T>& d_rate) {
    const T length = sqrt(d.dot(d));
    Vector3<T> pull = d * s.stiffness;  // of a spring without length at rest
    T rate = T(0);
    if (length > T(0)) {
      const Vector3<T> e = d * (T(1) / length);
      rate = e.dot(d_rate);
      pull = e * (s.stiffness * (length - s.rest) + s.damping * rate);
    } else if (s.rest > T(0)) {
      throw std::domain_error("a spring has shrunk to a point and has no direction");
    }
    state.energy += s.stiffness * (length - s.rest) * (length - s.rest) / T(2);
    state.dissipation += s.damping * rate * rate;
    return pull;
  };
  detail::addPulls(model, springs, X_W, ws, tau, pullOf);
  return state;
}

}  // namespace dynwitness::recursive
