// SPDX-License-Identifier: Apache-2.0
// First derivatives of inverse dynamics by one sweep out and one in, over a plan.
#pragma once

#include <algorithm>

#include "recursive/fast/derivatives_workspace.hpp"
#include "recursive/fast/mass_matrix.hpp"

namespace dynwitness::recursive::fast {

namespace detail {

// ---- outward ------------------------------------------------------------------------------------

/// What a joint of several axes, or a screw, does to its link, and its axes' part of the lanes.
template <typename Pack, typename T>
struct JointMotion {
  Pack v, w, a, wd;  ///< at these rates and accelerations
};
template <typename Pack, typename T, typename P>
DYNWITNESS_INLINE JointMotion<Pack, T> jointMotion(const Link<P>& link, const T* qd, const T* qdd,
                                                   const Pack& e_x, const Pack& e_y,
                                                   const Pack& e_z) {
  const auto along = [&](const Vec<T>& v) { return v.x * e_x + v.y * e_y + v.z * e_z; };
  Vec<T> v, w, a, wd;
  otherMotion(link, qd, v, w);
  otherMotion(link, qdd, a, wd);
  return {along(v), along(w), along(a), along(wd)};
}

/// Axes, motion and joint axes of all links, into frames and lanes.
template <typename Pack, typename T, typename P>
DYNWITNESS_INLINE void moveOutward(const Plan<P>& plan, const JointPosition<T>* x, const T* qd,
                                   const T* qdd, DerivativesWorkspace<T>& ws) {
  using Frame = typename DerivativesWorkspace<T>::Frame;
  const int n = static_cast<int>(plan.links.size());
  const Link<P>* const links = plan.links.data();
  Frame* const frames = ws.frames.data();
  for (int i = 0; i < n; ++i) {
    const Link<P>& link = links[i];
    const Frame& parent = frames[link.parent];
    Frame& frame = frames[i + 1];
    auto& body = ws.bodies[ws.lanes[i] / kBlock];
    const int at = ws.lanes[i] % kBlock;
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayThrough<kStep>(plan, link, x, ws.others);
      Pack e_x = Pack::load(parent.x), e_y = Pack::load(parent.y), e_z = Pack::load(parent.z);
      const Pack w_p = Pack::load(parent.w), wd_p = Pack::load(parent.wd);
      Pack a = Pack::load(parent.a), u2 = Pack::load(parent.v2_J);
      if (link.is_apart) {
        const Vec<T> place = jointPlace<kStep>(link, x, ws.others);
        const Pack p = place.x * e_x + place.y * e_y + place.z * e_z;
        const Pack w_x_p = cross(w_p, p);
        a = a + cross(wd_p, p) + cross(w_p, w_x_p);
        u2 = u2 + w_x_p + w_x_p;
        p.store(frame.p);
      }
      u2.store(frame.u2);
      axesThrough(way, e_x, e_y, e_z);
      e_x.store(frame.x), e_y.store(frame.y), e_z.store(frame.z);
      const auto tellAxis = [&](int k, const Pack& w_k) DYNWITNESS_INLINE_LAMBDA {
        auto& axes = ws.axes[(link.column + k) / kBlock];
        const int l = (link.column + k) % kBlock;
        axes.w_p.scatter(l, w_p);
        axes.wd_p.scatter(l, wd_p);
        axes.a_p.scatter(l, a);
        if (!axes.are_turns) axes.w_k.scatter(l, w_k);
      };
      const auto axisAt = [&](int k) -> auto& {
        return ws.axes[(link.column + k) / kBlock];
      };
      Pack w = w_p, wd = wd_p;
      if constexpr (isTurn(kStep)) {
        tellAxis(0, w_p);
        axisAt(0).z_w.scatter(link.column % kBlock, e_z);
        const T rate = qd[link.dof];
        w = w + rate * e_z;
        wd = wd + qdd[link.dof] * e_z + rate * cross(w_p, e_z);
      } else if constexpr (isSlide(kStep)) {
        tellAxis(0, w_p);
        axisAt(0).z_v.scatter(link.column % kBlock, e_z);
        const T twice = qd[link.dof] + qd[link.dof];
        const Pack v2_J = twice * e_z;
        a = a + cross(w_p, v2_J) + qdd[link.dof] * e_z;
        v2_J.store(frame.v2_J);
        body.v2_J.scatter(at, v2_J);
      } else {
        const auto J = jointMotion<Pack, T>(link, qd, qdd, e_x, e_y, e_z);
        w = w + J.w;
        for (int k = 0; k < link.axes; ++k) {
          tellAxis(k, link.axes == 1 ? w_p : w);
          Vec<T> v = Vec<T>::zero(), turn = Vec<T>::zero();
          addAlongAxis(link, k, T(1), v, turn);
          const int l = (link.column + k) % kBlock;
          axisAt(k).z_v.scatter(l, v.x * e_x + v.y * e_y + v.z * e_z);
          axisAt(k).z_w.scatter(l, turn.x * e_x + turn.y * e_y + turn.z * e_z);
          if (link.axes > 1) axisAt(k).v_J.scatter(l, J.v);
        }
        a = a + J.a + cross(w + w_p, J.v);
        wd = wd + J.wd + cross(w_p, J.w);
        (J.v + J.v).store(frame.v2_J);
        body.v2_J.scatter(at, J.v + J.v);
      }
      w.store(frame.w), wd.store(frame.wd), a.store(frame.a);
      body.e_x.scatter(at, e_x), body.e_y.scatter(at, e_y), body.e_z.scatter(at, e_z);
      body.w.scatter(at, w), body.wd.scatter(at, wd), body.a.scatter(at, a);
    });
  }
}

