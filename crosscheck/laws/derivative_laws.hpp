// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of derivatives: sweeps of their own against the other sweeps on dual numbers.
#pragma once

#include <algorithm>

#include "crosscheck/laws/swept_mechanism.hpp"

namespace dynwitness::crosscheck {

namespace detail {

/// Whether g is the gradient of a function of coordinates, and c made of its Christoffel symbols.
inline bool ratesAreDerivatives(const scene::Mechanism& mechanism) {
  return std::all_of(mechanism.links.begin(), mechanism.links.end(), [](const scene::Link& link) {
    return scene::ratesArePositionDerivatives(link.joint.kind);
  });
}

}  // namespace detail

struct ForcesByPosition : Law {
  static constexpr LawWords kWords = {"joint forces by position", "(dtau/dq) u = d tau(q + s u)/ds",
                                      "dtau/dq", "derivatives", "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const std::vector<T>& u = at.anyDirection();
    return {at.ofInverse().dtau_dq * at.column(u), at.tauRate({u, {}, {}, {}})};
  }
};

struct ForcesByRate : Law {
  static constexpr LawWords kWords = {"joint forces by rate", "(dtau/dqd) u = d tau(qd + s u)/ds",
                                      "dtau/dqd", "derivatives", "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const std::vector<T>& u = at.anyDirection();
    return {at.ofInverse().dtau_dqd * at.column(u), at.tauRate({{}, u, {}, {}})};
  }
};

struct ForcesByAcceleration : Law {
  static constexpr LawWords kWords = {"joint forces by acceleration", "dtau/dqdd = M", "M",
                                      "derivatives", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    return {at.ofInverse().M, at.M()};
  }
};

struct AccelerationsByPosition : Law {
  static constexpr LawWords kWords = {"accelerations by position",
                                      "(dqdd/dq) u = d qdd(q + s u)/ds", "dqdd/dq", "derivatives",
                                      "articulated_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const std::vector<T>& u = at.anyDirection();
    return {at.ofForward().dqdd_dq * at.column(u), at.qddRate({u, {}, {}, {}})};
  }
};

struct AccelerationsByRate : Law {
  static constexpr LawWords kWords = {"accelerations by rate", "(dqdd/dqd) u = d qdd(qd + s u)/ds",
                                      "dqdd/dqd", "derivatives", "articulated_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const std::vector<T>& u = at.anyDirection();
    return {at.ofForward().dqdd_dqd * at.column(u), at.qddRate({{}, u, {}, {}})};
  }
};

struct AccelerationsByForce : Law {
  static constexpr LawWords kWords = {"accelerations by force",
                                      "(dqdd/dtau) u = d qdd(tau + s u)/ds", "dqdd/dtau",
                                      "derivatives", "articulated_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const std::vector<T>& u = at.anyDirection();
    return {at.ofForward().dqdd_dtau * at.column(u), at.qddRate({{}, {}, {}, u})};
  }
};

/// Weights and springs have a potential, whose second derivatives these are.
struct SymmetricGravityGradient : Law {
  static constexpr LawWords kWords = {"symmetric gradient of gravity", "dg/dq = (dg/dq)'", "dg/dq",
                                      "derivatives", ""};
  static bool appliesTo(const scene::Mechanism& mechanism) {
    return detail::ratesAreDerivatives(mechanism);
  }
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const recursive::MatrixX<T> K = at.stiffness();
    return {K, K.transpose()};
  }
};

/// c = C qd is quadratic in qd, with a C that is symmetric in the rates that it multiplies.
struct CoriolisByRate : Law {
  static constexpr LawWords kWords = {"Coriolis forces by rate", "dtau/dqd - friction = 2 C",
                                      "dtau/dqd", "derivatives", "composite_body"};
  static bool appliesTo(const scene::Mechanism& mechanism) {
    return detail::ratesAreDerivatives(mechanism);
  }
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    recursive::MatrixX<T> by_rate = at.ofInverse().dtau_dqd;
    for (const recursive::LinkModel<T>& link : at.model().links)
      if (link.dof >= 0) by_rate(link.dof, link.dof) -= link.viscous;
    return {by_rate, at.C() * T(2)};
  }
};

}  // namespace dynwitness::crosscheck
