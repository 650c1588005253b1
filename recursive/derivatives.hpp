// SPDX-License-Identifier: Apache-2.0
// First derivatives of inverse and forward dynamics, by sweeps of their own.
#pragma once

#include <vector>

#include "recursive/factorization.hpp"
#include "recursive/joint_forces.hpp"
#include "recursive/tree_factorization.hpp"

namespace dynwitness::recursive {

/// Of inverse dynamics, n x n each, row i of tau_i: d tau/dq [N m/rad], d tau/dqd [N m s/rad] and
/// d tau/dqdd = M [kg m^2]; metres for radians and N for N m where joints slide.
template <typename T>
struct InverseDynamicsDerivatives {
  explicit InverseDynamicsDerivatives(const Model<T>& model)
      : dtau_dq(model.dof(), model.dof()), dtau_dqd(dtau_dq), M(model.dof(), model.dof()) {}
  RowsX<T> dtau_dq, dtau_dqd;
  MatrixX<T> M;
};

/// Of forward dynamics, n x n each, row i of qdd_i: d qdd/dq [1/s^2], d qdd/dqd [1/s] and
/// d qdd/dtau = 1/M [1/(kg m^2)].
template <typename T>
struct ForwardDynamicsDerivatives {
  explicit ForwardDynamicsDerivatives(const Model<T>& model)
      : dqdd_dq(model.dof(), model.dof()), dqdd_dqd(dqdd_dq), dqdd_dtau(dqdd_dq) {}
  RowsX<T> dqdd_dq, dqdd_dqd, dqdd_dtau;
};

/// What the sweeps of derivatives write on: sized once for a model, then reused without allocation.
template <typename T>
struct DerivativesWorkspace {
  /// How an axis moves what is outboard of it.
  struct Axis {
    Motion<T> Z;    ///< itself
    Motion<T> psi;  ///< d v/dq
    Motion<T> chi;  ///< d a/dq, and
    Motion<T> phi;  ///< d a/dqd, both but for the term -v x that 2 B has
  };
  /// How the loads in world axes of a link and all outboard change as it turns.
  struct Turned {
    Vector3<T> force;  ///< their sum
    Matrix3<T> K;
  };

  explicit DerivativesWorkspace(const Model<T>& model)
      : ws(model),
        h(ws.f),
        M_rate(ws.I_C),
        turned(model.world_loads.empty() ? 0 : model.links.size(),
               Turned{Vector3<T>::Constant(T(0)), Matrix3<T>::Constant(T(0))}) {
    for (const LinkModel<T>& link : model.links) {
      first.push_back(static_cast<int>(axes.size()));
      for (int k = 0; k < axisCount(link.kind); ++k) {
        axes.push_back(
            {Motion<T>::zero(), Motion<T>::zero(), Motion<T>::zero(), Motion<T>::zero()});
        AnyJoints::addMotion(link, k, T(1), axes.back().Z);
      }
    }
    if (!model.coupled) inboard = inboardRates(model);
  }