/// What the links of a pack alone are and need.
template <typename Pack, typename Bodies>
DYNWITNESS_INLINE void ownBodies(Bodies& b, bool are_turns, int lane) {
  const Vec<Pack> x = b.e_x.template load<Pack>(lane), y = b.e_y.template load<Pack>(lane),
                  z = b.e_z.template load<Pack>(lane), w = b.w.template load<Pack>(lane),
                  wd = b.wd.template load<Pack>(lane), a = b.a.template load<Pack>(lane);
  const Pack mass = Pack::load(b.mass + lane);
  const Vec<Pack> own = b.h.template load<Pack>(lane);
  const Vec<Pack> h = x * own.x + y * own.y + z * own.z;
  const Symmetric3<Pack> C = b.I.template load<Pack>(lane);
  const Vec<Pack> X = x * C.xx + y * C.xy + z * C.xz, Y = x * C.xy + y * C.yy + z * C.yz,
                  Z = x * C.xz + y * C.yz + z * C.zz;
  const Symmetric3<Pack> I = {X.x * x.x + Y.x * y.x + Z.x * z.x, X.y * x.y + Y.y * y.y + Z.y * z.y,
                              X.z * x.z + Y.z * y.z + Z.z * z.z, X.x * x.y + Y.x * y.y + Z.x * z.y,
                              X.x * x.z + Y.x * y.z + Z.x * z.z, X.y * x.z + Y.y * y.z + Z.y * z.z};
  const Vec<Pack> w_x_h = cross(w, h);
  b.f.store(a * mass + cross(wd, h) + cross(w, w_x_h), lane);
  b.n.store(times(I, wd) + cross(w, times(I, w)) + cross(h, a), lane);
  mass.store(b.m + lane);
  b.H.store(h, lane);
  b.J.store(I, lane);
  // 2 N = [w]x (tr I 1 - 2 I) + 2 v_J h', 2 P = 2 (m v_J + w x h)
  const Pack s_x = I.yy + I.zz - I.xx, s_y = I.xx + I.zz - I.yy, s_z = I.xx + I.yy - I.zz;
  const Pack xy = I.xy + I.xy, xz = I.xz + I.xz, yz = I.yz + I.yz;
  Vec<Pack> P2 = w_x_h + w_x_h;
  Vec<Pack> N_x = {w.z * xy - w.y * xz, -(w.z * s_y) - w.y * yz, w.y * s_z + w.z * yz};
  Vec<Pack> N_y = {w.z * s_x + w.x * xz, w.x * yz - w.z * xy, -(w.x * s_z) - w.z * xz};
  Vec<Pack> N_z = {-(w.y * s_x) - w.x * xy, w.x * s_y + w.y * xy, w.y * xz - w.x * yz};
  if (!are_turns) {
    const Vec<Pack> v2 = b.v2_J.template load<Pack>(lane);
    P2 = P2 + v2 * mass;
    N_x = N_x + h * v2.x, N_y = N_y + h * v2.y, N_z = N_z + h * v2.z;
  }
  b.P2.store(P2, lane);
  b.N_x.store(N_x, lane), b.N_y.store(N_y, lane), b.N_z.store(N_z, lane);
}

/// A vector in the axes of a lane's link, along the world's.
template <typename T, typename Bodies>
Vec<T> alongWorld(const Bodies& b, int at, const Vec<T>& v) {
  return b.e_x.at(at) * v.x + b.e_y.at(at) * v.y + b.e_z.at(at) * v.z;
}

template <typename T>
Mat<T> minusSkew(const Vec<T>& v) {
  return {T(0), v.z, -v.y, -v.z, T(0), v.x, v.y, -v.x, T(0)};
}
template <typename T>
Mat<T> sum(const Mat<T>& a, const Mat<T>& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yx + b.yx, a.yy + b.yy,
          a.yz + b.yz, a.zx + b.zx, a.zy + b.zy, a.zz + b.zz};
}
/// -[r]x [F]x = (r.F) 1 - F r'
template <typename T>
Mat<T> minusTwoSkews(const Vec<T>& r, const Vec<T>& F) {
  const T a = r.x * F.x, b = r.y * F.y, c = r.z * F.z;
  return {b + c,        -(F.x * r.y), -(F.x * r.z), -(F.y * r.x), a + c,
          -(F.y * r.z), -(F.z * r.x), -(F.z * r.y), a + b};
}

