// SPDX-License-Identifier: Apache-2.0
// Forward dynamics by articulated-body sweeps over a plan.
#pragma once

#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/plan.hpp"

namespace dynwitness::recursive::fast {

/// Articulated inertia [A B; B' C] and the force that goes with it; see spatial.hpp.
template <typename T>
struct Articulated {
  Symmetric3<T> A;
  Mat<T> B;
  Symmetric3<T> C;
  Vec<T> f, n;
};

/// What the sweep writes on, sized once for a plan.
template <typename T>
struct ForwardDynamicsWorkspace {
  template <typename P>
  explicit ForwardDynamicsWorkspace(const Plan<P>& plan)
      : records(plan.links.size() + 1),
        joints(plan.dof),
        branches(plan.branches),
        axes(plan.world_loads.empty() ? 0 : plan.links.size() + 1),
        others(plan) {}
  struct Record {
    T c, s;           ///< of the joint's angle
    Vec<T> w;         ///< angular velocity
    Symmetric3<T> W;  ///< [w]x [w]x
    Vec<T> gamma;  ///< W_p p: what the parent's spin alone does to the joint, in the parent's axes
    Vec<T> c_a, c_wd;  ///< velocity products of the joint: linear, angular
    Vec<T> f, n;       ///< own bias force
    Vec<T> a, wd;      ///< acceleration of the origin's body point, angular acceleration
  };
  struct Joint {
    Vec<T> U_f, U_n;  ///< M_A Z
    T inverse_D, u;
  };
  std::vector<Record> records;  ///< the first is the world
  std::vector<Joint> joints;    ///< one a degree of freedom
  std::vector<Articulated<T>> branches;
  std::vector<Mat<T>> axes;
  OtherJoints<T> others;
};

namespace detail {

/// [w]x [w]x of the products of w's components.
template <typename T>
DYNWITNESS_INLINE Symmetric3<T> squaredCross(const Vec<T>& w) {
  const T xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
  return {-yy - zz, -xx - zz, -xx - yy, w.x * w.y, w.x * w.z, w.y * w.z};
}

template <typename T>
DYNWITNESS_INLINE void add(Articulated<T>& to, const Articulated<T>& x) {
  to.A = to.A + x.A;
  to.C = to.C + x.C;
  to.B = {to.B.xx + x.B.xx, to.B.xy + x.B.xy, to.B.xz + x.B.xz, to.B.yx + x.B.yx, to.B.yy + x.B.yy,
          to.B.yz + x.B.yz, to.B.zx + x.B.zx, to.B.zy + x.B.zy, to.B.zz + x.B.zz};
  to.f = to.f + x.f;
  to.n = to.n + x.n;
}

/// From about the joint to about the parent's origin, from which the joint is at p:
///     B_A = B - A [p]x,   C_A = C + [p]x B_A + ([p]x B)',   n_A = n + p x f
template <typename T>
DYNWITNESS_INLINE void shiftBack(const Vec<T>& p, Articulated<T>& x) {
  const Symmetric3<T>& A = x.A;
  const Mat<T> B = x.B;
  Mat<T>& S = x.B;
  S = {B.xx - (A.xy * p.z - A.xz * p.y), B.xy - (A.xz * p.x - A.xx * p.z),
       B.xz - (A.xx * p.y - A.xy * p.x), B.yx - (A.yy * p.z - A.yz * p.y),
       B.yy - (A.yz * p.x - A.xy * p.z), B.yz - (A.xy * p.y - A.yy * p.x),
       B.zx - (A.yz * p.z - A.zz * p.y), B.zy - (A.zz * p.x - A.xz * p.z),
       B.zz - (A.xz * p.y - A.yz * p.x)};
  x.C = {x.C.xx + (p.y * (S.zx + B.zx) - p.z * (S.yx + B.yx)),
         x.C.yy + (p.z * (S.xy + B.xy) - p.x * (S.zy + B.zy)),
         x.C.zz + (p.x * (S.yz + B.yz) - p.y * (S.xz + B.xz)),
         x.C.xy + ((p.y * S.zy - p.z * S.yy) + (p.z * B.xx - p.x * B.zx)),
         x.C.xz + ((p.y * S.zz - p.z * S.yz) + (p.x * B.yx - p.y * B.xx)),
         x.C.yz + ((p.z * S.xz - p.x * S.zz) + (p.x * B.yy - p.y * B.xy))};
  x.n = x.n + cross(p, x.f);
}

/// M -= U U' / D,  with U = M Z and D = d + Z' U for any axis Z.
template <typename T>
DYNWITNESS_INLINE void subtractOuter(const Vec<T>& f, const Vec<T>& n, const T& inverse_D,
                                     Articulated<T>& M) {
  const Vec<T> g = f * inverse_D, m = n * inverse_D;
  M.A = M.A - Symmetric3<T>{g.x * f.x, g.y * f.y, g.z * f.z, g.x * f.y, g.x * f.z, g.y * f.z};
  M.C = M.C - Symmetric3<T>{m.x * n.x, m.y * n.y, m.z * n.z, m.x * n.y, m.x * n.z, m.y * n.z};
  M.B = {M.B.xx - g.x * n.x, M.B.xy - g.x * n.y, M.B.xz - g.x * n.z,
         M.B.yx - g.y * n.x, M.B.yy - g.y * n.y, M.B.yz - g.y * n.z,
         M.B.zx - g.z * n.x, M.B.zy - g.z * n.y, M.B.zz - g.z * n.z};
}

/// M Z_k
template <typename T, typename P>
void columnOf(const Link<P>& link, int k, const Articulated<T>& M, Vec<T>& f, Vec<T>& n) {
  const auto linear = [&](int j) {
    f = j == 0   ? Vec<T>{M.A.xx, M.A.xy, M.A.xz}
        : j == 1 ? Vec<T>{M.A.xy, M.A.yy, M.A.yz}
                 : Vec<T>{M.A.xz, M.A.yz, M.A.zz};
    n = j == 0   ? Vec<T>{M.B.xx, M.B.xy, M.B.xz}
        : j == 1 ? Vec<T>{M.B.yx, M.B.yy, M.B.yz}
                 : Vec<T>{M.B.zx, M.B.zy, M.B.zz};
  };
  const auto angular = [&](int j) {
    f = j == 0   ? Vec<T>{M.B.xx, M.B.yx, M.B.zx}
        : j == 1 ? Vec<T>{M.B.xy, M.B.yy, M.B.zy}
                 : Vec<T>{M.B.xz, M.B.yz, M.B.zz};
    n = j == 0   ? Vec<T>{M.C.xx, M.C.xy, M.C.xz}
        : j == 1 ? Vec<T>{M.C.xy, M.C.yy, M.C.yz}
                 : Vec<T>{M.C.xz, M.C.yz, M.C.zz};
  };
  if (link.kind == JointKind::kHelical) {
    linear(2);
    const Vec<T> f_l = f, n_l = n;
    angular(2);
    f = f + f_l * link.pitch;
    n = n + n_l * link.pitch;
  } else if (link.kind == JointKind::kFloating && k < 3) {
    linear(k);
  } else {
    angular(link.kind == JointKind::kFloating ? k - 3 : k);
  }
}

template <typename T, typename P>
DYNWITNESS_INLINE void forwardDynamicsBody(const Plan<P>& plan, const JointPosition<T>* x,
                                           const T* qd, const T* tau,
                                           ForwardDynamicsWorkspace<T>& ws, T* qdd) {
  using Record = typename ForwardDynamicsWorkspace<T>::Record;
  using Joint = typename ForwardDynamicsWorkspace<T>::Joint;
  const int n = static_cast<int>(plan.links.size());
  Record* const records = ws.records.data();
  records[0].w = records[0].wd = Vec<T>::zero();
  records[0].W = Symmetric3<T>::zero();
  records[0].a = Vec<T>::zero() - in<T>(plan.gravity);

  // outward: velocities, and what they alone need
  for (int i = 0; i < n; ++i) {
    const Link<P>& link = plan.links[i];
    const Record& parent = records[link.parent];
    Record& r = records[i + 1];
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayThrough<kStep>(plan, link, x, ws.others);
      r.c = way.c;
      r.s = way.s;
      if (link.is_apart) r.gamma = times(parent.W, jointPlace<kStep>(link, x, ws.others));
      Vec<T> w = way.outward(parent.w);  // (1)
      if constexpr (isTurn(kStep)) {
        const T rate = qd[link.dof];
        r.c_wd = {w.y * rate, -(w.x * rate), T(0)};
        w.z = w.z + rate;
      } else if constexpr (isSlide(kStep)) {
        const T twice = qd[link.dof] + qd[link.dof];
        r.c_a = {w.y * twice, -(w.x * twice), T(0)};
      } else {
        Vec<T> v_J, w_J;
        otherMotion(link, qd, v_J, w_J);
        r.c_a = cross(w + w + w_J, v_J);
        w = w + w_J;
        r.c_wd = cross(w, w_J);
      }
      const Symmetric3<T> W = squaredCross(w);
      const Symmetric3<P>& I = link.I;
      r.w = w;
      r.W = W;
      r.f = times(W, in<T>(link.h));
      r.n = {link.D.x * W.yz + I.yz * (W.yy - W.zz) - I.xy * W.xz + I.xz * W.xy,
             link.D.y * W.xz + I.xz * (W.zz - W.xx) - I.yz * W.xy + I.xy * W.yz,
             link.D.z * W.xy + I.xy * (W.xx - W.yy) - I.xz * W.yz + I.yz * W.xz};
      if (link.is_loaded) {
        r.f = r.f - in<T>(link.force);
        r.n = r.n - in<T>(link.moment);
      }
    });
  }
  subtractWorldLoads(plan, x, ws.others, ws.axes, ws.records);
  addRotors(plan, qd, static_cast<const T*>(nullptr), ws.others, ws.records, ws.records);