  Workspace<T> ws;
  std::vector<Axis> axes;               ///< of all joints
  std::vector<int> first;               ///< of a link's axes in these
  std::vector<Force<T>> h;              ///< momentum, rotors included; composite
  std::vector<RigidInertia<T>> M_rate;  ///< dM/dt; composite
  std::vector<Turned> turned;           ///< composite; empty: there are no such loads
  std::vector<int> inboard;             ///< inboardRates()
};

namespace detail {

/// dM/dt = v x* M - M v x of a body that moves with v, as a frame at rest sees it: an inertia
/// without mass, the first moment of which is the body's linear momentum.
template <typename T>
RigidInertia<T> inertiaRate(const RigidInertia<T>& M, const Motion<T>& v) {
  const Matrix3<T> w_I = skew<T>(v.angular) * M.I.matrix();
  const Matrix3<T> v_h = v.linear * M.h.transpose();
  Matrix3<T> half = w_I - v_h;  // I' = half + half' with 2 v.h on the diagonal
  const T v_dot_h = v.linear.dot(M.h);
  for (int k = 0; k < 3; ++k) half(k, k) += v_dot_h;
  return {T(0), v.linear * M.mass + v.angular.cross(M.h),
          Symmetric3<T>::fromUpper(half + half.transpose())};
}

/// 2 B y = dM/dt y + y x* h: how the force of a motion v changes with v, in the direction y, beside
/// what M makes of -v x y.
template <typename T>
Force<T> twiceCoriolis(const RigidInertia<T>& M_rate, const Force<T>& h, const Motion<T>& y) {
  const Vector3<T> force = y.angular.cross(h.force);
  return {force + force, M_rate.I * y.angular + y.angular.cross(h.moment)};
}
/// The moment of (2 B)' y, which has no force.
template <typename T>
Vector3<T> twiceCoriolisTransposed(const RigidInertia<T>& M_rate, const Force<T>& h,
                                   const Motion<T>& y) {
  const Vector3<T> moment = h.force.cross(y.linear);
  return moment + moment + M_rate.I * y.angular + h.moment.cross(y.angular);
}

/// How the loads in world axes change what each link alone needs, into room.turned; after
/// subtractLoads(), which sets ws.R_W.
template <typename T>
void turnedLoads(const Model<T>& model, DerivativesWorkspace<T>& room) {
  for (auto& turned : room.turned)
    turned = {Vector3<T>::Constant(T(0)), Matrix3<T>::Constant(T(0))};
  for (const WorldLoad<T>& load : model.world_loads) {
    const Matrix3<T>& R = room.ws.R_W[load.link];
    const Vector3<T> force = R * load.force, moment = R * load.moment;
    auto& turned = room.turned[load.link];
    turned.force += force;
    turned.K -= skew<T>(moment) + skew<T>(load.at) * skew<T>(force);
  }
}

/// What a geared rotor adds to rows and columns of its joint's rates. Its carrier's motion is in
/// room.ws, and how axes move it.
template <typename T>
void addRotorDerivatives(const Model<T>& model, const DerivativesWorkspace<T>& room,
                         const GearedRotor<T>& rotor, InverseDynamicsDerivatives<T>& out) {
  const auto rates = static_cast<int>(rotor.ratio.size());
  for (int k = 0; k < rates; ++k)
    for (int l = 0; l < rates; ++l)
      out.M(rotor.dof + k, rotor.dof + l) += rotor.ratio[k] * rotor.ratio[l] * rotor.inertia;
  if (rotor.carrier < 0) return;
  Force<T> F = spinAxis(rotor), F_qd = Force<T>::zero();
  F_qd.moment = room.ws.v[rotor.carrier].angular.cross(F.moment);
  for (int j = rotor.carrier; j >= 0; j = model.links[j].parent) {
    const LinkModel<T>& inboard = model.links[j];
    for (int l = 0, e = inboard.dof; l < AnyJoints::axes(inboard); ++l, ++e) {
      const auto& by = room.axes[room.first[j] + l];
      const T on_M = AnyJoints::force(inboard, l, F), on_qd = AnyJoints::force(inboard, l, F_qd),
              row_q = dot(by.chi, F) + by.psi.angular.dot(F_qd.moment),
              row_qd = dot(by.phi, F) + by.Z.angular.dot(F_qd.moment);
      for (int k = 0, d = rotor.dof; k < rates; ++k, ++d) {
        const T& n = rotor.ratio[k];
        out.M(d, e) += n * on_M;
        out.M(e, d) += n * on_M;
        out.dtau_dqd(e, d) += n * on_qd;
        out.dtau_dq(d, e) += n * row_q;
        out.dtau_dqd(d, e) += n * row_qd;
      }
    }
    F = room.ws.X_up[j].inverseTimes(F);
    F_qd = room.ws.X_up[j].inverseTimes(F_qd);
  }
}

}  // namespace detail

/** Derivatives of inverse dynamics at a state, O(n depth), all from one sweep out and one in.

    Along q, the axis Z of a joint moves all that is outboard of it, for a unit of time and at unit
    rate: q (+) eps e_k, positions by positionRates(). So where rates are no derivatives of
    coordinates (spherical and floating joints), derivatives by q are along the body's own axes.
    Everything below is in the coordinates of the link that it belongs to, which move with it: a
    motion or force of the world that stays what it is changes by -Z x there. With v, a, f, M of
    newton_euler.hpp, p the parent of k, and X from p to k:

        (1)  v_k = X v_p + Z qd,   a_k = X a_p + Z qdd + v_k x Z qd,   f_k = M a_k + v_k x* M v_k
    what Z of joint k does to the link k and to every link i outboard of it, seen in link i:
        (2)  dv_i/dq  = psi,                        psi = (X v_p) x Z
        (3)  da_i/dq  = chi - v_i x psi,            chi = (X a_p) x Z + (X v_p) x psi
        (4)  dv_i/dqd = Z,   da_i/dqd = phi - v_i x Z,     phi = psi + v_k x Z
    (in (3) and (4) v_i x is that of link i; chi and phi are carried outward unchanged). Put into
    f, the terms with v_i x join dM/dt and the momentum h = M v:
        (5)  2 B y = M (-v x y) + y x* M v + v x* M y = dM/dt y + y x* h,   dM/dt = v x* M - M v x
        (6)  df_i/dq = M chi + 2 B psi,   df_i/dqd = M phi + 2 B Z,   df_i/dqdd = M Z
    M, dM/dt and h of all that is outboard add up, on the way inward, as if it were one rigid body:
        (7)  F = M_C Z,   F_q = M_C chi + 2 B_C psi,   F_qd = M_C phi + 2 B_C Z
    are what the wrench through joint k changes by, and joints inboard feel them; they feel too that
    the wrench f_k itself turns with Z:
        (8)  F_q of link k's own frame; beyond it, F_q + Z x* f_k
        (9)  column k, joints j inboard:   dtau_j/dq_k = Z_j' F_q,   dtau_j/dqd_k = Z_j' F_qd
       (10)  row k, the same joints:       dtau_k/dq_j = F' chi_j + G' psi_j,
                                           dtau_k/dqd_j = F' phi_j + G' Z_j,     G = (2 B_C)' Z
       (11)  M_jk = M_kj = Z_j' F
    2 B is zero where it meets a linear velocity, so that G is a moment alone. Joints on different
    branches do not feel each other.

    Rotors, springs and viscous friction: d in M_kk, k in dtau_k/dq_k, viscous in dtau_k/dqd_k; a
    sign of Coulomb friction does not change. A load in the link's axes turns with it: it is in f.
    One in world axes is turned the other way as its link turns by Z: W (0, w) = (w x F, w x n + r x
    (w x F)) of a force F at r and a moment n, in the link's axes:
       (12)  F_q also has W_C Z,   dtau_k/dq_j also Z' W_C Z_j
    A gyroscopic rotor (newton_euler.hpp, (5) and (6)) is carried by the parent, with the momentum
    h_r qd z:
       (13)  h of p also has h_r qd z
       (14)  beyond joint k, F and with it the row have h_r z, F_qd and G have w_p x h_r z

    A rotor geared to all rates of a joint (newton_euler.hpp, (7)), on link p with its axis a there:
       (15)  h of p also has J psi' a, f_p what (7) says; M also n n'J,
             column and row k of the joint's rates, from p inboard, n_k times those of (14)

    @tparam T     tested with double, running error bounds, the prime field and exact rationals
    @param  x, qd, qdd  positions, rates, accelerations, as inverseDynamics() takes them
    @param  out   of as many rates as the model, written whole
    @param  terms springs, loads, gravity and friction can be left out
    Joints that follow others (LinkModel): q, qd, qdd are the leaders', entries are sums.
    @throws std::invalid_argument  a vector is not of length n
    @see J. Carpentier and N. Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms,
      Robotics: Science and Systems (2018); S. Singh, R. Russell, P. Wensing, Efficient Analytical
      Derivatives of Rigid-Body Dynamics using Spatial Vector Algebra, IEEE RA-L 7 (2022) */
template <typename T>
void inverseDynamicsDerivatives(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                                const std::vector<T>& qd, const std::vector<T>& qdd,
                                DerivativesWorkspace<T>& room, InverseDynamicsDerivatives<T>& out,
                                Terms terms = Terms::all()) {
  requirePositions(model, "inverseDynamicsDerivatives", x.size());
  requireSize(model, "inverseDynamicsDerivatives", "qd", qd.size());
  requireSize(model, "inverseDynamicsDerivatives", "qdd", qdd.size());
  requireSize(model, "inverseDynamicsDerivatives", "rows of out", out.M.rows());
  Workspace<T>& ws = room.ws;
  const int n = static_cast<int>(model.links.size());
  const bool has_world_loads = terms.loads && !room.turned.empty();
  const Motion<T> v_0 = Motion<T>::zero();
  Motion<T> a_0 = Motion<T>::zero();
  if (terms.gravity) a_0.linear = -model.gravity;

  withJoints(model, [&](auto joints) {
    using Joints = decltype(joints);
    // outward: how links and axes move, and what each link alone needs
    for (int i = 0; i < n; ++i) {
      const LinkModel<T>& link = model.links[i];
      const int p = link.parent;
      ws.X_up[i] = Joints::transform(link, x);
      const Motion<T> v_p = ws.X_up[i] * (p < 0 ? v_0 : ws.v[p]);
      const Motion<T> a_p = ws.X_up[i] * (p < 0 ? a_0 : ws.a[p]);
      const Motion<T> v_J = Joints::motion(link, qd);
      ws.v[i] = v_p + v_J;
      ws.a[i] = a_p + Joints::motion(link, qdd) + cross(ws.v[i], v_J);
      room.h[i] = link.M * ws.v[i];
      ws.f[i] = link.M * ws.a[i] + cross(ws.v[i], room.h[i]);  // (1)
      for (int k = 0; k < Joints::axes(link); ++k) {
        auto& axis = room.axes[room.first[i] + k];
        axis.psi = cross(v_p, axis.Z);                         // (2)
        axis.chi = cross(a_p, axis.Z) + cross(v_p, axis.psi);  // (3)
        axis.phi = axis.psi + cross(ws.v[i], axis.Z);          // (4)
      }
      ws.I_C[i] = link.M;
      room.M_rate[i] = detail::inertiaRate(link.M, ws.v[i]);  // (5)
    }
    if (terms.loads) subtractLoads(model, ws, ws.f);
    if (has_world_loads) detail::turnedLoads(model, room);

    out.dtau_dq.setConstant(T(0));  // joints on different branches do not feel each other
    out.dtau_dqd.setConstant(T(0));
    out.M.setConstant(T(0));
    const auto put = [&](auto& matrix, int row, int column, const T& entry) {
      if (Joints::kMayFollow && model.coupled)
        matrix(row, column) += entry;
      else
        matrix(row, column) = entry;
    };

    for (const GearedRotor<T>& rotor : model.rotors) {  // (15)
      const int p = rotor.carrier;
      if (p < 0) continue;
      const T rate = rotorRate(rotor, qd);
      ws.f[p] = ws.f[p] + spinForce(rotor, rate, rotorRate(rotor, qdd), ws.v[p]);
      room.h[p] = room.h[p] + spinAxis(rotor) * rate;
    }

    // inward: what a joint's own motion changes, for itself and for all joints inboard
    for (int i = n - 1; i >= 0; --i) {
      const LinkModel<T>& link = model.links[i];
      const bool spins = spinsOnALink(model, link);
      const Motion<T> v_p = link.parent < 0 ? v_0 : ws.X_up[i] * ws.v[link.parent];
      for (int k = 0, d = link.dof; k < Joints::axes(link); ++k, ++d) {
        const auto& axis = room.axes[room.first[i] + k];
        const auto twiceB = [&](const Motion<T>& y) {
          return detail::twiceCoriolis(room.M_rate[i], room.h[i], y);
        };
        Force<T> F = Joints::column(link, k, ws.I_C[i]);
        Force<T> F_q = ws.I_C[i] * axis.chi + twiceB(axis.psi);
        Force<T> F_qd = ws.I_C[i] * axis.phi + twiceB(axis.Z);  // (7)
        Vector3<T> G = detail::twiceCoriolisTransposed(room.M_rate[i], room.h[i], axis.Z);
        Vector3<T> W = Vector3<T>::Constant(T(0));  // of a row
        if (has_world_loads) {
          const auto& turned = room.turned[i];
          F_q = F_q + Force<T>{axis.Z.angular.cross(turned.force), turned.K * axis.Z.angular};
          W = turned.force.cross(axis.Z.linear) + turned.K.transpose() * axis.Z.angular;  // (12)
        }
        for (int l = 0, e = link.dof; l < Joints::axes(link); ++l, ++e) {  // (9), (11) of itself
          put(out.dtau_dq, e, d, Joints::force(link, l, F_q));
          put(out.dtau_dqd, e, d, Joints::force(link, l, F_qd));
          put(out.M, e, d, Joints::force(link, l, F));
        }
        out.M(d, d) += link.rotor;
        if (k == 0 && terms.springs) out.dtau_dq(d, d) += link.stiffness;
        if (k == 0 && model.friction && terms.friction) out.dtau_dqd(d, d) += link.viscous;

        F_q = F_q + cross(axis.Z, ws.f[i]);  // (8)
        if (spins) {
          const Force<T> spin = spinAxis(link);
          const Vector3<T> carried = v_p.angular.cross(spin.moment);
          F = F + spin;
          F_qd.moment += carried;
          G += carried;  // (14)
        }
        for (int b = i, j = link.parent; j >= 0; b = j, j = model.links[j].parent) {
          const Transform<T>& X = ws.X_up[b];
          F = X.inverseTimes(F);
          F_q = X.inverseTimes(F_q);
          F_qd = X.inverseTimes(F_qd);
          G = X.R.transpose() * G;
          if (has_world_loads) W = X.R.transpose() * W;
          const LinkModel<T>& inboard = model.links[j];
          for (int l = 0, e = inboard.dof; l < Joints::axes(inboard); ++l, ++e) {
            const auto& by = room.axes[room.first[j] + l];
            put(out.dtau_dq, e, d, Joints::force(inboard, l, F_q));
            put(out.dtau_dqd, e, d, Joints::force(inboard, l, F_qd));  // (9)
            T row = dot(by.chi, F) + by.psi.angular.dot(G);            // (10)
            if (has_world_loads) row += by.Z.angular.dot(W);
            put(out.dtau_dq, d, e, row);
            put(out.dtau_dqd, d, e, dot(by.phi, F) + by.Z.angular.dot(G));
            const T entry = Joints::force(inboard, l, F);  // (11)
            put(out.M, d, e, entry);
            put(out.M, e, d, entry);
          }
        }
      }
      const int p = link.parent;
      if (p < 0) continue;
      const Transform<T>& X = ws.X_up[i];
      Force<T> f = ws.f[i], h = room.h[i];
      if (spins) {
        f = f + spinForce(link, qd[link.dof], qdd[link.dof], v_p);
        h = h + spinAxis(link) * qd[link.dof];  // (13)
      }
      ws.f[p] = ws.f[p] + X.inverseTimes(f);
      room.h[p] = room.h[p] + X.inverseTimes(h);
      ws.I_C[p] = ws.I_C[p] + X.inverseTimes(ws.I_C[i]);
      room.M_rate[p] = room.M_rate[p] + X.inverseTimes(room.M_rate[i]);
      if (has_world_loads) {
        auto& turned = room.turned[p];
        const Vector3<T> force = X.R.transpose() * room.turned[i].force;
        turned.force += force;
        turned.K += X.R.transpose() * room.turned[i].K * X.R - skew<T>(X.p) * skew<T>(force);
      }
    }
  });
  for (const GearedRotor<T>& rotor : model.rotors)
    detail::addRotorDerivatives(model, room, rotor, out);
}

/** From the derivatives of inverse dynamics those of forward dynamics at the same state:

        d qdd/dq = -1/M d tau/dq,   d qdd/dqd = -1/M d tau/dqd,   d qdd/dtau = 1/M

    by M = L' D L with the tree's own zeros; where joints follow others, whose rows know several
    branches, by M = L D L'. O(n^2 depth), or n^3.
    @param of_tau  in: inverseDynamicsDerivatives(); out: its M replaced by L and D
    A singular M divides by zero, as in forwardDynamics(). */
template <typename T>
void solveForAccelerations(const Model<T>& model, const DerivativesWorkspace<T>& room,
                           InverseDynamicsDerivatives<T>& of_tau,
                           ForwardDynamicsDerivatives<T>& out) {
  requireSize(model, "solveForAccelerations", "rows of of_tau", of_tau.M.rows());
  requireSize(model, "solveForAccelerations", "rows of out", out.dqdd_dq.rows());
  out.dqdd_dq = -of_tau.dtau_dq;
  out.dqdd_dqd = -of_tau.dtau_dqd;
  out.dqdd_dtau.setConstant(T(0));
  for (int i = 0; i < model.dof(); ++i) out.dqdd_dtau(i, i) = T(1);
  RowsX<T>* const all[] = {&out.dqdd_dq, &out.dqdd_dqd, &out.dqdd_dtau};
  if (!model.coupled) {
    factorizeTree(room.inboard, of_tau.M);
    for (RowsX<T>* const B : all) solveTree(room.inboard, of_tau.M, *B);
    return;
  }
  factorize(of_tau.M);
  for (RowsX<T>* const B : all)
    for (Eigen::Index j = 0; j < B->cols(); ++j) {
      auto column = B->col(j);
      solve(of_tau.M, column);
    }
}

/** Derivatives of forward dynamics at a state: those of inverse dynamics at its qdd, and
    solveForAccelerations().

    @param qdd    what the state's tau makes, by forwardDynamics(): tau has no other part in it
    @param of_tau  out: the derivatives of inverse dynamics there; L and D in place of M
    @throws std::invalid_argument  a vector is not of length n */
template <typename T>
void forwardDynamicsDerivatives(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                                const std::vector<T>& qd, const std::vector<T>& qdd,
                                DerivativesWorkspace<T>& room,
                                InverseDynamicsDerivatives<T>& of_tau,
                                ForwardDynamicsDerivatives<T>& out, Terms terms = Terms::all()) {
  inverseDynamicsDerivatives(model, x, qd, qdd, room, of_tau, terms);
  solveForAccelerations(model, room, of_tau, out);
}

}  // namespace dynwitness::recursive