/// Loads off the links' wrenches, and how those in world axes turn with their links.
template <typename T, typename P>
void subtractLoads(const Plan<P>& plan, DerivativesWorkspace<T>& ws) {
  const auto subtract = [&](int i, const Vec<T>& force, const Vec<T>& moment) {
    auto& b = ws.bodies[ws.lanes[i] / kBlock];
    const int at = ws.lanes[i] % kBlock;
    b.f.set(at, b.f.at(at) - force);
    b.n.set(at, b.n.at(at) - moment);
  };
  const auto n = static_cast<int>(plan.links.size());
  for (int i = 0; i < n; ++i) {
    const Link<P>& link = plan.links[i];
    if (!link.is_loaded) continue;
    const auto& b = ws.bodies[ws.lanes[i] / kBlock];
    const int at = ws.lanes[i] % kBlock;
    subtract(i, alongWorld(b, at, in<T>(link.force)), alongWorld(b, at, in<T>(link.moment)));
  }
  for (auto& turned : ws.turned)
    turned = {Vec<T>::zero(), {T(0), T(0), T(0), T(0), T(0), T(0), T(0), T(0), T(0)}};
  for (const PlannedLoad<P>& load : plan.world_loads) {
    const int lane = ws.lanes[load.link];
    const Vec<T> r = alongWorld(ws.bodies[lane / kBlock], lane % kBlock, in<T>(load.at));
    const Vec<T> force = in<T>(load.force), moment = in<T>(load.moment);
    subtract(load.link, force, moment + cross(r, force));
    auto& turned = ws.turned[load.link + 1];
    turned.force = turned.force + force;
    turned.K = sum(turned.K, sum(minusSkew(moment), minusTwoSkews(r, force)));
  }
}

// ---- inward -------------------------------------------------------------------------------------

/// What is outboard of lane `from`, to that of another axis of the joint.
template <typename Bodies>
void copyBody(const Bodies& from, int a, Bodies& to, int b) {
  to.m[b] = from.m[a];
  to.J.set(b, from.J.at(a));
  for (auto part :
       {&Bodies::H, &Bodies::P2, &Bodies::N_x, &Bodies::N_y, &Bodies::N_z, &Bodies::f, &Bodies::n})
    (to.*part).set(b, (from.*part).at(a));
}

/// Onto what the parent sees of link i: a gyroscopic rotor that it carries, (13).
template <typename T, typename P>
void addRotor(const Link<P>& link, const typename DerivativesWorkspace<T>::Axes& axes, int l,
              const Vec<T>& z, const T* qd, const T* qdd, Vec<T>& moment, Vec<T>& N_x, Vec<T>& N_y,
              Vec<T>& N_z) {
  const Vec<T> L = z * (link.spin * qd[link.dof]);
  moment = moment + z * (link.spin * qdd[link.dof]) + cross(axes.w_p.at(l), L);
  N_x = N_x + Vec<T>{T(0), -L.z, L.y};
  N_y = N_y + Vec<T>{L.z, T(0), -L.x};
  N_z = N_z + Vec<T>{-L.y, L.x, T(0)};
}

/// All that is outboard of each joint as one body: (6).
template <typename T, typename P>
DYNWITNESS_INLINE void sumInward(const Plan<P>& plan, const T* qd, const T* qdd,
                                 DerivativesWorkspace<T>& ws) {
  const auto vec = [](const T* v) { return Vec<T>{v[0], v[1], v[2]}; };
  for (int i = static_cast<int>(plan.links.size()) - 1; i >= 0; --i) {
    const Link<P>& link = plan.links[i];
    const auto& b = ws.bodies[ws.lanes[i] / kBlock];
    const int at = ws.lanes[i] % kBlock;
    for (int k = 1; k < link.axes; ++k)
      copyBody(b, at, ws.bodies[(link.column + k) / kBlock], (link.column + k) % kBlock);
    if (link.parent == 0) continue;
    auto& to = ws.bodies[ws.lanes[link.parent - 1] / kBlock];
    const int there = ws.lanes[link.parent - 1] % kBlock;
    const auto& frame = ws.frames[i + 1];
    const T m = b.m[at];
    const Vec<T> h = b.H.at(at), P2 = b.P2.at(at), f = b.f.at(at), u2 = vec(frame.u2);
    Vec<T> n = b.n.at(at), h_A = h;
    Vec<T> N_x = b.N_x.at(at), N_y = b.N_y.at(at), N_z = b.N_z.at(at);
    Symmetric3<T> J = b.J.at(at);
    if (link.is_special)
      addRotor(link, ws.axes[link.column / kBlock], link.column % kBlock, vec(frame.z), qd, qdd, n,
               N_x, N_y, N_z);
    if (link.is_apart) {
      const Vec<T> p = vec(frame.p);
      shiftBack(p, m, h_A, J);
      N_x = N_x + p * P2.x, N_y = N_y + p * P2.y, N_z = N_z + p * P2.z;
      n = n + cross(p, f);
    }
    N_x = N_x + h_A * u2.x, N_y = N_y + h_A * u2.y, N_z = N_z + h_A * u2.z;
    to.m[there] = to.m[there] + m;
    to.H.add(there, h_A);
    to.J.add(there, J);
    to.P2.add(there, P2 + u2 * m);
    to.N_x.add(there, N_x), to.N_y.add(there, N_y), to.N_z.add(there, N_z);
    to.f.add(there, f), to.n.add(there, n);
    if (ws.turned.empty()) continue;
    const auto& turned = ws.turned[i + 1];
    auto& parent = ws.turned[link.parent];
    parent.force = parent.force + turned.force;
    parent.K = sum(parent.K, turned.K);
    if (link.is_apart) parent.K = sum(parent.K, minusTwoSkews(vec(frame.p), turned.force));
  }
}

