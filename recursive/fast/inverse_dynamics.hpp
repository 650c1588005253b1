// SPDX-License-Identifier: Apache-2.0
// Inverse dynamics by Newton-Euler sweeps over a plan.
#pragma once

#include "recursive/fast/plan.hpp"

namespace dynwitness::recursive::fast {

/// What the sweep writes on, sized once for a plan.
template <typename T>
struct InverseDynamicsWorkspace {
  template <typename P>
  explicit InverseDynamicsWorkspace(const Plan<P>& plan)
      : motions(plan.links.size() + 1),
        records(plan.links.size() + 1),
        axes(plan.world_loads.empty() ? 0 : plan.links.size() + 1),
        others(plan) {}
  /// Apart from what the inward sweep needs: with very many links, memory is what takes the time.
  struct Motion {
    Vec<T> w, wd,
        a;     ///< angular velocity and acceleration; acceleration of the origin's body point
    Mat<T> U;  ///< a point r of the link accelerates by a + U r
  };
  struct Record {
    T c, s;       ///< of the joint's angle
    Vec<T> f, n;  ///< force through the joint and moment about it
  };
  std::vector<Motion> motions;  ///< the first is the world
  std::vector<Record> records;  ///< the same
  std::vector<Mat<T>> axes;     ///< columns: world axes in link axes
  OtherJoints<T> others;
};

namespace detail {

/// Takes a load in world axes off the forces of link records.
template <typename T, typename P, typename Record>
void subtractWorldLoads(const Plan<P>& plan, const JointPosition<T>* x, OtherJoints<T>& others,
                        std::vector<Mat<T>>& axes, std::vector<Record>& records) {
  if (plan.world_loads.empty()) return;
  axes[0] = {T(1), T(0), T(0), T(0), T(1), T(0), T(0), T(0), T(1)};
  for (std::size_t i = 0; i < plan.links.size(); ++i) {
    const Link<P>& link = plan.links[i];
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayThrough<kStep>(plan, link, x, others);
      const Mat<T>& from = axes[link.parent];
      const Vec<T> e0 = way.outward({from.xx, from.yx, from.zx}),
                   e1 = way.outward({from.xy, from.yy, from.zy}),
                   e2 = way.outward({from.xz, from.yz, from.zz});
      axes[i + 1] = {e0.x, e1.x, e2.x, e0.y, e1.y, e2.y, e0.z, e1.z, e2.z};
    });
  }
  for (const PlannedLoad<P>& load : plan.world_loads) {
    const Vec<T> force = times(axes[load.link + 1], in<T>(load.force));
    Record& record = records[load.link + 1];
    record.f = record.f - force;
    record.n =
        record.n - times(axes[load.link + 1], in<T>(load.moment)) - cross<T>(in<T>(load.at), force);
  }
}

/// (4): what a gyroscopic rotor feels of the parent.
template <typename T, typename P>
void addParentsTurn(const Plan<P>& plan, const InverseDynamicsWorkspace<T>& ws, T* tau) {
  forEachSpecial(plan, [&](const Link<P>& link, int record, auto step) DYNWITNESS_INLINE_LAMBDA {
    const auto& r = ws.records[record];
    const auto way = wayBack<decltype(step)::value>(link, r.c, r.s, ws.others);
    tau[link.dof] = tau[link.dof] + link.spin * way.outward(ws.motions[link.parent].wd).z;
  });
}

/// From so many links on, what a sweep reads and writes (560 bytes a link) does not fit into most
/// caches ...
inline constexpr int kManyLinks = 20000;
/// ... and is asked for some links before its turn.
inline constexpr int kAhead = 6;
template <typename X>
DYNWITNESS_INLINE void fetch(const X& x) {
  constexpr std::size_t kLine = 64;
  for (std::size_t at = 0; at < sizeof x; at += kLine)
    __builtin_prefetch(reinterpret_cast<const char*>(&x) + at);
}

