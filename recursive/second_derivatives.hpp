// SPDX-License-Identifier: Apache-2.0
// Second derivatives of inverse and forward dynamics, by a third sweep after those of the first.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "recursive/derivatives.hpp"

namespace dynwitness::recursive {

/// n x n x n numbers, of which (i, j, k + 1) follows (i, j, k).
template <typename T>
class Cube {
 public:
  explicit Cube(int n) : n_(static_cast<std::size_t>(n)), at_(n_ * n_ * n_, T(0)) {}
  int n() const { return static_cast<int>(n_); }
  T& operator()(int i, int j, int k) { return at_[index(i, j, k)]; }
  const T& operator()(int i, int j, int k) const { return at_[index(i, j, k)]; }
  void clear() { std::fill(at_.begin(), at_.end(), T(0)); }

  using Slab = Eigen::Map<RowsX<T>, 0, Eigen::OuterStride<>>;
  using ConstSlab = Eigen::Map<const RowsX<T>, 0, Eigen::OuterStride<>>;
  /// The matrix of all (i, k) at this j.
  Slab slab(int j) {
    return {at_.data() + index(0, j, 0), n(), n(), Eigen::OuterStride<>(n() * n())};
  }
  ConstSlab slab(int j) const {
    return {at_.data() + index(0, j, 0), n(), n(), Eigen::OuterStride<>(n() * n())};
  }

 private:
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * n_ + static_cast<std::size_t>(j)) * n_ +
           static_cast<std::size_t>(k);
  }
  std::size_t n_;
  std::vector<T> at_;
};

/** Of inverse dynamics, n x n x n each. D_j is the derivative along q_j, as of the first ones:

        d2tau_dq_dq(i, j, k)      D_j (D_k tau_i)    [N m/rad^2]
        d2tau_dq_dqd(i, j, k)     D_j (d tau_i/dqd_k)  [N m s/rad^2]
        d2tau_dqd_dqd(i, j, k)    d^2 tau_i/(dqd_j dqd_k)  [N m s^2/rad^2]
        d2tau_dq_dqdd(i, j, k)    D_j M_ik  [kg m^2/rad]

    metres for radians and N for N m where joints slide. All others are zero. D_j D_k = D_k D_j but
    among the axes of one spherical or floating joint, whose turns do not commute. */
template <typename T>
struct InverseDynamicsSecondDerivatives {
  explicit InverseDynamicsSecondDerivatives(const Model<T>& model)
      : d2tau_dq_dq(model.dof()),
        d2tau_dq_dqd(d2tau_dq_dq),
        d2tau_dqd_dqd(d2tau_dq_dq),
        d2tau_dq_dqdd(d2tau_dq_dq) {}
  Cube<T> d2tau_dq_dq, d2tau_dq_dqd, d2tau_dqd_dqd, d2tau_dq_dqdd;
  std::array<Cube<T>*, 4> all() {
    return {&d2tau_dq_dq, &d2tau_dq_dqd, &d2tau_dqd_dqd, &d2tau_dq_dqdd};
  }
};

/** Of forward dynamics, n x n x n each, row i of qdd_i, with the same D_j:

        d2qdd_dq_dq    as that of tau  [1/(rad s^2)]
        d2qdd_dq_dqd                   [1/(rad s)]
        d2qdd_dqd_dqd                  [1/rad]
        d2qdd_dq_dtau(i, j, k)  D_j (1/M)_ik  [1/(kg m^2 rad)]

    All others are zero. */
template <typename T>
struct ForwardDynamicsSecondDerivatives {
  explicit ForwardDynamicsSecondDerivatives(const Model<T>& model)
      : d2qdd_dq_dq(model.dof()),
        d2qdd_dq_dqd(d2qdd_dq_dq),
        d2qdd_dqd_dqd(d2qdd_dq_dq),
        d2qdd_dq_dtau(d2qdd_dq_dq) {}
  Cube<T> d2qdd_dq_dq, d2qdd_dq_dqd, d2qdd_dqd_dqd, d2qdd_dq_dtau;
  std::array<Cube<T>*, 4> all() {
    return {&d2qdd_dq_dq, &d2qdd_dq_dqd, &d2qdd_dqd_dqd, &d2qdd_dq_dtau};
  }
};

/// What the sweep writes on: sized once for a model.
template <typename T>
struct SecondDerivativesWorkspace {
  /// An axis inboard of the link in hand or its own, in that link's coordinates.
  struct PathAxis {
    int link, dof;
    Motion<T> Z, psi, chi, phi;  ///< as in DerivativesWorkspace
  };
  /// Of loads that keep world axes, on a link and all outboard, their forces F at r and moments n,
  /// in that link's coordinates.
  struct Loads {
    Vector3<T> moment;  ///< sum of n
    Matrix3<T> F_r;     ///< sum of F r'
  };

