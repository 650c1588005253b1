// SPDX-License-Identifier: GPL-3.0-or-later
// Articulated inertia as a value function: what dynamic programming over the links computes.
#pragma once

#include <vector>

#include "crosscheck/laws/swept_mechanism.hpp"

namespace dynwitness::crosscheck {

/** What the subtree of each link costs to move, by minimising over all its joints at once.

    Gauss: the accelerations of free joints are those at which

        G = sum over links j of  a_j' M_j a_j / 2 + a_j' (v_j x* M_j v_j - loads)
          + sum over joints of   d u^2 / 2 - (tau - k (q - rest)) u,       a_j = X a_p + c_j + Z u
          + sum over gyroscopic rotors of  h u z'(X a_p) + (w_p x h qd z)'(X a_p)

    is least. Let link i move with acceleration a and everything outboard give way: the least G of
    its subtree is  a' M_A a / 2 + a' f_A + constant.  A sweep finds M_A and f_A joint by joint, the
    minimum of one subtree from those of its children (Bellman). Here it is one minimisation: with
    a_j = T_j a + L_j u + b_j for all joints outboard together,

        M_A = H_aa - H_au H_uu^-1 H_ua,    f_A = g_a - H_au H_uu^-1 g_u

    @param ws  holds X_up, v and c, as forwardDynamics() left them
    @return  [M_A f_A] of all links, one below the other [6 links x 7]; division by zero where H_uu
             is singular. H_uu is a mass matrix: where it is positive definite, stationary is least.
             */
template <typename T>
recursive::MatrixX<T> leastGauss(const recursive::Model<T>& model,
                                 const std::vector<scene::JointPosition<T>>& x,
                                 const std::vector<T>& qd, const std::vector<T>& tau,
                                 recursive::Workspace<T>& ws) {
  using namespace recursive;
  using Matrix = MatrixX<T>;
  const int links = static_cast<int>(model.links.size());
  std::vector<Force<T>> bias;
  for (int j = 0; j < links; ++j) bias.push_back(biasForce(model.links[j].M, ws.v[j]));
  subtractLoads(model, ws, bias);

  Matrix out(6 * links, 7);
  for (int i = 0; i < links; ++i) {
    // the subtree, and the joints in it but that of link i
    std::vector<int> column(links,
                            -1);  // of a link's first joint axis in u; -2: not in the subtree
    int m = 0;
    for (int j = 0; j < links; ++j) {
      const int p = model.links[j].parent;
      column[j] = j == i ? -1 : j > i && p >= i && column[p] != -2 ? m : -2;
      if (column[j] >= 0) m += axisCount(model.links[j].kind);
    }
    // a_j as a function of those of (a, u, 1) that move it, and G with it: H, its last column g
    const int size = 6 + m;
    std::vector<Matrix> A(links);
    std::vector<std::vector<int>> movers(links);  // of each column of A_j, the last that of 1
    Matrix H = Matrix::Constant(size, size + 1, T(0));
    for (int j = i; j < links; ++j) {
      if (column[j] == -2) continue;
      const LinkModel<T>& link = model.links[j];
      const int axes = j == i ? 0 : axisCount(link.kind);
      if (j == i) {
        A[j] = Matrix::Constant(6, 7, T(0));
        for (int k = 0; k < 6; ++k) A[j](k, k) = T(1);
        movers[j] = {0, 1, 2, 3, 4, 5, size};
      } else {
        const std::vector<int>& inboard = movers[link.parent];
        const auto last = static_cast<Eigen::Index>(inboard.size()) - 1;
        const Matrix carried = ws.X_up[j].motionMatrix() * A[link.parent];
        A[j].resize(6, last + 1 + axes);
        A[j].leftCols(last) = carried.leftCols(last);
        A[j].col(last + axes) = carried.col(last) + ws.c[j].vector();
        movers[j].assign(inboard.begin(), inboard.end() - 1);
        for (int k = 0; k < axes; ++k) {
          const int u = 6 + column[j] + k;
          A[j].col(last + k) = jointAxis(link, k);
          movers[j].push_back(u);
          H(u, u) += link.rotor;
          T drive = tau[link.dof + k];
          if (axes == 1) drive -= link.stiffness * (x[link.slot + link.spring_from].q - link.rest);
          H(u, size) -= drive;
        }
        movers[j].push_back(size);
        if (model.gyroscopic && axes == 1) {
          // the spin h qd z on the parent: h u z'a_p, and what carrying it around takes
          const Vector6<T> axis = spinAxis(link).vector(),
                           f = spinForce(link, qd[link.dof], T(0), ws.X_up[j] * ws.v[link.parent])
                                   .vector();
          const int u = 6 + column[j];
          for (Eigen::Index r = 0; r <= last; ++r) {
            const T along = axis.dot(carried.col(r));
            H(u, inboard[r]) += along;
            if (r == last) break;
            H(inboard[r], u) += along;
            H(inboard[r], size) += f.dot(carried.col(r));
          }
        }
      }
      const Matrix6<T> M = ArticulatedInertia<T>::fromRigid(link.M).matrix();
      const Matrix moved = M * A[j];
      const Vector6<T> b = bias[j].vector();
      const auto count = static_cast<Eigen::Index>(movers[j].size());
      for (Eigen::Index r = 0; r + 1 < count; ++r) {
        for (Eigen::Index s = 0; s < count; ++s)
          H(movers[j][r], movers[j][s]) += A[j].col(r).dot(moved.col(s));
        H(movers[j][r], size) += A[j].col(r).dot(b);
      }
    }
    // u away
    Matrix H_uu = H.block(6, 6, m, m), solved(m, 7);
    factorize(H_uu);
    for (int k = 0; k < 7; ++k) {
      std::vector<T> b;
      for (int r = 0; r < m; ++r) b.push_back(H(6 + r, k < 6 ? k : size));
      solve(H_uu, b);
      for (int r = 0; r < m; ++r) solved(r, k) = b[r];
    }
    Matrix value(6, 7);
    value << H.block(0, 0, 6, 6), H.block(0, size, 6, 1);
    if (m > 0) value -= H.block(0, 6, 6, m) * solved;
    out.block(6 * i, 0, 6, 7) = value;
  }
  return out;
}

/// The same as the sweep of forwardDynamics() left it in ws.
template <typename T>
recursive::MatrixX<T> sweptGauss(const recursive::Model<T>& model,
                                 const recursive::Workspace<T>& ws) {
  recursive::MatrixX<T> out(6 * static_cast<Eigen::Index>(model.links.size()), 7);
  for (std::size_t i = 0; i < model.links.size(); ++i)
    out.block(6 * static_cast<Eigen::Index>(i), 0, 6, 7) << ws.M_A[i].matrix(), ws.f[i].vector();
  return out;
}

struct ValueOfGauss : Law {
  static constexpr LawWords kWords = {
      "value function of Gauss' principle",
      "a' M_A a / 2 + a' f_A = least Gauss function of the subtree, all its joints at once", "M_A",
      "articulated_body", "dense minimum"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    recursive::Workspace<T>& swept = at.sweptFree();
    return {sweptGauss(at.letGo(), swept),
            leastGauss(at.letGo(), at.state().x, at.letGo(at.state().qd), at.letGo(at.state().qdd),
                       swept)};
  }
};

}  // namespace dynwitness::crosscheck