template <typename T, typename P>
DYNWITNESS_INLINE void inverseDynamicsBody(const Plan<P>& plan, const JointPosition<T>* x,
                                           const T* qd, const T* qdd,
                                           InverseDynamicsWorkspace<T>& ws, T* tau) {
  using Motion = typename InverseDynamicsWorkspace<T>::Motion;
  using Record = typename InverseDynamicsWorkspace<T>::Record;
  const int n = static_cast<int>(plan.links.size());
  const Link<P>* const links = plan.links.data();
  Motion* const motions = ws.motions.data();
  Record* const records = ws.records.data();
  motions[0].w = motions[0].wd = Vec<T>::zero();
  motions[0].a = Vec<T>::zero() - in<T>(plan.gravity);
  motions[0].U = {T(0), T(0), T(0), T(0), T(0), T(0), T(0), T(0), T(0)};

  // outward: how each link moves, and what it alone needs
  for (int i = 0; i < n; ++i) {
    if (n > kManyLinks) {
      const int ahead = std::min(i + kAhead, n - 1);
      fetch(links[ahead]);
      fetch(motions[ahead + 1]);
      fetch(records[ahead + 1]);
    }
    const Link<P>& link = links[i];
    const Motion& parent = motions[link.parent];
    Motion& motion = motions[i + 1];
    Record& r = records[i + 1];
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayThrough<kStep>(plan, link, x, ws.others);
      r.c = way.c;
      r.s = way.s;
      Vec<T> w = way.outward(parent.w), wd = way.outward(parent.wd);
      Vec<T> a = parent.a;
      if (link.is_apart) a = a + times(parent.U, jointPlace<kStep>(link, x, ws.others));
      a = way.outward(a);  // (1)
      if constexpr (isTurn(kStep)) {
        const T rate = qd[link.dof];
        wd = {wd.x + w.y * rate, wd.y - w.x * rate, wd.z + qdd[link.dof]};
        w.z = w.z + rate;
      } else if constexpr (isSlide(kStep)) {
        const T twice = qd[link.dof] + qd[link.dof];
        a = {a.x + w.y * twice, a.y - w.x * twice, a.z + qdd[link.dof]};
      } else {
        Vec<T> v_J, w_J, a_J, wd_J;
        otherMotion(link, qd, v_J, w_J);
        otherMotion(link, qdd, a_J, wd_J);
        const Vec<T> w_before = w;
        w = w + w_J;
        a = a + a_J + cross(w + w_before, v_J);
        wd = wd + wd_J + cross(w, w_J);
      }
      const T xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
      const T xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z;
      const Mat<T> U = {-yy - zz,  xy - wd.z, xz + wd.y, xy + wd.z, -xx - zz,
                        yz - wd.x, xz - wd.y, yz + wd.x, -xx - yy};
      const Vec<T>& h = in<T>(link.h);
      const Symmetric3<P>& I = link.I;
      motion = {w, wd, a, U};
      r.f = times(U, h) + a * link.mass;  // (2)
      // I w' + w x I w, with the products of w taken together
      r.n = Vec<T>{I.xx * wd.x + link.D.x * yz + I.yz * (yy - zz) - I.xy * U.zx + I.xz * U.yx,
                   I.yy * wd.y + link.D.y * xz + I.xz * (zz - xx) - I.yz * U.xy + I.xy * U.zy,
                   I.zz * wd.z + link.D.z * xy + I.xy * (xx - yy) - I.xz * U.yz + I.yz * U.xz} +
            cross(h, a);
      if (link.is_loaded) {
        r.f = r.f - in<T>(link.force);
        r.n = r.n - in<T>(link.moment);
      }
    });
  }
  subtractWorldLoads(plan, x, ws.others, ws.axes, ws.records);
  addRotors(plan, qd, qdd, ws.others, ws.motions, ws.records);

  // inward: what passes through each joint
  for (int i = n - 1; i >= 0; --i) {
    if (n > kManyLinks) {
      const int ahead = std::max(i - kAhead, 0);
      fetch(links[ahead]);
      fetch(records[ahead + 1]);
    }
    const Link<P>& link = links[i];
    const Record& r = records[i + 1];
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      if constexpr (isTurn(kStep) || isSlide(kStep)) {
        tau[link.dof] = (isTurn(kStep) ? r.n.z : r.f.z) + link.rotor * qdd[link.dof];
      } else {
        for (int k = 0, d = link.dof; k < link.axes; ++k, ++d)
          tau[d] = alongAxis(link, k, r.f, r.n) + link.rotor * qdd[d];
      }
      if (link.is_sprung) tau[link.dof] = tau[link.dof] + passiveForce(link, x, qd[link.dof]);
      if (link.parent == 0) return;
      Record& parent = records[link.parent];
      const auto way = wayBack<kStep>(link, r.c, r.s, ws.others);
      Vec<T> f = r.f, moment = r.n;
      way.inward(f);
      way.inward(moment);
      parent.f = parent.f + f;  // (3)
      parent.n = parent.n + moment;
      if (link.is_apart) parent.n = parent.n + cross(jointPlace<kStep>(link, x, ws.others), f);
    });
  }
  addParentsTurn(plan, ws, tau);
}

DYNWITNESS_FOR_AVX2 inline void inverseDynamicsForAvx2(const Plan<double>& plan,
                                                       const JointPosition<double>* x,
                                                       const double* qd, const double* qdd,
                                                       InverseDynamicsWorkspace<double>& ws,
                                                       double* tau) {
  inverseDynamicsBody(plan, x, qd, qdd, ws, tau);
}

}  // namespace detail

/** tau = M(q) qdd + c(q, qd) + g(q) - Q, as recursive::inverseDynamics, loads and springs included.
    It carries the acceleration a of the body's point at the origin and U = [w']x + [w]x [w]x:
        (1)  w = R w_p + z qd,  w' = R w'_p + w x z qd + z qdd,  a = R (a_p + U_p p), a_0 = -gravity
        (2)  f = m a + U h,     n = I w' + w x I w + h x a       the link's own
        (3)  f_p += R' f,       n_p += R' n + p x R' f,          tau = n_z + d qdd
    and (f_z in place of n_z, 2 w x z qd + z qdd added to a, where the joint slides). A spring and
    friction:
        (4)  tau += k (q - rest) + friction(qd); a gyroscopic rotor of h, which the parent carries:
             tau += h z'w'_p,   n_p += R' h (z qdd + w_p x z qd)

    The arrays are those of recursive::inverseDynamics, and are trusted to be as long as there. */
template <typename T>
void inverseDynamics(const Plan<T>& plan, const JointPosition<T>* x, const T* qd, const T* qdd,
                     InverseDynamicsWorkspace<T>& ws, T* tau) {
  if constexpr (std::is_same_v<T, double>)
    if (kHasAvx2) return detail::inverseDynamicsForAvx2(plan, x, qd, qdd, ws, tau);
  detail::inverseDynamicsBody(plan, x, qd, qdd, ws, tau);
}

}  // namespace dynwitness::recursive::fast