/// What the axes of a pack make of what they move, in the frame that turns with it: (1) to (5)
/// and (7).
template <typename Pack, typename Axes, typename Bodies>
DYNWITNESS_INLINE void columnsOf(Axes& a, const Bodies& b, int lane) {
  const Vec<Pack> z = a.z_w.template load<Pack>(lane), w_p = a.w_p.template load<Pack>(lane),
                  wd_p = a.wd_p.template load<Pack>(lane), a_p = a.a_p.template load<Pack>(lane);
  const Vec<Pack> h = b.H.template load<Pack>(lane), P2 = b.P2.template load<Pack>(lane),
                  N_x = b.N_x.template load<Pack>(lane), N_y = b.N_y.template load<Pack>(lane),
                  N_z = b.N_z.template load<Pack>(lane);
  const Symmetric3<Pack> I = b.J.template load<Pack>(lane);
  const Pack m = Pack::load(b.m + lane), trace = N_x.x + N_y.y + N_z.z;
  const auto twiceCoriolis = [&](const Vec<Pack>& y) DYNWITNESS_INLINE_LAMBDA {
    return Vec<Pack>{y.x * trace - (N_x.x * y.x + N_x.y * y.y + N_x.z * y.z),
                     y.y * trace - (N_y.x * y.x + N_y.y * y.y + N_y.z * y.z),
                     y.z * trace - (N_z.x * y.x + N_z.y * y.y + N_z.z * y.z)};
  };
  const Vec<Pack> psi_w = cross(w_p, z), chi_w = cross(wd_p, z) + cross(w_p, psi_w);
  Vec<Pack> chi_v = cross(a_p, z), phi_w = psi_w + psi_w;
  Vec<Pack> F_f = cross(z, h), F_n = times(I, z);
  Vec<Pack> G = z * trace - (N_x * z.x + N_y * z.y + N_z * z.z);
  Vec<Pack> F_qd_f = cross(z, P2), F_qd_n = twiceCoriolis(z);
  if (!a.are_turns) {
    const Vec<Pack> z_v = a.z_v.template load<Pack>(lane), w_k = a.w_k.template load<Pack>(lane);
    const Vec<Pack> psi_v = cross(w_p, z_v);
    chi_v = chi_v + cross(wd_p, z_v) + cross(w_p, psi_v);
    const Vec<Pack> phi_v = psi_v + cross(a.v_J.template load<Pack>(lane), z) + cross(w_k, z_v);
    phi_w = psi_w + cross(w_k, z);
    F_f = F_f + z_v * m, F_n = F_n + cross(h, z_v);
    F_qd_f = F_qd_f + phi_v * m, F_qd_n = F_qd_n + cross(h, phi_v);
    G = G + cross(P2, z_v);
    a.phi_v.store(phi_v, lane);
  }
  a.psi_w.store(psi_w, lane), a.chi_v.store(chi_v, lane);
  a.chi_w.store(chi_w, lane), a.phi_w.store(phi_w, lane);
  a.F_f.store(F_f, lane), a.F_n.store(F_n, lane), a.G.store(G, lane);
  a.F_q_f.store(chi_v * m + cross(chi_w, h) + cross(psi_w, P2), lane);
  a.F_q_n.store(times(I, chi_w) + cross(h, chi_v) + twiceCoriolis(psi_w), lane);
  a.F_qd_f.store(F_qd_f + cross(phi_w, h), lane);
  a.F_qd_n.store(F_qd_n + times(I, phi_w), lane);
}

/// (12): what turning loads in world axes adds to the columns of link i, and to rows.
template <typename T, typename P>
void addTurnedLoads(const Plan<P>& plan, DerivativesWorkspace<T>& ws) {
  if (ws.turned.empty()) return;
  for (std::size_t i = 0; i < plan.links.size(); ++i) {
    const Link<P>& link = plan.links[i];
    const auto& turned = ws.turned[i + 1];
    for (int k = 0; k < link.axes; ++k) {
      auto& a = ws.axes[(link.column + k) / kBlock];
      const int l = (link.column + k) % kBlock;
      const Vec<T> z = a.z_w.at(l);
      a.F_q_f.add(l, cross(z, turned.force));
      a.F_q_n.add(l, times(turned.K, z));
      a.W.set(l, cross(turned.force, a.z_v.at(l)) + transposedTimes(turned.K, z));
    }
  }
}