  explicit SecondDerivativesWorkspace(const Model<T>& model)
      : first(model),
        of_tau(model),
        of_qdd(model),
        product(model.dof(), model.dof()),
        loads(first.turned.size(), Loads{Vector3<T>::Constant(T(0)), Matrix3<T>::Constant(T(0))}) {
    path.reserve(first.axes.size());
  }

  DerivativesWorkspace<T> first;
  InverseDynamicsDerivatives<T> of_tau;  ///< the first derivatives, which come along
  ForwardDynamicsDerivatives<T> of_qdd;
  RowsX<T> product;
  std::vector<Loads> loads;  ///< composite; empty: there are none
  std::vector<PathAxis> path;
};

namespace detail {

/// What the wrench of such loads changes by, as their link sees it, when it turns by w: (12) of
/// derivatives.hpp. And what that changes by when the link turns by u before.
template <typename T>
struct TurningLoads {
  Vector3<T> force;
  typename SecondDerivativesWorkspace<T>::Loads sums;

  Force<T> turned(const Vector3<T>& w) const {
    // w x n + r x (w x F) = w x n + (tr(F r') - F r') w
    return {w.cross(force), w.cross(sums.moment) + w * sums.F_r.trace() - sums.F_r * w};
  }
  Force<T> turnedTwice(const Vector3<T>& u, const Vector3<T>& w) const {
    const TurningLoads before{-u.cross(force), {-u.cross(sums.moment), -(skew<T>(u) * sums.F_r)}};
    return before.turned(w);
  }
};

/// Sums of loads in world axes, after subtractLoads().
template <typename T>
void sumWorldLoads(const Model<T>& model, SecondDerivativesWorkspace<T>& room) {
  const Workspace<T>& ws = room.first.ws;
  for (auto& of : room.loads) of = {Vector3<T>::Constant(T(0)), Matrix3<T>::Constant(T(0))};
  for (const WorldLoad<T>& load : model.world_loads) {
    auto& of = room.loads[load.link];
    of.moment += ws.R_W[load.link] * load.moment;
    of.F_r += (ws.R_W[load.link] * load.force) * load.at.transpose();
  }
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
    const int p = model.links[i].parent;
    if (p < 0) continue;
    const Transform<T>& X = ws.X_up[i];
    room.loads[p].moment += X.R.transpose() * room.loads[i].moment;
    room.loads[p].F_r += X.R.transpose() * room.loads[i].F_r * X.R +
                         Vector3<T>(X.R.transpose() * room.first.turned[i].force) * X.p.transpose();
  }
}

/// The axes of link i's joint, then those inboard, as link i sees them.
template <typename T>
void gatherPath(const Model<T>& model, int i, SecondDerivativesWorkspace<T>& room) {
  room.path.clear();
  Transform<T> X = Transform<T>::identity();
  for (int j = i; j >= 0; j = model.links[j].parent) {
    for (int k = 0; k < axisCount(model.links[j].kind); ++k) {
      const auto& axis = room.first.axes[room.first.first[j] + k];
      room.path.push_back(
          {j, model.links[j].dof + k, X * axis.Z, X * axis.psi, X * axis.chi, X * axis.phi});
    }
    X = X * room.first.ws.X_up[j];
  }
}

/** One axis of the joint of link `end`, which is outboard of, or the same as, all others that it
    is met with here: its row, and the rows of all inboard that its own coordinates change. */
template <typename T>
class OutermostAxis {
 public:
  using PathAxis = typename SecondDerivativesWorkspace<T>::PathAxis;

