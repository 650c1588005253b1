// SPDX-License-Identifier: Apache-2.0
// Forward dynamics by articulated-body sweeps where joints follow others or rotors are geared to
// several rates.
#pragma once

#include <algorithm>
#include <vector>

#include "recursive/articulated_step.hpp"
#include "recursive/composite_body.hpp"

namespace dynwitness::recursive::detail {

/// A rate that several joints share, or that a rotor couples to the other rates of its joint, on
/// its way inward: what it does waits until all of them are passed.
template <typename T>
struct SharedRate {
  int rate;
  int ancestor;  ///< the last link (-1: the world) that all its joints hang on
  T u = T(0);    ///< force left for acceleration
  std::vector<Force<T>>
      F;  ///< by link: the force that a unit of the rate's acceleration asks for there
};

/// The shared rates of a model, and by link those that wait there.
template <typename T>
std::vector<SharedRate<T>> sharedRates(const Model<T>& model, std::vector<int>& of_rate,
                                       std::vector<std::vector<int>>& waiting) {
  const int n = static_cast<int>(model.links.size());
  std::vector<int> depth(n);
  for (int i = 0; i < n; ++i)
    depth[i] = model.links[i].parent < 0 ? 0 : depth[model.links[i].parent] + 1;
  const auto common = [&](int a, int b) {
    while (a != b) {
      int& deeper = b < 0 || (a >= 0 && depth[a] > depth[b]) ? a : b;
      deeper = model.links[deeper].parent;
    }
    return a;
  };
  std::vector<SharedRate<T>> shared;
  of_rate.assign(model.dof(), -1);
  for (const LinkModel<T>& link : model.links)
    if (link.follows && of_rate[link.dof] < 0) {
      of_rate[link.dof] = static_cast<int>(shared.size());
      const int leader = model.link_of_dof[link.dof];
      shared.push_back(
          {link.dof, model.links[leader].parent, T(0), std::vector<Force<T>>(n, Force<T>::zero())});
    }
  for (const GearedRotor<T>& rotor : model.rotors)
    for (int rate = rotor.dof; rate < rotor.dof + static_cast<int>(rotor.ratio.size()); ++rate) {
      if (of_rate[rate] >= 0) continue;  // of another rotor of the joint
      of_rate[rate] = static_cast<int>(shared.size());
      const int first = model.link_of_dof[rotor.dof];  // of the joint's chain
      shared.push_back(
          {rate, model.links[first].parent, T(0), std::vector<Force<T>>(n, Force<T>::zero())});
    }
  for (const LinkModel<T>& link : model.links)
    if (link.follows) {
      int& ancestor = shared[of_rate[link.dof]].ancestor;
      ancestor = common(ancestor, link.parent);
    }
  waiting.assign(n, {});
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    std::vector<int>& here = waiting[i];
    for (int k = 0; k < axisCount(link.kind); ++k)
      if (of_rate[link.dof + k] >= 0) here.push_back(of_rate[link.dof + k]);
    std::sort(here.begin(), here.end());
    here.erase(std::unique(here.begin(), here.end()), here.end());
    if (link.parent < 0) continue;
    for (const int g : here)
      if (shared[g].ancestor != link.parent) waiting[link.parent].push_back(g);
  }
  return shared;
}

/** forwardDynamics() of a model with followers or geared rotors. The steps are those of
    articulated_body.hpp; only a rate y that several joints share cannot be solved for where one of
    them is passed. It is carried inward as an unknown: with F the force that a unit of y asks of a
    link, all links obey

        (1)  f = M_A a + f_A + sum of F_g y_g          each rate g:  F_g' a + sum of D_gh y_h = u_g

    (the same F twice: that is the symmetry of M). Passing a joint of g itself, with axis k Z,
        (2)  D_gg += d + 2 k Z'F_g + k Z' M_A k Z,   D_gh += k Z'F_h,   u_g -= k Z'f_A + ...,
             F_g += M_A k Z
    and past any other joint, which is solved for (U, D, u as there, e_h = Z'F_h),
        (3)  F_h -= U e_h / D,   D_gh -= e_g e_h / D,   u_h -= e_h u / D
    and past all of them  u_h -= F_h' c_i.  At the link that all joints of g hang on, nothing of y_g
    is left outboard, and it is solved for as a joint is:
        (4)  M_A -= F_g F_g' / D_gg,   f_A += F_g u_g / D_gg,   F_h -= F_g D_gh / D_gg,   ...
        (5)  y_g = (u_g - F_g' a - sum of D_gh y_h) / D_gg      once a is known, on the way outward
    A rotor geared to the rates g, h of a joint, psi' = n'nu, on the link p that carries it, adds
        (6)  D_gh += J n_g n_h,   F_g of p += n_g (0, J a),   f_A of p += (0, w_p x J psi' a)
    So it divides by what the joints of a rate move together; one of them alone may move nothing.
    O(n) for followers close to their leaders. Allocates. */
