// SPDX-License-Identifier: Apache-2.0
// How much of inertia, acceleration and force passes through a joint: the chapter's section 7.
// The sweeps use the same projections in their cheapest form; here they are 6 x 6 matrices to look
// at, for the identities and for teaching.
#pragma once

#include "recursive/spatial.hpp"

namespace dynwitness::recursive {

/** Inward projection of force through a joint with axis Z, rotor inertia d and articulated inertia M
    outboard,
        P = 1 - M Z (d + Z' M Z)^-1 Z'                                  [chapter, equations 27, 35]
    With d = 0 it is a projector, P P = P. With a rotor it has the eigenvalue d / (d + Z' M Z) where
    the projector has 0:  (P - 1)(P - d / (d + Z' M Z)) = 0. */
template <typename T>
Matrix6<T> forceProjection(const Matrix6<T>& M, const Vector6<T>& Z, const T& d) {
  const Vector6<T> M_Z = M * Z;
  const T inverse_D = T(1) / (d + Z.dot(M_Z));
  Matrix6<T> P = Matrix6<T>::Identity();
  P -= (M_Z * inverse_D) * Z.transpose();
  return P;
}

/// Inward projection of inertia, P M: what the proximal link feels of M.   [chapter, equations 29, 34]
template <typename T>
Matrix6<T> inertiaProjection(const Matrix6<T>& M, const Vector6<T>& Z, const T& d) {
  return forceProjection(M, Z, d) * M;
}

/// Outward projection of acceleration, P': what the distal link takes over of an acceleration of the
/// proximal one when the joint is free.                                        [chapter, equation 39]
template <typename T>
Matrix6<T> accelerationProjection(const Matrix6<T>& M, const Vector6<T>& Z, const T& d) {
  return forceProjection(M, Z, d).transpose();
}

}  // namespace dynwitness::recursive