/// Entries of the axes of a pack with themselves, of the joints that have one.
template <typename Pack, typename T>
DYNWITNESS_INLINE void writeDiagonal(const typename DerivativesWorkspace<T>::Axes& a,
                                     const ColumnBlock& block, int lane,
                                     const ForceDerivatives<T>& out) {
  const Vec<Pack> z = a.z_w.template load<Pack>(lane);
  Pack M = Pack::load(a.rotor + lane) + dot(z, a.F_n.template load<Pack>(lane));
  Pack q = Pack::load(a.stiffness + lane) + dot(z, a.F_q_n.template load<Pack>(lane));
  Pack qd = Pack::load(a.viscous + lane) + dot(z, a.F_qd_n.template load<Pack>(lane));
  if (!a.are_turns) {
    const Vec<Pack> z_v = a.z_v.template load<Pack>(lane);
    M = M + dot(z_v, a.F_f.template load<Pack>(lane));
    q = q + dot(z_v, a.F_q_f.template load<Pack>(lane));
    qd = qd + dot(z_v, a.F_qd_f.template load<Pack>(lane));
  }
  T of_M[Pack::kCount], of_q[Pack::kCount], of_qd[Pack::kCount];
  M.store(of_M), q.store(of_q), qd.store(of_qd);
  for (int l = 0; l < Pack::kCount; ++l) {
    if (lane + l < block.first_column - block.begin) continue;
    const std::size_t d = block.dofs[lane + l], to = d * (out.stride + 1);
    out.M[d * (out.M_stride + 1)] = of_M[l], out.dtau_dq[to] = of_q[l], out.dtau_dqd[to] = of_qd[l];
  }
}

/// Entries of the axes of a joint that has several, but for those with themselves.
template <typename T, typename P>
void writeSeveral(const Link<P>& link, const DerivativesWorkspace<T>& ws,
                  const ForceDerivatives<T>& out) {
  for (int k = 0; k < link.axes; ++k) {
    const auto& a = ws.axes[(link.column + k) / kBlock];
    const int l = (link.column + k) % kBlock;
    for (int j = 0; j < link.axes; ++j) {
      if (j == k) continue;
      const auto& by = ws.axes[(link.column + j) / kBlock];
      const int m = (link.column + j) % kBlock;
      const Vec<T> z_v = by.z_v.at(m), z_w = by.z_w.at(m);
      const std::size_t row = link.dof + j, column = link.dof + k, to = row * out.stride + column;
      out.M[row * out.M_stride + column] = dot(z_v, a.F_f.at(l)) + dot(z_w, a.F_n.at(l));
      out.dtau_dq[to] = dot(z_v, a.F_q_f.at(l)) + dot(z_w, a.F_q_n.at(l));
      out.dtau_dqd[to] = dot(z_v, a.F_qd_f.at(l)) + dot(z_w, a.F_qd_n.at(l));
    }
  }
}

/// (8): beyond the joint the wrench through it turns, too.
template <typename Pack, typename Axes, typename Bodies>
DYNWITNESS_INLINE void turnWrenches(Axes& a, const Bodies& b, int lane) {
  const Vec<Pack> z = a.z_w.template load<Pack>(lane), f = b.f.template load<Pack>(lane);
  Vec<Pack> moment = a.F_q_n.template load<Pack>(lane) + cross(z, b.n.template load<Pack>(lane));
  if (!a.are_turns) moment = moment + cross(a.z_v.template load<Pack>(lane), f);
  a.F_q_f.store(a.F_q_f.template load<Pack>(lane) + cross(z, f), lane);
  a.F_q_n.store(moment, lane);
}

/// (14): beyond the joint the carried rotor is felt.
template <typename T, typename P>
void addSpins(const Plan<P>& plan, DerivativesWorkspace<T>& ws) {
  if (!plan.has_specials) return;
  for (std::size_t i = 0; i < plan.links.size(); ++i) {
    const Link<P>& link = plan.links[i];
    if (!link.is_special) continue;
    const T* const e_z = ws.frames[i + 1].z;
    const Vec<T> spin = Vec<T>{e_z[0], e_z[1], e_z[2]} * link.spin;
    for (int k = 0; k < link.axes; ++k) {
      auto& a = ws.axes[(link.column + k) / kBlock];
      const int l = (link.column + k) % kBlock;
      const Vec<T> carried = cross(a.w_p.at(l), spin);
      a.F_n.add(l, spin);
      a.F_qd_n.add(l, carried);
      a.G.add(l, carried);
    }
  }
}

/// The columns of a pack on their way to the world.
template <typename Pack, typename T>
struct Carried {
  Vec<Pack> f, n, f_q, n_q, f_qd, n_qd, G, W;

