// SPDX-License-Identifier: GPL-3.0-or-later
// Differentiating the sweeps: a model whose constants are duals, and states that move.
#pragma once

#include "crosscheck/audit/robot.hpp"
#include "recursive/composite_body.hpp"

namespace dynwitness::audit {

/// The same model for duals: its numbers are constants.
template <typename S, typename T>
recursive::Model<S> lifted(const recursive::Model<T>& model) {
  const auto vector = [](const Vector3<T>& v) { return Vector3<S>(S(v.x()), S(v.y()), S(v.z())); };
  recursive::Model<S> out;
  out.gravity = vector(model.gravity);
  out.link_of_dof = model.link_of_dof;
  out.positions = model.positions;
  out.plain_joints = model.plain_joints;
  for (const recursive::LinkModel<T>& link : model.links) {
    recursive::LinkModel<S> l;
    l.parent = link.parent;
    l.dof = link.dof;
    l.slot = link.slot;
    l.kind = link.kind;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) l.X_tree.R(i, j) = S(link.X_tree.R(i, j));
    l.X_tree.p = vector(link.X_tree.p);
    const Symmetric3<T>& I = link.M.I;
    l.M = {
        S(link.M.mass), vector(link.M.h), {S(I.xx), S(I.yy), S(I.zz), S(I.xy), S(I.xz), S(I.yz)}};
    l.rotor = S(link.rotor);
    out.links.push_back(l);
  }
  return out;
}

template <typename T>
MatrixX<T> compositeMassMatrix(const recursive::Model<T>& model,
                               const std::vector<scene::JointPosition<T>>& x) {
  recursive::Workspace<T> ws(model);
  MatrixX<T> M(model.dof(), model.dof());
  recursive::massMatrix(model, x, ws, M);
  return M;
}

/// dM/dq_k for every k.
template <typename T>
std::vector<MatrixX<T>> massMatrixGradient(const Robot<T>& robot) {
  using D = Dual<T>;
  const recursive::Model<D> model = lifted<D>(robot.model());
  std::vector<MatrixX<T>> out;
  for (int k = 0; k < robot.n(); ++k) {
    std::vector<scene::JointPosition<D>> x;
    for (int i = 0; i < robot.n(); ++i)
      x.push_back(crosscheck::moving(robot.x[i], T(i == k ? 1 : 0)));
    const MatrixX<D> M = compositeMassMatrix<D>(model, x);
    MatrixX<T> dM(robot.n(), robot.n());
    for (int i = 0; i < robot.n(); ++i)
      for (int j = 0; j < robot.n(); ++j) dM(i, j) = M(i, j).derivative;
    out.push_back(dM);
  }
  return out;
}

/// Christoffel symbols of the first kind of the metric M: (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i)
/// / 2.
template <typename T>
T christoffel(const std::vector<MatrixX<T>>& dM, int i, int j, int k) {
  return (dM[k](i, j) + dM[j](i, k) - dM[i](j, k)) / T(2);
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