  // inward: what each link feels of its subtree
  Articulated<T> M;  // of the link at hand; between two, what the link before hands inward
  for (int i = n - 1; i >= 0; --i) {
    const Link<P>& link = plan.links[i];
    const Record& r = records[i + 1];
    {
      const Vec<P>& h = link.h;
      if (link.end == i + 1) {  // a tip
        M.A = Symmetric3<T>::diagonal(link.mass);
        M.B = {T(0), h.z, -h.y, -h.z, T(0), h.x, h.y, -h.x, T(0)};
        M.C = in<T>(link.I);
        M.f = r.f;
        M.n = r.n;
      } else {
        M.A.xx = M.A.xx + link.mass;
        M.A.yy = M.A.yy + link.mass;
        M.A.zz = M.A.zz + link.mass;
        M.B.xy = M.B.xy + h.z;
        M.B.xz = M.B.xz - h.y;
        M.B.yx = M.B.yx - h.z;
        M.B.yz = M.B.yz + h.x;
        M.B.zx = M.B.zx + h.y;
        M.B.zy = M.B.zy - h.x;
        M.C = M.C + in<T>(link.I);
        M.f = M.f + r.f;
        M.n = M.n + r.n;
      }
      if (link.branch >= 0) add(M, ws.branches[link.branch]);
    }
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      if constexpr (isTurn(kStep)) {
        Joint& j = ws.joints[link.dof];
        j.U_f = {M.B.xz, M.B.yz, M.B.zz};  // (2)
        j.U_n = {M.C.xz, M.C.yz, M.C.zz};
        j.inverse_D = T(1) / (link.rotor + j.U_n.z);
        j.u = tau[link.dof] - M.n.z;
        if (link.is_sprung) j.u = j.u - passiveForce(link, x, qd[link.dof]);
        if (link.parent == 0) return;
        const Vec<T> g = j.U_f * j.inverse_D;  // (3)
        const T m_x = j.U_n.x * j.inverse_D, m_y = j.U_n.y * j.inverse_D;
        const T left = link.rotor_less_spin * j.inverse_D;
        T left_zz = j.U_n.z * left;
        if (link.is_special) {  // (5)
          j.U_n.z = j.U_n.z + link.spin;
          left_zz = left_zz - link.spin * (j.U_n.z * j.inverse_D);
        }
        const Vec<T>&f = j.U_f, &l = j.U_n;
        M.A = M.A - Symmetric3<T>{g.x * f.x, g.y * f.y, g.z * f.z, g.x * f.y, g.x * f.z, g.y * f.z};
        M.B = {M.B.xx - g.x * l.x, M.B.xy - g.x * l.y, f.x * left,
               M.B.yx - g.y * l.x, M.B.yy - g.y * l.y, f.y * left,
               M.B.zx - g.z * l.x, M.B.zy - g.z * l.y, f.z * left};
        M.C = {M.C.xx - m_x * l.x, M.C.yy - m_y * l.y, left_zz,
               M.C.xy - m_x * l.y, l.x * left,         l.y * left};
        const T c_x = r.c_wd.x, c_y = r.c_wd.y, e = j.u * j.inverse_D;
        M.f = {M.f.x + (M.B.xx * c_x + M.B.xy * c_y) + f.x * e,
               M.f.y + (M.B.yx * c_x + M.B.yy * c_y) + f.y * e,
               M.f.z + (M.B.zx * c_x + M.B.zy * c_y) + f.z * e};
        M.n = {M.n.x + (M.C.xx * c_x + M.C.xy * c_y) + l.x * e,
               M.n.y + (M.C.xy * c_x + M.C.yy * c_y) + l.y * e,
               M.n.z + (M.C.xz * c_x + M.C.yz * c_y) + l.z * e};
      } else if constexpr (isSlide(kStep)) {
        Joint& j = ws.joints[link.dof];
        j.U_f = {M.A.xz, M.A.yz, M.A.zz};  // (2)
        j.U_n = {M.B.zx, M.B.zy, M.B.zz};
        j.inverse_D = T(1) / (link.rotor + j.U_f.z);
        j.u = tau[link.dof] - M.f.z;
        const T left = link.rotor * j.inverse_D;
        const T left_zz = j.U_n.z * left - link.spin * (j.U_f.z * j.inverse_D);
        if (link.is_sprung) j.u = j.u - passiveForce(link, x, qd[link.dof]);
        j.U_n.z = j.U_n.z + link.spin;  // (5)
        if (link.parent == 0) return;
        subtractOuter(j.U_f, j.U_n, j.inverse_D, M);  // (3)
        // row z: d/D of what it was
        M.A.xz = j.U_f.x * left, M.A.yz = j.U_f.y * left, M.A.zz = j.U_f.z * left;
        M.B.zx = j.U_n.x * left, M.B.zy = j.U_n.y * left, M.B.zz = left_zz;
        const T e = j.u * j.inverse_D;
        M.f = M.f + times(M.A, r.c_a) + j.U_f * e;
        M.n = M.n + transposedTimes(M.B, r.c_a) + j.U_n * e;
      } else {
        for (int k = 0, d = link.dof; k < link.axes; ++k, ++d) {
          Joint& j = ws.joints[d];
          columnOf(link, k, M, j.U_f, j.U_n);  // (2)
          j.inverse_D = T(1) / (link.rotor + alongAxis(link, k, j.U_f, j.U_n));
          j.u = tau[d] - alongAxis(link, k, M.f, M.n);
          if (link.is_sprung) j.u = j.u - passiveForce(link, x, qd[d]);
          j.U_n.z = j.U_n.z + link.spin;                // (5)
          subtractOuter(j.U_f, j.U_n, j.inverse_D, M);  // (3)
          const T e = j.u * j.inverse_D;
          M.f = M.f + j.U_f * e;
          M.n = M.n + j.U_n * e;
        }
        if (link.parent == 0) return;
        M.f = M.f + times(M.A, r.c_a) + times(M.B, r.c_wd);
        M.n = M.n + transposedTimes(M.B, r.c_a) + times(M.C, r.c_wd);
      }
      const auto way = wayBack<kStep>(link, r.c, r.s, ws.others);
      way.inward(M.A);
      way.inward(M.B);
      way.inward(M.C);
      way.inward(M.f);
      way.inward(M.n);
      if (link.is_apart) {
        M.f = M.f + times(M.A, r.gamma);
        M.n = M.n + transposedTimes(M.B, r.gamma);
        shiftBack(jointPlace<kStep>(link, x, ws.others), M);
      }
    });
    if (link.parent == i || link.parent == 0) continue;  // the parent is next, or the world
    Articulated<T>& sum = ws.branches[plan.links[link.parent - 1].branch];
    if (link.is_last_child)
      sum = M;
    else
      add(sum, M);
  }

  // outward: accelerations
  for (int i = 0; i < n; ++i) {
    const Link<P>& link = plan.links[i];
    const Record& parent = records[link.parent];
    Record& r = records[i + 1];
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayBack<kStep>(link, r.c, r.s, ws.others);
      Vec<T> a = parent.a;
      if (link.is_apart) a = a + cross(parent.wd, jointPlace<kStep>(link, x, ws.others)) + r.gamma;
      a = way.outward(a);
      Vec<T> wd = way.outward(parent.wd);
      const auto acceleration = [&](const Joint& j) {
        const T felt = (j.U_f.x * a.x + j.U_f.y * a.y + j.U_f.z * a.z) +
                       (j.U_n.x * wd.x + j.U_n.y * wd.y + j.U_n.z * wd.z);
        return (j.u - felt) * j.inverse_D;  // (4)
      };
      if constexpr (isTurn(kStep)) {
        wd = {wd.x + r.c_wd.x, wd.y + r.c_wd.y, wd.z};
        const T out = acceleration(ws.joints[link.dof]);
        wd.z = wd.z + out;
        qdd[link.dof] = out;
      } else if constexpr (isSlide(kStep)) {
        a = a + r.c_a;
        const T out = acceleration(ws.joints[link.dof]);
        a.z = a.z + out;
        qdd[link.dof] = out;
      } else {
        a = a + r.c_a;
        wd = wd + r.c_wd;
        for (int k = link.axes - 1, d = link.dof + k; k >= 0; --k, --d) {
          qdd[d] = acceleration(ws.joints[d]);
          addAlongAxis(link, k, qdd[d], a, wd);
        }
      }
      r.a = a;
      r.wd = wd;
    });
  }
}

