// SPDX-License-Identifier: Apache-2.0
// The articulated-body step of one joint, as all sweeps of forward dynamics take it.
#pragma once

#include <vector>

#include "recursive/joint_forces.hpp"
#include "recursive/model.hpp"

namespace dynwitness::recursive {

/// What a link with all that is jointed to it asks of its parent, f = M a + f_A, on the way through
/// its joint: before the first axis its own, after the last what the parent feels.
template <typename T>
struct ArticulatedBody {
  ArticulatedInertia<T> M;
  Force<T> f;
};

/** The steps of articulated-body sweeps at one state. With p the parent of link i, Z the joint's
    axis, constant in link axes, X the transformation from p to i:
        (1)  v_i = X v_p + Z qd_i,   c_i = v_i x Z qd_i
        (2)  M_A = M_i,   f_A = v_i x* (M_i v_i) - loads                       at first, own parts
        (3)  U = M_A Z,   D = d + Z' U,   u = tau_i - Z' f_A - k (q_i - rest) - friction
        (4)  M_A of p  +=  X' (M_A - U U' / D) X          the inward projection P M_A
        (5)  f_A of p  +=  X' (f_A + (M_A - U U' / D) c_i + U u / D)
        (6)  qdd_i = (u - U' (X a_p + c_i)) / D,   a_i = X a_p + c_i + Z qdd_i,   a_0 = -gravity
    A joint of several axes is passed one axis at a time, as if there were massless links between:
    (3) sees M_A and f_A as the axes before have left them, and (6) goes through the axes backward.
    Successive eliminations of one axis are the elimination of all, without a matrix to invert. A
    gyroscopic rotor (newton_euler.hpp, (5) and (6)) adds h z'(X a_p) to the joint's equation and (h
    qdd + w_p x h qd) z to the parent's force. With G = (0, h z) that is U + G in place of U in (4),
    (5) and (6), but not in D; and G'c_i = h z'(w_i x z) qd_i = 0, so that nothing else changes.
    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), table 7.1, p. 132 */
template <typename Joints, typename T>
class ArticulatedSteps {
 public:
  ArticulatedSteps(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                   const std::vector<T>& qd, Terms terms, Workspace<T>& ws)
      : model_(model), x_(x), qd_(qd), terms_(terms), ws_(ws), a_0_(Motion<T>::zero()) {
    if (terms.gravity) a_0_.linear = -model.gravity;
  }

  /// Outward through all joints: velocities, and what each link alone brings.
  void start() {
    for (int i = 0; i < static_cast<int>(model_.links.size()); ++i) {
      const LinkModel<T>& link = model_.links[i];
      const int p = link.parent;
      ws_.X_up[i] = Joints::transform(link, x_);
      const Motion<T> v_J = Joints::motion(link, qd_);
      ws_.v[i] = p < 0 ? v_J : ws_.X_up[i] * ws_.v[p] + v_J;
      ws_.c[i] = cross(ws_.v[i], v_J);  // (1)
      ws_.M_A[i] = ArticulatedInertia<T>::fromRigid(link.M);
      ws_.f[i] = biasForce(link.M, ws_.v[i]);  // (2)
    }
    if (terms_.loads) subtractLoads(model_, ws_, ws_.f);
  }

  /// Link i, all outboard of it passed.
  ArticulatedBody<T> body(int i) const { return {ws_.M_A[i], ws_.f[i]}; }

  /// (3) of axis k of link i's joint, rate d, into ws.U, D and u.
  void formEquation(int i, int k, int d, const T& tau, const ArticulatedBody<T>& body) {
    const LinkModel<T>& link = model_.links[i];
    ws_.U[d] = Joints::column(link, k, body.M);
    ws_.D[d] = link.rotor + Joints::force(link, k, ws_.U[d]);
    ws_.u[d] = tau - Joints::force(link, k, body.f);
    passiveForces(model_, link, d, x_, qd_, terms_, [&](const T& force) { ws_.u[d] -= force; });
    if (spinsOnALink(model_, link)) ws_.U[d] = ws_.U[d] + spinAxis(link);
  }
  /// (4) and (5) of the axis: it gives way as its equation says.
  void project(int d, ArticulatedBody<T>& body) const {
    const T inverse_D = T(1) / ws_.D[d];
    body.M = body.M.minusOuter(ws_.U[d], inverse_D);
    body.f = body.f + ws_.U[d] * (ws_.u[d] * inverse_D);
  }
  /// (5) of an axis whose acceleration is given: it passes all on, and what it needs itself.
  void passGiven(int i, int k, const T& qdd, ArticulatedBody<T>& body) const {
    const LinkModel<T>& link = model_.links[i];
    Motion<T> given = Motion<T>::zero();
    Joints::addMotion(link, k, qdd, given);
    body.f = body.f + body.M * given;
    if (spinsOnALink(model_, link)) body.f = body.f + spinAxis(link) * qdd;
  }
  /// (4) and (5): what all axes have left goes to the parent.
  void handOn(int i, ArticulatedBody<T> body) {
    const LinkModel<T>& link = model_.links[i];
    const int p = link.parent;
    if (p < 0) return;
    if (spinsOnALink(model_, link))
      body.f = body.f + spinForce(link, qd_[link.dof], T(0), ws_.X_up[i] * ws_.v[p]);
    ws_.M_A[p] = ws_.M_A[p] + ws_.X_up[i].inverseTimes(body.M);
    ws_.f[p] = ws_.f[p] + ws_.X_up[i].inverseTimes(body.f + body.M * ws_.c[i]);
  }

  /// X a_p: the acceleration that link i's parent (or the world) has, in the link's coordinates.
  Motion<T> carried(int i) const {
    const int p = model_.links[i].parent;
    return ws_.X_up[i] * (p < 0 ? a_0_ : ws_.a[p]);
  }
  /// (6) of a joint: outward, axes backward. @param solve  the acceleration of rate d, with ws.a[i]
  /// as it is before it; acceleration(i, d) unless more is known
  template <typename Solve>
  void accelerate(int i, std::vector<T>& qdd, const Solve& solve) {
    const LinkModel<T>& link = model_.links[i];
    ws_.a[i] = carried(i) + ws_.c[i];
    for (int k = Joints::axes(link) - 1, d = link.dof + k; k >= 0; --k, --d) {
      qdd[d] = solve(d);
      Joints::addMotion(link, k, qdd[d], ws_.a[i]);
    }
  }
  /// (6), u being all that is left for acceleration.
  T acceleration(int i, int d, const T& u) const {
    return (u - dot(ws_.a[i], ws_.U[d])) / ws_.D[d];
  }
  T acceleration(int i, int d) const { return acceleration(i, d, ws_.u[d]); }

 private:
  const Model<T>& model_;
  const std::vector<JointPosition<T>>& x_;
  const std::vector<T>& qd_;
  Terms terms_;
  Workspace<T>& ws_;
  Motion<T> a_0_;
};

}  // namespace dynwitness::recursive
