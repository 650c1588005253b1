// SPDX-License-Identifier: GPL-3.0-or-later
// How a point of a link moves: its Jacobian in world axes, by the sweep of velocities.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/constraints.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// A point of a link of the scene.
template <typename T>
struct LinkPoint {
  int link;                  ///< of the scene
  recursive::Vector3<T> at;  ///< in the link's frame [m]
};

/** J, 6 x n: the point's velocity (rows 0 to 2) and the link's angular velocity (3 to 5) in world
    axes are J qd. Column k is the velocity at qd = e_k.
    @param X_LW  if given, becomes the transform from world to the link's frame */
template <typename T>
recursive::MatrixX<T> pointJacobian(const recursive::Model<T>& model,
                                    const std::vector<scene::JointPosition<T>>& x,
                                    const LinkPoint<T>& point,
                                    recursive::Transform<T>* X_LW = nullptr) {
  const recursive::ScenePlace<T>& place = model.places[point.link];
  recursive::MatrixX<T> J = recursive::MatrixX<T>::Constant(6, model.dof(), T(0));
  recursive::Workspace<T> ws(model);
  std::vector<T> unit(model.dof(), T(0));
  recursive::linkVelocities(model, x, unit, ws);
  recursive::Transform<T> X = place.X;
  for (int i = place.link; i >= 0; i = model.links[i].parent) X = X * ws.X_up[i];
  if (X_LW != nullptr) *X_LW = X;
  if (place.link < 0) return J;
  for (int k = 0; k < model.dof(); ++k) {
    unit[k] = T(1);
    recursive::linkVelocities(model, x, unit, ws);
    unit[k] = T(0);
    const recursive::Motion<T> v = place.X * ws.v[place.link];
    const recursive::Vector3<T> of_point = v.linear + v.angular.cross(point.at);
    const recursive::Vector3<T> linear = X.R.transpose() * of_point,
                                angular = X.R.transpose() * v.angular;
    for (int i = 0; i < 3; ++i) {
      J(i, k) = linear(i);
      J(3 + i, k) = angular(i);
    }
  }
  return J;
}

/// The scene's link of this name, or its last one for "".
/// @throws scene::InputError  there is none, or it rests in the world
inline int linkNamed(const scene::Scene& scene, const std::string& name) {
  const std::vector<scene::Link>& links = scene.mechanism.links;
  std::string names;
  for (std::size_t i = 1; i < links.size(); ++i) {
    if (links[i].name == name || (name.empty() && i + 1 == links.size()))
      return static_cast<int>(i);
    names += (names.empty() ? "" : ", ") + links[i].name;
  }
  throw scene::InputError({scene.file.string(), 0},
                          fmt::format("has no link '{}' that moves, allowed: {}", name, names));
}

/** Numbers that are as good as independent, from one indeterminate a: a^(3^k). Products of two of
    them are all different powers, none of which is one of them: a law that is linear or quadratic
    in such numbers holds for all numbers if it holds for these. */
template <typename T>
class Powers {
 public:
  explicit Powers(const T& a) : next_(a) {}
  T operator()() {
    const T now = next_;
    next_ = next_ * next_ * next_;
    return now;
  }
  recursive::Vector3<T> vector() {
    const T x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  T next_;
};

}  // namespace dynwitness::crosscheck