  template <typename Axes>
  DYNWITNESS_INLINE Carried(const Axes& a, int first, int lane)
      : n(a.F_n.template load<Pack>(lane)),
        n_q(a.F_q_n.template load<Pack>(lane)),
        n_qd(a.F_qd_n.template load<Pack>(lane)),
        G(a.G.template load<Pack>(lane)),
        W(a.W.template load<Pack>(lane)) {
    join(a, first, lane);
  }
  /// Columns join: the forces of those inboard are left out, and their moments stay what they were.
  template <typename Axes>
  DYNWITNESS_INLINE void join(const Axes& a, int first, int lane) {
    f = a.F_f.template loadFrom<Pack>(first, lane);
    f_q = a.F_q_f.template loadFrom<Pack>(first, lane);
    f_qd = a.F_qd_f.template loadFrom<Pack>(first, lane);
  }
  DYNWITNESS_INLINE void shift(const T* p) {
    n = n + crossed(p, f);
    n_q = n_q + crossed(p, f_q);
    n_qd = n_qd + crossed(p, f_qd);
  }
  DYNWITNESS_INLINE void pass(const T* u2) { G = G + crossed(u2, f); }

 private:
  static DYNWITNESS_INLINE Vec<Pack> crossed(const T* p, const Vec<Pack>& f) {
    return {p[1] * f.z - p[2] * f.y, p[2] * f.x - p[0] * f.z, p[0] * f.y - p[1] * f.x};
  }
};

/// Entries of a block's columns with one axis inboard.
template <typename Pack, typename T>
struct Entries {
  const ColumnBlock& block;
  int d;             ///< of the axis
  int first_column;  ///< that has joined
  int lane;          ///< of the block, where the pack begins

  DYNWITNESS_INLINE bool isWhole() const {
    return Pack::kCount == kBlock && block.first_dof >= 0 && first_column <= block.begin;
  }
  template <typename Put>
  void each(const Pack& entries, const Put& put) const {
    T values[Pack::kCount];
    entries.store(values);
    const int first = std::max(block.first_column, first_column) - block.begin;
    for (int k = std::max(first - lane, 0); k < Pack::kCount; ++k)
      put(static_cast<std::size_t>(block.dofs[lane + k]), values[k]);
  }
  /// In the axis's row ...
  DYNWITNESS_INLINE void across(T* matrix, std::size_t stride, const Pack& entries) const {
    T* const row = matrix + d * stride;
    if (isWhole()) return entries.store(row + block.first_dof);
    each(entries, [&](std::size_t to, const T& value) { row[to] = value; });
  }
  /// ... and in its column.
  DYNWITNESS_INLINE void down(T* matrix, std::size_t stride, const Pack& entries) const {
    T* const column = matrix + d;
    if constexpr (Pack::kCount == kBlock)
      if (isWhole()) return entries.scatter(column + block.first_dof * stride, stride);
    each(entries, [&](std::size_t to, const T& value) { column[to * stride] = value; });
  }
};

/// What an axis does to all that is outboard.
enum class Axis { kTurns, kSlides, kTurnsAmongSeveral, kTurnsAndSlides };

/// (9), (10) and (11) with one axis, lane l of a block.
/// @param is_first  its joint is on the world: nothing turns inboard of it
template <Axis kAxis, typename Pack, typename T>
DYNWITNESS_INLINE void writeEntries(const Entries<Pack, T>& to, const Carried<Pack, T>& c,
                                    const typename DerivativesWorkspace<T>::Axes& a, int l,
                                    bool is_first, bool has_world_loads,
                                    const ForceDerivatives<T>& out) {
  const auto along = [&](const Wide3<T>& v, const Vec<Pack>& by) DYNWITNESS_INLINE_LAMBDA {
    return v.x[l] * by.x + v.y[l] * by.y + v.z[l] * by.z;
  };
  Pack M, q, qd, row_q = along(a.chi_v, c.f), row_qd;
  if constexpr (kAxis != Axis::kSlides) {
    M = along(a.z_w, c.n), q = along(a.z_w, c.n_q), qd = along(a.z_w, c.n_qd);
    if (!is_first) row_q = row_q + along(a.chi_w, c.n) + along(a.psi_w, c.G);
    if (has_world_loads) row_q = row_q + along(a.z_w, c.W);
    row_qd = along(a.phi_w, c.n) + along(a.z_w, c.G);
    if constexpr (kAxis != Axis::kTurns) row_qd = row_qd + along(a.phi_v, c.f);
  } else {
    M = along(a.z_v, c.f), q = along(a.z_v, c.f_q), qd = along(a.z_v, c.f_qd);
    row_qd = along(a.phi_v, c.f);
  }
  if constexpr (kAxis == Axis::kTurnsAndSlides)
    M = M + along(a.z_v, c.f), q = q + along(a.z_v, c.f_q), qd = qd + along(a.z_v, c.f_qd);
  to.across(out.M, out.M_stride, M), to.down(out.M, out.M_stride, M);
  to.across(out.dtau_dq, out.stride, q), to.down(out.dtau_dq, out.stride, row_q);
  to.across(out.dtau_dqd, out.stride, qd), to.down(out.dtau_dqd, out.stride, row_qd);
}