DYNWITNESS_FOR_AVX2 inline void forwardDynamicsForAvx2(const Plan<double>& plan,
                                                       const JointPosition<double>* x,
                                                       const double* qd, const double* tau,
                                                       ForwardDynamicsWorkspace<double>& ws,
                                                       double* qdd) {
  forwardDynamicsBody(plan, x, qd, tau, ws, qdd);
}

}  // namespace detail

/** qdd of M(q) qdd + c(q, qd) + g(q) = tau + Q, as recursive::forwardDynamics, in O(n). M is not
    formed.

    As there, but that accelerations are those of body points, which needs no linear velocities:
    with W = [w]x [w]x, p the joint seen from the parent, and c the joint's own velocity products,
        (1)  w = R w_p + z qd,   gamma = W_p p,   f = W h,   n = w x I w
        (2)  U = M_A Z,   D = d + Z' U,   u = tau - k (q - rest) - friction(qd) - Z' f_A
        (3)  M_a = M_A - U U' / D,  f_a = f_A + M_a c + U u / D,  turned back by R, + M_a gamma,
             then shifted by p: added to the parent's
        (4)  a = R (a_p + w'_p x p + gamma) + c,   qdd = (u - U' a) / D,   a += Z qdd
        (5)  a gyroscopic rotor of h:  once D is known, U_n += h z and n_A += h w_p x z qd
    Where Z is the z axis of a turning joint, M_a's row z is (d - h)/D times M_A's, and its last
    entry ((d - h) U_z - h (U_z + h)) / D: that cancels nothing. The arrays are those of
    recursive::forwardDynamics, and are trusted to be as long as there. */
template <typename T>
void forwardDynamics(const Plan<T>& plan, const JointPosition<T>* x, const T* qd, const T* tau,
                     ForwardDynamicsWorkspace<T>& ws, T* qdd) {
  if constexpr (std::is_same_v<T, double>)
    if (kHasAvx2) return detail::forwardDynamicsForAvx2(plan, x, qd, tau, ws, qdd);
  detail::forwardDynamicsBody(plan, x, qd, tau, ws, qdd);
}

}  // namespace dynwitness::recursive::fast