template <typename T>
void coupledForwardDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                            const std::vector<T>& qd, const std::vector<T>& tau, Workspace<T>& ws,
                            std::vector<T>& qdd, Terms terms) {
  const int n = static_cast<int>(model.links.size());
  ArticulatedSteps<AnyJoints, T> step(model, x, qd, terms, ws);
  std::vector<int> of_rate;
  std::vector<std::vector<int>> waiting;
  std::vector<SharedRate<T>> shared = sharedRates(model, of_rate, waiting);
  const int count = static_cast<int>(shared.size());
  MatrixX<T> D = MatrixX<T>::Constant(count, count, T(0));
  MatrixX<T> e = MatrixX<T>::Constant(model.dof(), count, T(0));
  for (SharedRate<T>& g : shared) g.u = tau[g.rate];

  // outward: velocities, and what each link alone brings
  step.start();
  for (const GearedRotor<T>& rotor : model.rotors) {  // (6)
    const int p = rotor.carrier;
    for (std::size_t k = 0; k < rotor.ratio.size(); ++k) {
      const int g = of_rate[rotor.dof + k];
      for (std::size_t l = 0; l < rotor.ratio.size(); ++l)
        D(g, of_rate[rotor.dof + l]) += rotor.ratio[k] * rotor.ratio[l] * rotor.inertia;
      if (p >= 0) shared[g].F[p] = shared[g].F[p] + spinAxis(rotor) * rotor.ratio[k];
    }
    if (p >= 0) ws.f[p] = ws.f[p] + spinForce(rotor, rotorRate(rotor, qd), T(0), ws.v[p]);
  }

  // (4) at link i, -1: the world, which takes any force
  std::vector<int> order;  // in which shared rates were solved for
  const auto solveFor = [&](int g, int i) {
    SharedRate<T>& of = shared[g];
    const T inverse = T(1) / D(g, g);
    ws.D[of.rate] = D(g, g);
    order.push_back(g);
    if (i >= 0) {
      ws.M_A[i] = ws.M_A[i].minusOuter(of.F[i], inverse);
      ws.f[i] = ws.f[i] + of.F[i] * (of.u * inverse);
    }
    std::vector<int> rest;
    for (int h = 0; h < count; ++h)
      if (std::find(order.begin(), order.end(), h) == order.end()) rest.push_back(h);
    for (const int h : rest) {
      const T share = D(g, h) * inverse;
      if (i >= 0) shared[h].F[i] = shared[h].F[i] - of.F[i] * share;
      shared[h].u -= share * of.u;
      for (const int k : rest) D(h, k) -= share * D(g, k);
    }
  };

  // inward: what each link feels of its subtree
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    for (int g = 0; g < count; ++g)
      if (shared[g].ancestor == i) solveFor(g, i);
    ArticulatedBody<T> body = step.body(i);
    for (int k = 0, d = link.dof; k < AnyJoints::axes(link); ++k, ++d) {
      const int own = of_rate[d];
      step.formEquation(i, k, d, own < 0 ? tau[d] : T(0), body);
      for (const int h : waiting[i]) e(d, h) = AnyJoints::force(link, k, shared[h].F[i]);
      if (own >= 0) {  // (2)
        D(own, own) += ws.D[d] + e(d, own) + e(d, own);
        for (const int h : waiting[i]) {
          if (h == own) continue;
          D(own, h) += e(d, h);
          D(h, own) += e(d, h);
        }
        shared[own].u += ws.u[d];
        shared[own].F[i] = shared[own].F[i] + ws.U[d];
        continue;
      }
      const T inverse = T(1) / ws.D[d];
      for (const int h : waiting[i]) {  // (3)
        const T share = e(d, h) * inverse;
        shared[h].F[i] = shared[h].F[i] - ws.U[d] * share;
        shared[h].u -= share * ws.u[d];
        for (const int l : waiting[i]) D(h, l) -= share * e(d, l);
      }
      step.project(d, body);
    }
    for (const int h : waiting[i]) {
      SharedRate<T>& of = shared[h];
      of.u -= dot(ws.c[i], of.F[i]);
      if (link.parent < 0)
        of.u -= dot(step.carried(i), of.F[i]);
      else
        of.F[link.parent] = of.F[link.parent] + ws.X_up[i].inverseTimes(of.F[i]);
    }
    step.handOn(i, body);
  }
  for (int g = 0; g < count; ++g)
    if (shared[g].ancestor < 0) solveFor(g, -1);

  // outward: accelerations
  std::vector<char> known(count, 0);
  const auto settle = [&](int i) {  // (5)
    for (auto g = order.rbegin(); g != order.rend(); ++g) {
      const SharedRate<T>& of = shared[*g];
      if (of.ancestor != i) continue;
      T u = of.u;
      if (i >= 0) u -= dot(ws.a[i], of.F[i]);
      for (int h = 0; h < count; ++h)
        if (known[h]) u -= D(*g, h) * qdd[shared[h].rate];
      qdd[of.rate] = u / D(*g, *g);
      known[*g] = 1;
    }
  };
  settle(-1);
  for (int i = 0; i < n; ++i) {
    step.accelerate(i, qdd, [&](int d) {
      if (of_rate[d] >= 0) return qdd[d];
      T u = ws.u[d];
      for (const int h : waiting[i]) u -= e(d, h) * qdd[shared[h].rate];
      return step.acceleration(i, d, u);
    });
    settle(i);
  }
}

}  // namespace dynwitness::recursive::detail