/// A pack of a block inward: what the joints on the way to the world feel of its columns, and it of
/// them.
template <typename Pack, typename T, typename P>
DYNWITNESS_INLINE void carryInward(const Plan<P>& plan, const ColumnBlock& block, int lane,
                                   const DerivativesWorkspace<T>& ws,
                                   const ForceDerivatives<T>& out) {
  const bool has_world_loads = !ws.turned.empty();
  const auto& own = ws.axes[block.begin / kBlock];
  const Link<P>* const links = plan.links.data();
  const auto* const frames = ws.frames.data();
  const auto* const all_axes = ws.axes.data();
  int record = block.last_link + 1;
  Carried<Pack, T> carried(own, links[record - 1].column - block.begin, lane);
  while (links[record - 1].parent > 0) {
    const Link<P>& link = links[record - 1];
    const auto& frame = frames[record];
    record = link.parent;
    const Link<P>& next = links[record - 1];
    if (link.is_apart) carried.shift(frame.p);
    if (link.is_apart || !isTurn(next.step)) carried.pass(frame.u2);
    const bool joined = Pack::kCount == kBlock || link.column <= block.begin + lane;
    for (int l = 0; joined && l < next.axes; ++l) {
      const Entries<Pack, T> to{block, next.dof + l, link.column, lane};
      const auto& axes = all_axes[(next.column + l) / kBlock];
      const int of_axis = (next.column + l) % kBlock;
      const auto write = [&](auto axis) DYNWITNESS_INLINE_LAMBDA {
        writeEntries<decltype(axis)::value>(to, carried, axes, of_axis, next.parent == 0,
                                            has_world_loads, out);
      };
      if (isTurn(next.step))
        write(std::integral_constant<Axis, Axis::kTurns>());
      else if (isSlide(next.step) || (next.kind == JointKind::kFloating && l < 3))
        write(std::integral_constant<Axis, Axis::kSlides>());
      else if (next.axes > 1)
        write(std::integral_constant<Axis, Axis::kTurnsAmongSeveral>());
      else
        write(std::integral_constant<Axis, Axis::kTurnsAndSlides>());
    }
    if (next.column + next.axes > block.begin) carried.join(own, next.column - block.begin, lane);
  }
}

/// Zeros where joints do not feel each other.
template <typename T, typename P>
void clear(const Plan<P>& plan, const ForceDerivatives<T>& out) {
  const std::size_t n = plan.dof;
  if (plan.is_chain) return;  // there are none
  for (T* const matrix : {out.dtau_dq, out.dtau_dqd, out.M}) std::fill_n(matrix, n * n, T(0));
}

/// Writes what is not zero by nature.
/// @tparam Pack    of the components of a vector
/// @tparam Column  of links and columns side by side
template <typename Pack, typename Column = Pack, typename T, typename P>
DYNWITNESS_INLINE void inverseDynamicsDerivativesBody(const Plan<P>& plan,
                                                      const JointPosition<T>* x, const T* qd,
                                                      const T* qdd, DerivativesWorkspace<T>& ws,
                                                      const ForceDerivatives<T>& out) {
  const std::size_t blocks = plan.blocks.size();
  const auto forColumns = [&](const auto& f) DYNWITNESS_INLINE_LAMBDA {
    for (std::size_t b = 0; b < blocks; ++b)
      forEachLane<Column>(plan.blocks[b].first_column - plan.blocks[b].begin,
                          [&](int lane) DYNWITNESS_INLINE_LAMBDA {
                            f(plan.blocks[b], ws.axes[b], ws.bodies[b], lane);
                          });
  };
  using Axes = typename DerivativesWorkspace<T>::Axes;
  using Bodies = typename DerivativesWorkspace<T>::Bodies;
  moveOutward<Pack>(plan, x, qd, qdd, ws);
  for (std::size_t b = 0; b < ws.bodies.size(); ++b)
    forEachLane<Column>(0, [&](int lane) DYNWITNESS_INLINE_LAMBDA {
      ownBodies<Column>(ws.bodies[b], b < blocks && ws.axes[b].are_turns, lane);
    });
  subtractLoads(plan, ws);
  sumInward(plan, qd, qdd, ws);
  forColumns([&](const ColumnBlock&, Axes& a, const Bodies& b, int lane)
                 DYNWITNESS_INLINE_LAMBDA { columnsOf<Column>(a, b, lane); });
  addTurnedLoads(plan, ws);
  forColumns([&](const ColumnBlock& block, Axes& a, const Bodies&, int lane)
                 DYNWITNESS_INLINE_LAMBDA { writeDiagonal<Column, T>(a, block, lane, out); });
  for (const int i : ws.several) writeSeveral(plan.links[i], ws, out);
  forColumns([&](const ColumnBlock&, Axes& a, const Bodies& b, int lane)
                 DYNWITNESS_INLINE_LAMBDA { turnWrenches<Column>(a, b, lane); });
  addSpins(plan, ws);
  forColumns([&](const ColumnBlock& block, const Axes&, const Bodies&, int lane)
                 DYNWITNESS_INLINE_LAMBDA { carryInward<Column>(plan, block, lane, ws, out); });
}

