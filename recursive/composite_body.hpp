// SPDX-License-Identifier: Apache-2.0
// The joint-space mass matrix by composite bodies, and the Coriolis matrix by the same sweep.
#pragma once

#include <vector>

#include "recursive/joint_forces.hpp"
#include "scene/matrix.hpp"

namespace dynwitness::recursive {

using scene::MatrixX;

namespace detail {

/// What a geared rotor adds to M; ws.X_up is set.
template <typename T>
void addRotorInertia(const Model<T>& model, const Workspace<T>& ws, const GearedRotor<T>& rotor,
                     MatrixX<T>& M) {
  const auto rates = static_cast<int>(rotor.ratio.size());
  for (int k = 0; k < rates; ++k)
    for (int l = 0; l < rates; ++l)
      M(rotor.dof + k, rotor.dof + l) += rotor.ratio[k] * rotor.ratio[l] * rotor.inertia;
  Force<T> F = spinAxis(rotor);
  for (int j = rotor.carrier; j >= 0; F = ws.X_up[j].inverseTimes(F), j = model.links[j].parent) {
    const LinkModel<T>& inboard = model.links[j];
    for (int l = 0, e = inboard.dof; l < AnyJoints::axes(inboard); ++l, ++e) {
      const T felt = AnyJoints::force(inboard, l, F);
      for (int k = 0; k < rates; ++k) {
        M(rotor.dof + k, e) += rotor.ratio[k] * felt;
        M(e, rotor.dof + k) += rotor.ratio[k] * felt;
      }
    }
  }
}

}  // namespace detail

/** Joint-space mass matrix M(q), n x n [kg m^2, kg m, kg], by composite bodies, in O(n depth).

        (1)  I_C of p  +=  X' I_C X              everything outboard of a joint as one rigid body
        (2)  F = I_C Z,  M_ii = Z' F + d         the force that moves it when joint i alone moves
        (3)  M_ij = Z_j' F  for the joints j inboard of i, F carried inward
    A gyroscopic rotor, spun up by the joint, needs the moment h z of its parent: F has it from
    there on. A rotor geared to all rates of a joint adds J n_k n_l to M_kl, and n_k Z_j' (0, J a),
    a in the axes of the link that carries it, to M_kj of the joints j inboard of that link and its
    own.

    M must be n x n on entry and is written whole.
    @throws std::invalid_argument  x or M has another size
    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), table 6.2, p. 107 */
template <typename T>
void massMatrix(const Model<T>& model, const std::vector<JointPosition<T>>& x, Workspace<T>& ws,
                MatrixX<T>& M) {
  requirePositions(model, "massMatrix", x.size());
  requireSize(model, "massMatrix", "rows of M", M.rows());
  requireSize(model, "massMatrix", "columns of M", M.cols());
  const int n = static_cast<int>(model.links.size());
  withJoints(model, [&](auto joints) {
    using Joints = decltype(joints);
    for (int i = 0; i < n; ++i) {
      ws.X_up[i] = Joints::transform(model.links[i], x);
      ws.I_C[i] = model.links[i].M;
    }
    M.setConstant(T(0));  // joints on different branches do not feel each other
    const auto put = [&](int row, int column, const T& entry) {
      if (Joints::kMayFollow && model.coupled)
        M(row, column) += entry;
      else
        M(row, column) = entry;
    };
    for (int i = n - 1; i >= 0; --i) {
      const LinkModel<T>& link = model.links[i];
      if (link.parent >= 0)
        ws.I_C[link.parent] = ws.I_C[link.parent] + ws.X_up[i].inverseTimes(ws.I_C[i]);  // (1)
      for (int k = 0, d = link.dof; k < Joints::axes(link); ++k, ++d) {
        Force<T> F = Joints::column(link, k, ws.I_C[i]);
        put(d, d, Joints::force(link, k, F) + link.rotor);  // (2)
        for (int l = 0, e = link.dof; l < k; ++l, ++e)
          M(d, e) = M(e, d) = Joints::force(link, l, F);
        if (model.gyroscopic) F = F + spinAxis(link);
        for (int b = i, j = link.parent; j >= 0; b = j, j = model.links[j].parent) {
          F = ws.X_up[b].inverseTimes(F);
          const LinkModel<T>& inboard = model.links[j];
          for (int l = 0, e = inboard.dof; l < Joints::axes(inboard); ++l, ++e) {
            const T entry = Joints::force(inboard, l, F);  // (3)
            put(d, e, entry);
            put(e, d, entry);
          }
        }
      }
    }
  });
  for (const GearedRotor<T>& rotor : model.rotors) detail::addRotorInertia(model, ws, rotor, M);
}

namespace detail {

/// The body-level Coriolis matrix of a rigid body: B v = v x* (M v), and dM/dt - 2 B is skew when M
/// is seen from a frame that does not move.  B = ( [v x*] M - M [v x] + [M v]x~ ) / 2, where
/// [f]x~ y = y x* f.
template <typename T>
Matrix6<T> bodyCoriolis(const RigidInertia<T>& M, const Motion<T>& v) {
  const Matrix6<T> M6 = ArticulatedInertia<T>::fromRigid(M).matrix();
  const Force<T> f = M * v;
  Matrix6<T> v_cross, f_cross;
  v_cross << skew(v.angular), skew(v.linear), Matrix3<T>::Zero(), skew(v.angular);
  f_cross << Matrix3<T>::Zero(), -skew(f.force), -skew(f.force), -skew(f.moment);
  // the force cross product is the negative transpose of the motion cross product
  const Matrix6<T> twice = f_cross - v_cross.transpose() * M6 - M6 * v_cross;
  return twice * (T(1) / T(2));
}

/// (3) of coriolisMatrix(); ws.X_up and ws.v are set.
template <typename T>
void addSpinCoriolis(const Model<T>& model, const std::vector<T>& qd, const Workspace<T>& ws,
                     MatrixX<T>& C) {
  const Vector3<T> z(T(0), T(0), T(1));
  for (std::size_t b = 0; b < model.links.size(); ++b) {
    const LinkModel<T>& link = model.links[b];
    if (link.dof < 0 || link.parent < 0 || axisCount(link.kind) != 1) continue;
    const Vector3<T> w_p = ws.X_up[b].R * ws.v[link.parent].angular;
    struct Inboard {
      int rate;
      Vector3<T> J;
      T a_rate;
    };
    std::vector<Inboard> inboard;  // in the axes of this joint
    Matrix3<T> R = ws.X_up[b].R;
    for (int j = link.parent; j >= 0; j = model.links[j].parent) {
      for (int k = 0; k < axisCount(model.links[j].kind); ++k) {
        const Vector3<T> J = R * jointAxis(model.links[j], k).template tail<3>();
        // J turns with link j, z with the parent
        const Vector3<T> w_j = R * ws.v[j].angular;
        inboard.push_back({model.links[j].dof + k, J, w_p.cross(z).dot(J) + z.dot(w_j.cross(J))});
      }
      R = R * ws.X_up[j].R;
    }
    const int i = link.dof;
    const T half = link.spin / T(2);
    for (const Inboard& x : inboard) {
      const T K_qd = z.dot(x.J.cross(w_p));
      C(i, x.rate) += link.spin * x.a_rate - half * K_qd;
      C(x.rate, i) += half * K_qd;
      for (const Inboard& y : inboard) C(x.rate, y.rate) += half * qd[i] * z.dot(x.J.cross(y.J));
    }
  }
}

/// (3) of a geared rotor, its rate n'nu in the place of h qd_i.
template <typename T>
void addRotorCoriolis(const Model<T>& model, const std::vector<T>& qd, const Workspace<T>& ws,
                      const GearedRotor<T>& rotor, MatrixX<T>& C) {
  if (rotor.carrier < 0) return;
  const Vector3<T>& a = rotor.axis;
  const Vector3<T> w_p = ws.v[rotor.carrier].angular;
  struct Inboard {
    int rate;
    Vector3<T> J;
    T a_rate;
  };
  std::vector<Inboard> inboard;  // in the axes of the carrier
  Matrix3<T> R = Matrix3<T>::Identity();
  for (int j = rotor.carrier; j >= 0; R = R * ws.X_up[j].R, j = model.links[j].parent)
    for (int k = 0; k < axisCount(model.links[j].kind); ++k) {
      const Vector3<T> J = R * jointAxis(model.links[j], k).template tail<3>();
      const Vector3<T> w_j = R * ws.v[j].angular;  // J turns with link j, a with the carrier
      inboard.push_back({model.links[j].dof + k, J, w_p.cross(a).dot(J) + a.dot(w_j.cross(J))});
    }
  const T half = rotor.inertia / T(2), half_spin = half * rotorRate(rotor, qd);
  for (const Inboard& x : inboard) {
    const T K_qd = a.dot(x.J.cross(w_p));
    for (std::size_t k = 0; k < rotor.ratio.size(); ++k) {
      const int i = rotor.dof + static_cast<int>(k);
      C(i, x.rate) += rotor.ratio[k] * (rotor.inertia * x.a_rate - half * K_qd);
      C(x.rate, i) += rotor.ratio[k] * half * K_qd;
    }
    for (const Inboard& y : inboard) C(x.rate, y.rate) += half_spin * a.dot(x.J.cross(y.J));
  }
}

}  // namespace detail

/** Coriolis matrix C(q, qd), n x n, with c = C qd and dM/dt - 2 C skew-symmetric: the matrix that
    the Christoffel symbols give (where qd are derivatives of q), by composite bodies. With B the
    body-level Coriolis matrix of each link, composed outboard like the inertia, and dZ = v x Z:
        (1)  F_1 = I_C dZ_j + B_C Z_j,   F_2 = I_C Z_j,   F_3 = B_C' Z_j
        (2)  C_ij = Z_i' F_1,   C_ji = dZ_i' F_2 + Z_i' F_3      for i inboard of j (or j itself)
    A gyroscopic rotor of joint i, h qd_i z.w_p in T, with a_j = z.J_j its coupling to the rates
    inboard, J_j what rate j gives to w_p, and K_jk = z.(J_j x J_k) the rate at which a_j changes
    with k less that at which a_k changes with j:
        (3)  C += h e_i (da/dt)' + h/2 (K qd_i - e_i (K qd)' + (K qd) e_i')
    and of one geared to several rates the same with n'nu for qd_i and n for e_i.
    Dense 6 x 6 products, O(n depth): for checks, not for speed.
    @see S. Echeandia and P. Wensing, Numerical Methods to Compute the Coriolis Matrix and
      Christoffel
         Symbols for Rigid-Body Systems, J. Comput. Nonlinear Dynam. 16 (2021) */
template <typename T>
MatrixX<T> coriolisMatrix(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                          const std::vector<T>& qd, Workspace<T>& ws) {
  requirePositions(model, "coriolisMatrix", x.size());
  requireSize(model, "coriolisMatrix", "qd", qd.size());
  const int n = static_cast<int>(model.links.size());
  std::vector<Vector6<T>> Z, dZ;
  std::vector<int> first;  // of a link's axes in these
  std::vector<Matrix6<T>> I_C(n), B_C(n), X_up(n);
  for (int i = 0; i < n; ++i) {
    const LinkModel<T>& link = model.links[i];
    ws.X_up[i] = AnyJoints::transform(link, x);
    const Motion<T> v_J = AnyJoints::motion(link, qd);
    ws.v[i] = link.parent < 0 ? v_J : ws.X_up[i] * ws.v[link.parent] + v_J;
    X_up[i] = ws.X_up[i].motionMatrix();
    first.push_back(static_cast<int>(Z.size()));
    for (int k = 0; k < AnyJoints::axes(link); ++k) {
      Z.push_back(jointAxis(link, k));
      const Vector6<T>& z = Z.back();
      dZ.push_back(cross(ws.v[i], Motion<T>{z.template head<3>(), z.template tail<3>()}).vector());
    }
    I_C[i] = ArticulatedInertia<T>::fromRigid(link.M).matrix();
    B_C[i] = detail::bodyCoriolis(link.M, ws.v[i]);
  }
  MatrixX<T> C = MatrixX<T>::Constant(model.dof(), model.dof(), T(0));
  for (int b = n - 1; b >= 0; --b) {
    const LinkModel<T>& link = model.links[b];
    for (int k = 0, j = link.dof; k < AnyJoints::axes(link); ++k, ++j) {
      const Vector6<T>&z = Z[first[b] + k], &dz = dZ[first[b] + k];
      Vector6<T> F_1 = I_C[b] * dz + B_C[b] * z;
      Vector6<T> F_2 = I_C[b] * z;
      Vector6<T> F_3 = B_C[b].transpose() * z;  // (1)
      for (int l = 0; l < AnyJoints::axes(link); ++l)
        C(link.dof + l, j) += Z[first[b] + l].dot(F_1);
      for (int a = b, p = link.parent; p >= 0; a = p, p = model.links[p].parent) {
        F_1 = X_up[a].transpose() * F_1;
        F_2 = X_up[a].transpose() * F_2;
        F_3 = X_up[a].transpose() * F_3;
        const LinkModel<T>& inboard = model.links[p];
        for (int l = 0, i = inboard.dof; l < AnyJoints::axes(inboard); ++l, ++i) {
          const int at = first[p] + l;
          C(i, j) += Z[at].dot(F_1);
          C(j, i) += dZ[at].dot(F_2) + Z[at].dot(F_3);  // (2)
        }
      }
    }
    if (link.parent >= 0) {
      I_C[link.parent] += X_up[b].transpose() * I_C[b] * X_up[b];
      B_C[link.parent] += X_up[b].transpose() * B_C[b] * X_up[b];
    }
  }
  if (model.gyroscopic) detail::addSpinCoriolis(model, qd, ws, C);
  for (const GearedRotor<T>& rotor : model.rotors)
    detail::addRotorCoriolis(model, qd, ws, rotor, C);
  return C;
}

}  // namespace dynwitness::recursive
