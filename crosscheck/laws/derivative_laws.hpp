// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of derivatives, by sweeps of their own. Other roads to the same are compared as witnesses
// are (derivative_roads.hpp).
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

struct ForcesByAcceleration : Law {
  static constexpr LawWords kWords = {"joint forces by acceleration", "dtau/dqdd = M", "dtau_dqdd",
                                      "derivatives", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    return {at.ofInverse().M, at.M()};
  }
};

/// What a change of q or qd asks of tau at the same qdd, qdd gives way to at the same tau. Along
/// any direction.
struct AccelerationsGiveWay : Law {
  static constexpr LawWords kWords = {"accelerations give way to forces",
                                      "M dqdd/dq = -dtau/dq, M dqdd/dqd = -dtau/dqd", "dqdd_dq",
                                      "derivatives", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using Matrix = recursive::MatrixX<T>;
    const Matrix u = at.column(at.anyDirection());
    TwoSides<T> out = {Matrix(at.n(), 2), Matrix(at.n(), 2)};
    out.left << at.M() * Matrix(at.ofForward().dqdd_dq * u),
        at.M() * Matrix(at.ofForward().dqdd_dqd * u);
    out.right << -Matrix(at.ofInverse().dtau_dq * u), -Matrix(at.ofInverse().dtau_dqd * u);
    return out;
  }
};

struct SymmetricInverseOfM : Law {
  static constexpr LawWords kWords = {"symmetric accelerations by force",
                                      "dqdd/dtau = (dqdd/dtau)', M dqdd/dtau = 1", "dqdd_dtau",
                                      "derivatives", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using Matrix = recursive::MatrixX<T>;
    const Matrix u = at.column(at.anyDirection()), inverse = at.ofForward().dqdd_dtau;
    TwoSides<T> out = {Matrix(at.n(), at.n() + 1), Matrix(at.n(), at.n() + 1)};
    out.left << inverse, at.M() * Matrix(inverse * u);
    out.right << Matrix(inverse.transpose()), u;
    return out;
  }
};

/// Weights and springs have a potential, whose second derivatives these are.
struct SymmetricGravityGradient : Law {
  static constexpr LawWords kWords = {"symmetric gradient of gravity", "dg/dq = (dg/dq)'", "dg_dq",
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
                                      "dtau_dqd", "derivatives", "composite_body"};
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