DYNWITNESS_FOR_AVX2 inline void inverseDynamicsDerivativesForAvx2(
    const Plan<double>& plan, const JointPosition<double>* x, const double* qd, const double* qdd,
    DerivativesWorkspace<double>& ws, const ForceDerivatives<double>& out) {
  inverseDynamicsDerivativesBody<Quad>(plan, x, qd, qdd, ws, out);
}

}  // namespace detail

/** Derivatives of tau at a state by q, qd and qdd, n x n each, in O(n depth), loads, springs and
    friction included; the functions of recursive::inverseDynamicsDerivatives, and its conventions:
    along q everything outboard of a joint moves by its axis Z = (z_v, z_w) for a unit of time,
    where rates are no derivatives of coordinates (spherical, floating) along the body's own axes.

    The road is another one: particles instead of spatial vectors, along the world's axes about each
    link's origin, and no linear velocity but between neighbours. Everything outboard of joint k is
    told in the inertial frame that moves, at this instant, with the parent's body point at the
    joint; forces are the same there. Move by Z, and look from axes that turn with Z: what is
    outboard stays as it was, and the motion that arrives from the parent (w_p, w'_p, and a_p of
    that point) comes from elsewhere:
        (1)  psi = (w_p x z_v, w_p x z_w)                           dv/dq of what is outboard
        (2)  chi = (a_p x z_w + w'_p x z_v + w_p x psi_v,  w'_p x z_w + w_p x psi_w)
        (3)  phi = psi + (v_J x z_w + w_k x z_v,  w_k x z_w)        by qd, where Z is dv/dqd
    v_J the joint's own linear velocity, w_k = w_p + its own turn; of one axis phi = 2 psi. A
    particle at r from the joint, with velocity v, then accelerates by Coriolis' acceleration more:
        (4)  da/dq = chi_v + chi_w x r + 2 psi_w x v,     da/dqd = phi_v + phi_w x r + 2 z_w x v
    Summed over all that is outboard, with its mass m, h = int r, I, and
        (5)  P = int v,   N = int v r',   2 B y = (2 y x P,  2 (tr N - N) y)
    of rigid links v = v_J + w x r gives P = m v_J + w x h,  2 N = [w]x (tr I - 2 I) + 2 v_J h'.
    From a joint to the one inboard of its parent, r becomes r + p and v becomes v + u, u = w_p x p
    + v_J of the parent:
        (6)  h += m p,  P += m u,  N += P p' + u (h + m p)',  I as ever
        (7)  F = (m z_v + z_w x h, I z_w + h x z_v)                         by qdd
             F_q  = (m chi_v + chi_w x h, I chi_w + h x chi_v) + 2 B psi_w
             F_qd = (m phi_v + phi_w x h, I phi_w + h x phi_v) + 2 B z_w
        (8)  beyond joint k, F_q + Z x* f: the wrench through it turns, too
        (9)  column k, an axis inboard:  dtau_j/dq_k = Z_j' F_q,  dtau_j/dqd_k = Z_j' F_qd
       (10)  row k, work of (4) along Z:
             dtau_k/dq_j = F' chi_j + G' psi_j,   dtau_k/dqd_j = F' phi_j + G' z_j,
             G = 2 int v x (z_v + z_w x r) = 2 P x z_v + 2 (tr N - N') z_w,   G += 2 u x F_f inward
       (11)  M_jk = M_kj = Z_j' F
    A load F at r with a moment in world axes is turned back as its link turns:
       (12)  K = -[n]x - [r]x [F]x summed,   F_q += (z_w x F, K z_w),
             dtau_k/dq_j += z_j' (F x z_v + K' z_w)
    A gyroscopic rotor of h_r that the parent carries, with L = h_r qd z:
       (13)  beyond joint k:  n += h_r z qdd + w_p x L,   2 N += [L]x
       (14)  F_n += h_r z,   F_qd_n += w_p x h_r z,   G += w_p x h_r z
    Rotors, springs and viscous friction stand on the diagonal.

    @param x, qd, qdd  as inverseDynamics() takes them, trusted to be as long as there
    @param out         n x n each, all strides n, written whole; M symmetric
    @see J. Carpentier and N. Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms,
      Robotics: Science and Systems (2018); S. Singh, R. Russell, P. Wensing, Efficient Analytical
      Derivatives of Rigid-Body Dynamics using Spatial Vector Algebra, IEEE RA-L 7 (2022) */
template <typename T>
void inverseDynamicsDerivatives(const Plan<T>& plan, const JointPosition<T>* x, const T* qd,
                                const T* qdd, DerivativesWorkspace<T>& ws,
                                const ForceDerivatives<T>& out) {
  detail::clear(plan, out);
  if constexpr (std::is_same_v<T, double>) {
    if (kHasAvx2) return detail::inverseDynamicsDerivativesForAvx2(plan, x, qd, qdd, ws, out);
    detail::inverseDynamicsDerivativesBody<TwoPairs>(plan, x, qd, qdd, ws, out);
  } else {
    detail::inverseDynamicsDerivativesBody<Lanes<T>>(plan, x, qd, qdd, ws, out);
  }
}

}  // namespace dynwitness::recursive::fast