  OutermostAxis(const Model<T>& model, const SecondDerivativesWorkspace<T>& room, const PathAxis& o,
                bool has_world_loads)
      : o_(o),
        path_(room.path),
        M_(room.first.ws.I_C[o.link]),
        has_loads_(has_world_loads),
        adds_(model.coupled) {
    const DerivativesWorkspace<T>& first = room.first;
    const RigidInertia<T>& M_rate = first.M_rate[o.link];
    const Force<T>& h = first.h[o.link];
    const auto twiceB = [&](const Motion<T>& y) { return twiceCoriolis(M_rate, h, y); };
    own_.F = M_ * o.Z;
    own_.G = {Vector3<T>::Constant(T(0)), twiceCoriolisTransposed(M_rate, h, o.Z)};
    own_.W_q = M_ * o.chi + twiceB(o.psi) + cross(o.Z, first.ws.f[o.link]);
    own_.W_qd = M_ * o.phi + twiceB(o.Z);
    D_ = inertiaRate(M_, o.Z);
    E_ = inertiaRate(M_, o.psi) + inertiaRate(M_rate, o.Z);
    e_ = M_ * o.psi + cross(o.Z, h);
    if (has_loads_) {
      loads_ = {first.turned[o.link].force, room.loads[o.link]};
      own_.W_q = own_.W_q + loads_.turned(o.Z.angular);
    }
    beyond_ = own_;
    const LinkModel<T>& link = model.links[o.link];
    if (!spinsOnALink(model, link)) return;
    const Force<T> spin = spinAxis(link);
    const Motion<T> v_p = first.ws.X_up[o.link] * first.ws.v[link.parent];
    const Force<T> carried = {spin.force, v_p.angular.cross(spin.moment)};
    beyond_.F = own_.F + spin;
    beyond_.G = own_.G + carried;
    beyond_.W_qd = own_.W_qd + carried;
  }

  /// (4) and (5): its own row.
  void tellRow(InverseDynamicsSecondDerivatives<T>& out) const {
    for (std::size_t at = 0; at < path_.size(); ++at) {
      const PathAxis& b = path_[at];
      const Through& by = through(b);
      const Force<T> D_Z = D_ * b.Z, by_A = cross(b.Z, by.F),
                     by_V = cross(b.psi, by.F) + cross(b.Z, by.G) - D_ * b.psi;
      for (const PathAxis& a : path_) {
        if (a.link > b.link) continue;
        T entry = dot(a.chi, by_A) + dot(a.psi, by_V);
        if (has_loads_) entry += dot(o_.Z, loads_.turnedTwice(a.Z.angular, b.Z.angular));
        put(out.d2tau_dq_dq(o_.dof, a.dof, b.dof), entry);
        put(out.d2tau_dq_dqd(o_.dof, a.dof, b.dof), dot(a.psi, by_A - D_Z));
        if (a.link == b.link) {
          put(out.d2tau_dqd_dqd(o_.dof, a.dof, b.dof), -dot(a.Z, D_Z));
          continue;
        }
        put(out.d2tau_dq_dq(o_.dof, b.dof, a.dof), entry);
        put(out.d2tau_dq_dqd(o_.dof, b.dof, a.dof), dot(a.phi, by_A) + dot(a.Z, by_V));
        put(out.d2tau_dq_dqdd(o_.dof, b.dof, a.dof), dot(a.Z, by_A));
        putBoth(out.d2tau_dqd_dqd, o_.dof, a, b, dot(a.Z, by_A - D_Z));
      }
    }
  }

  /// (6) and (7): the rows of joints inboard, by its coordinates and those of any axis a.
  void tellInboard(InverseDynamicsSecondDerivatives<T>& out) const {
    for (const PathAxis& a : path_) {
      const bool is_own = a.link == o_.link;
      const Through& by = through(a);
      const Force<T> D_Z = D_ * a.Z;
      Force<T> q_q = D_ * a.chi + E_ * a.psi + cross(a.psi, e_);
      if (has_loads_)
        q_q = q_q + loads_.turnedTwice(a.Z.angular, o_.Z.angular) +
              cross(o_.Z, loads_.turned(a.Z.angular));
      Force<T> q_qd = D_ * a.psi + cross(a.psi, by.F);
      Force<T> qd_qd = D_Z + cross(a.Z, by.F);
      if (is_own) qd_qd = qd_qd - M_ * cross(a.Z, o_.Z);
      const Force<T> qd_q = D_ * a.phi + E_ * a.Z + cross(a.Z, e_);
      Force<T> q_qdd = Force<T>::zero();
      bool turns = false;  // axis a the wrench, from here inboard: (7)
      for (const PathAxis& i : path_) {
        if (i.link == o_.link) continue;
        if (i.link < a.link && !turns) {
          turns = true;
          q_q = q_q + cross(a.Z, by.W_q);
          q_qd = q_qd + cross(a.Z, by.W_qd);
          q_qdd = cross(a.Z, by.F);
        }
        put(out.d2tau_dq_dqd(i.dof, a.dof, o_.dof), dot(i.Z, q_qd));
        if (turns) put(out.d2tau_dq_dqdd(i.dof, a.dof, o_.dof), dot(i.Z, q_qdd));
        if (is_own) {
          put(out.d2tau_dq_dq(i.dof, a.dof, o_.dof), dot(i.Z, q_q));
          put(out.d2tau_dqd_dqd(i.dof, a.dof, o_.dof), dot(i.Z, qd_qd));
          continue;
        }
        putBoth(out.d2tau_dq_dq, i.dof, a, o_, dot(i.Z, q_q));
        putBoth(out.d2tau_dqd_dqd, i.dof, a, o_, dot(i.Z, qd_qd));
        put(out.d2tau_dq_dqd(i.dof, o_.dof, a.dof), dot(i.Z, qd_q));
        put(out.d2tau_dq_dqdd(i.dof, o_.dof, a.dof), dot(i.Z, D_Z));
      }
    }
  }

