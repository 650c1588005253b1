// SPDX-License-Identifier: Apache-2.0
// What the fast sweep of derivatives writes on: links and axes of joints four side by side.
#pragma once

#include <vector>

#include "recursive/fast/plan.hpp"
#include "recursive/fast/wide_vectors.hpp"

namespace dynwitness::recursive::fast {

/// Where derivatives of tau go, row i of tau_i.
template <typename T>
struct ForceDerivatives {
  T *dtau_dq, *dtau_dqd;
  std::size_t stride;  ///< numbers from one row to the next ...
  T* M;
  std::size_t M_stride;  ///< ... and of M
};

/// What the sweep writes on, sized once for a plan. Links stand in the lanes of their joints' first
/// columns, four a block; links without a joint in blocks after these.
template <typename T>
struct DerivativesWorkspace {
  template <typename P>
  explicit DerivativesWorkspace(const Plan<P>& plan);

  static constexpr std::size_t kAlignment = alignof(T) > 32 ? alignof(T) : 32;

  /// How a link moves: along the world's axes, three numbers and one that pads.
  struct Frame {
    T x[kBlock], y[kBlock], z[kBlock];  ///< its own axes
    T p[kBlock];                        ///< from the parent's origin to its own
    T u2[kBlock];                       ///< twice the velocity u of (6)
    T v2_J[kBlock];                     ///< twice its joint's linear velocity
    T w[kBlock], wd[kBlock], a[kBlock];
  };
  /// Four links; constants in their own axes first.
  struct alignas(kAlignment) Bodies {
    T mass[kBlock];
    Wide3<T> h;
    Wide6<T> I;
    Wide3<T> e_x, e_y, e_z, w, wd, a, v2_J;
    // all that is outboard, the link included, along the world's axes about its origin
    T m[kBlock];
    Wide3<T> H;
    Wide6<T> J;
    Wide3<T> P2, N_x, N_y, N_z;  ///< 2 P and the rows of 2 N
    Wide3<T> f, n;               ///< wrench through the joint
  };
  /// Four axes of joints.
  struct alignas(kAlignment) Axes {
    T rotor[kBlock], stiffness[kBlock], viscous[kBlock];
    Wide3<T> z_v, z_w;        ///< axis
    Wide3<T> w_p, wd_p, a_p;  ///< the parent's motion there
    Wide3<T> w_k, v_J;        ///< of (3); of joints of one axis w_p and 0
    Wide3<T> psi_w, chi_v, chi_w, phi_v, phi_w;
    Wide3<T> F_f, F_n, F_q_f, F_q_n, F_qd_f, F_qd_n, G;
    Wide3<T> W;             ///< of loads in world axes
    bool are_turns = true;  ///< z_v is zero, and so is phi_v
  };
  /// How the loads in world axes of a link and all outboard change as it turns.
  struct Turned {
    Vec<T> force;
    Mat<T> K;
  };

  std::vector<int> lanes;     ///< of the links
  std::vector<Frame> frames;  ///< the first is the world
  std::vector<Bodies> bodies;
  std::vector<Axes> axes;
  std::vector<Turned> turned;  ///< empty: there are no such loads
  std::vector<int> several;    ///< links whose joints have several axes
  OtherJoints<T> others;
};

template <typename T>
template <typename P>
DerivativesWorkspace<T>::DerivativesWorkspace(const Plan<P>& plan)
    : frames(plan.links.size() + 1),
      axes(plan.blocks.size()),
      turned(plan.world_loads.empty() ? 0 : plan.links.size() + 1),
      others(plan) {
  int lane = static_cast<int>(plan.blocks.size()) * kBlock;
  for (const Link<P>& link : plan.links) lanes.push_back(link.axes > 0 ? link.column : lane++);
  bodies.resize((static_cast<std::size_t>(lane) + kBlock - 1) / kBlock);
  for (Frame& frame : frames) frame = {};
  for (Bodies& block : bodies) block = {};
  for (Axes& block : axes) block = {};
  Frame& world = frames[0];
  world.x[0] = world.y[1] = world.z[2] = T(1);
  world.a[0] = -plan.gravity.x, world.a[1] = -plan.gravity.y, world.a[2] = -plan.gravity.z;
  for (std::size_t i = 0; i < plan.links.size(); ++i) {
    const Link<P>& link = plan.links[i];
    Bodies& block = bodies[lanes[i] / kBlock];
    const int at = lanes[i] % kBlock;
    block.mass[at] = link.mass;
    block.h.set(at, in<T>(link.h));
    block.I.set(at, in<T>(link.I));
    if (link.axes > 1) several.push_back(static_cast<int>(i));
    for (int k = 0; k < link.axes; ++k) {
      Axes& of = axes[(link.column + k) / kBlock];
      const int l = (link.column + k) % kBlock;
      of.are_turns = of.are_turns && isTurn(link.step);
      of.rotor[l] = link.rotor;
      if (k == 0) of.stiffness[l] = link.stiffness, of.viscous[l] = link.viscous;
    }
  }
}

}  // namespace dynwitness::recursive::fast
