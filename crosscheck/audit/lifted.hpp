// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a robot's mass matrix, and of the places of its points.
#pragma once

#include "crosscheck/audit/robot.hpp"
#include "crosscheck/studies/kinetic_metric.hpp"

namespace dynwitness::audit {

using crosscheck::KineticMetric;
using crosscheck::lifted;

template <typename T>
MatrixX<T> compositeMassMatrix(const recursive::Model<T>& model,
                               const std::vector<scene::JointPosition<T>>& x) {
  recursive::Workspace<T> ws(model);
  MatrixX<T> M(model.dof(), model.dof());
  recursive::massMatrix(model, x, ws, M);
  return M;
}

/// The geometry of a robot whose metric is M.
template <typename T>
KineticMetric<T> metricOf(const Robot<T>& robot) {
  return KineticMetric<T>(robot.model(), robot.x);
}

/// Second derivatives of all places, d2x/dq_j dq_k, by polarization of the motion with unit rates.
template <typename T>
std::vector<Vector3<T>> secondPartials(const Robot<T>& robot, int j, int k) {
  const auto bend = [&](const std::vector<T>& qd) {
    std::vector<Vector3<T>> out;
    const auto paths = robot.paths(qd, robot.zeros());
    for (int i = 0; i < robot.n(); ++i)
      for (const Vector3<T>& r : robot.body[i].r)
        out.push_back(secondRate<T, 3, 1>(paths[i].place(r)));
    return out;
  };
  std::vector<T> both = robot.unit(j);
  both[k] += T(1);
  std::vector<Vector3<T>> out = bend(both);
  const std::vector<Vector3<T>> along_j = bend(robot.unit(j)), along_k = bend(robot.unit(k));
  for (std::size_t p = 0; p < out.size(); ++p)
    out[p] = ((out[p] - along_j[p] - along_k[p]) / T(2)).eval();
  return out;
}
template <typename T>
std::vector<Vector3<T>> firstPartials(const Robot<T>& robot, int j) {
  std::vector<Vector3<T>> out;
  const auto paths = robot.paths(robot.unit(j), robot.zeros());
  for (int i = 0; i < robot.n(); ++i)
    for (const Vector3<T>& r : robot.body[i].r) out.push_back(rate<T, 3, 1>(paths[i].place(r)));
  return out;
}
/// sum of m a' b over all points: the metric of the flat space that the robot's points move in.
template <typename T>
T weighted(const Robot<T>& robot, const std::vector<Vector3<T>>& a,
           const std::vector<Vector3<T>>& b) {
  T sum = T(0);
  std::size_t p = 0;
  for (int i = 0; i < robot.n(); ++i)
    for (const T& m : robot.body[i].m) {
      sum += m * a[p].dot(b[p]);
      ++p;
    }
  return sum;
}

}  // namespace dynwitness::audit