 private:
  /// What the axis passes on: to axes of its own joint, or beyond it, with its rotor.
  struct Through {
    Force<T> F, G, W_q, W_qd;
  };
  const Through& through(const PathAxis& axis) const {
    return axis.link == o_.link ? own_ : beyond_;
  }
  void put(T& entry, const T& value) const {
    if (adds_)
      entry += value;
    else
      entry = value;
  }
  void putBoth(Cube<T>& cube, int row, const PathAxis& a, const PathAxis& b, const T& value) const {
    put(cube(row, a.dof, b.dof), value);
    put(cube(row, b.dof, a.dof), value);
  }

  const PathAxis& o_;
  const std::vector<PathAxis>& path_;
  const RigidInertia<T>& M_;
  bool has_loads_;
  bool adds_;  ///< joints follow others: entries are sums
  TurningLoads<T> loads_;
  Through own_, beyond_;
  RigidInertia<T> D_ = RigidInertia<T>::zero(), E_ = RigidInertia<T>::zero();
  Force<T> e_ = Force<T>::zero();
};

}  // namespace detail

/** Second derivatives of inverse dynamics at a state, O(n depth^2): the sweeps of
    inverseDynamicsDerivatives(), then for every axis o one walk over pairs of axes inboard of it.

    Letters as there: F = M Z, 2 B, G = (2 B)' Z, f, h of all that is outboard of o as if it were
    one rigid body; psi, chi, phi of each axis; everything in the coordinates of o's link. Let a be
    inboard of b, or of its joint, and b inboard of o, or of its joint. Seen from a frame that moves
    with Z_a, all that is outboard of it stays what it is, but for motions: those that the joint of
    b receives change by psi_a (velocity) and chi_a - v x psi_a (acceleration), so that
        (1)  D_a psi_b = psi_a x Z_b,   D_a chi_b = chi_a x Z_b + 2 psi_a x psi_b,
             D_a phi_b = 2 psi_a x Z_b
    and 2 B, linear in the velocity, by 2 B of psi_a. With
        (2)  2 B(v) y = M (-v x y) + S,   S = y x* M v + v x* M y,
             Z' S(v, y) = -v' D y,        D = Z x* M - M Z x
    (D is what M changes by as it moves with Z: an inertia without mass) and each coordinate x_a as
    what it does,
        (3)  q: (A, V) = (chi, psi),   qd: (phi, Z),   qdd: (Z, 0)
    row o by q_b and x_a (of b's joint: by q_a alone) is
        (4)  d(D_b tau_o)/dx_a = A_a'(Z_b x* F) + V_a'(psi_b x* F + Z_b x* G - D psi_b)
    and by qd_b, for x = q or qd,
        (5)  d(dtau_o/dqd_b)/dx_a = V_a'(Z_b x* F - D Z_b)     (of one joint, by qd: -V_a' D Z_b)
    The row of any axis i inboard of o, wherever a is (of o's joint: by q_a and qd_a alone, of which
    by q_o, qd_a is by q_a, qd_o with o and a exchanged), is Z_i' of
        (6)  by q_o, x_a:   D A_a + E V_a + V_a x* e,   E = M's change along psi_o and dM/dt's
                            along Z_o,   e = M psi_o + Z_o x* h
             by qd_o, x_a:  D V_a + V_a x* F            (of one joint, by qd: less M (V_a x Z_o))
    and where a is outboard of i, q_a turns also the wrench that o's coordinate makes,
        (7)  + Z_a x* W,    W = M chi + 2 B psi + Z x* f of q_o,  M phi + 2 B Z of qd_o,  F of qdd_o
    Derivatives of different joints commute: each triple is met once, o being the outermost.

    A gyroscopic rotor: beyond the joint of o, F, G and W as (14) of the first derivatives has them.
    Loads in world axes turn back once more. Springs, viscous friction and rotors are linear, and
    the sign of Coulomb friction does not change.

    @param out   made for this model: entries that are zero at every state are never written (most
      of them where a tree has many branches). room.of_tau has the first derivatives
    @throws std::invalid_argument  a vector is not of length n, or a rotor is geared to several
      rates
    @see S. Singh, R. Russell, P. Wensing, On Second-Order Derivatives of Rigid-Body Dynamics:
      Theory and Implementation, IEEE T-RO 40 (2024), for the same triples by other formulas */
template <typename T>
void inverseDynamicsSecondDerivatives(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                                      const std::vector<T>& qd, const std::vector<T>& qdd,
                                      SecondDerivativesWorkspace<T>& room,
                                      InverseDynamicsSecondDerivatives<T>& out,
                                      Terms terms = Terms::all()) {
  if (!model.rotors.empty())
    throw std::invalid_argument(
        "inverseDynamicsSecondDerivatives: model: a rotor is geared to several rates, expected "
        "rotors of one rate each");
  requireSize(model, "inverseDynamicsSecondDerivatives", "out",
              static_cast<std::size_t>(out.d2tau_dq_dq.n()));
  inverseDynamicsDerivatives(model, x, qd, qdd, room.first, room.of_tau, terms);
  const bool has_world_loads = terms.loads && !room.loads.empty();
  if (has_world_loads) detail::sumWorldLoads(model, room);
  if (model.coupled)
    for (Cube<T>* const cube : out.all()) cube->clear();
  for (int i = 0; i < static_cast<int>(model.links.size()); ++i) {
    const int axes = axisCount(model.links[i].kind);
    if (axes == 0) continue;
    detail::gatherPath(model, i, room);
    for (int k = 0; k < axes; ++k) {
      const detail::OutermostAxis<T> o(model, room, room.path[static_cast<std::size_t>(k)],
                                       has_world_loads);
      o.tellRow(out);
      o.tellInboard(out);
    }
  }
}

/** Second derivatives of forward dynamics at a state. What tau(q, qd, qdd(q, qd, tau)) = tau says,
    differentiated twice, x and y being q or qd:

        M d2qdd/dx dy = -(d2tau/dx dy + dM/dx dqdd/dy + dM/dy dqdd/dx),   dM/dqd = 0
        M d2qdd/dq dtau = -dM/dq 1/M

    O(n^4), the products of n^2 columns with 1/M.
    @param qdd     what the state's tau makes, by forwardDynamics()
    @param of_tau  out: the second derivatives of inverse dynamics there
    @param out     room.of_qdd has the first derivatives; room.of_tau L and D in place of M
    @throws std::invalid_argument  as inverseDynamicsSecondDerivatives() */
template <typename T>
void forwardDynamicsSecondDerivatives(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                                      const std::vector<T>& qd, const std::vector<T>& qdd,
                                      SecondDerivativesWorkspace<T>& room,
                                      InverseDynamicsSecondDerivatives<T>& of_tau,
                                      ForwardDynamicsSecondDerivatives<T>& out,
                                      Terms terms = Terms::all()) {
  requireSize(model, "forwardDynamicsSecondDerivatives", "out",
              static_cast<std::size_t>(out.d2qdd_dq_dq.n()));
  inverseDynamicsSecondDerivatives(model, x, qd, qdd, room, of_tau, terms);
  solveForAccelerations(model, room.first, room.of_tau, room.of_qdd);
  const ForwardDynamicsDerivatives<T>& first = room.of_qdd;
  RowsX<T>& product = room.product;
  const int n = model.dof();
  // what stands on the right; dM/dq_j dqdd/dq in both orders of two positions
  out.d2qdd_dq_dq = of_tau.d2tau_dq_dq;
  out.d2qdd_dqd_dqd = of_tau.d2tau_dqd_dqd;
  for (int j = 0; j < n; ++j) {
    const auto dM = of_tau.d2tau_dq_dqdd.slab(j);
    product.noalias() = dM * first.dqdd_dq;
    out.d2qdd_dq_dq.slab(j) += product;
    for (int k = 0; k < n; ++k) out.d2qdd_dq_dq.slab(k).col(j) += product.col(k);
    product.noalias() = dM * first.dqdd_dqd;
    out.d2qdd_dq_dqd.slab(j) = of_tau.d2tau_dq_dqd.slab(j) + product;
    out.d2qdd_dq_dtau.slab(j).noalias() = dM * first.dqdd_dtau;
  }
  for (int j = 0; j < n; ++j)
    for (Cube<T>* const cube : out.all()) {
      product.noalias() = first.dqdd_dtau * cube->slab(j);
      cube->slab(j) = -product;
    }
}

}  // namespace dynwitness::recursive
