// SPDX-License-Identifier: Apache-2.0
// How much of inertia, acceleration and force passes through a joint: the chapter's section 7.
// The sweeps use the same projections in their cheapest form; here they are 6 x 6 matrices to look
// at, for the audit and for teaching, and what the sweeps themselves make of a joint, to be held to
// them.
#pragma once

#include "recursive/articulated_step.hpp"
#include "recursive/factorization.hpp"
#include "recursive/spatial.hpp"

namespace dynwitness::recursive {

/// The axes of a joint as columns, six rows.
template <typename T>
using JointAxes = Eigen::Matrix<T, 6, Eigen::Dynamic>;

/** Inward projection of force through a joint with axes Z (6 x N), joint inertia d (N x N,
    symmetric: rotors; any coupling of them is allowed) and articulated inertia M outboard,
        P = 1 - M Z (d + Z' M Z)^-1 Z'                                  [chapter, equations 27, 35]
    With d = 0 it is a projector, P P = P. In general
        P P = P - M Z D^-1 d D^-1 Z',   D = d + Z' M Z
    so that one axis with a rotor has the eigenvalue d / D where the projector has 0. */
template <typename T>
Matrix6<T> forceProjection(const Matrix6<T>& M, const JointAxes<T>& Z, const MatrixX<T>& d) {
  const JointAxes<T> M_Z = M * Z;
  MatrixX<T> D = d + MatrixX<T>(Z.transpose() * M_Z);
  factorize(D);
  Matrix6<T> P = Matrix6<T>::Identity();
  for (int row = 0; row < 6; ++row) {
    Eigen::Matrix<T, Eigen::Dynamic, 1> y = M_Z.row(row).transpose();  // D^-1 Z' M e_row
    solve(D, y);
    P.row(row) -= (Z * y).transpose();
  }
  return P;
}
/// The same for a joint with one axis, and a rotor of inertia d.
template <typename T>
Matrix6<T> forceProjection(const Matrix6<T>& M, const Vector6<T>& Z, const T& d) {
  const Vector6<T> M_Z = M * Z;
  const T inverse_D = T(1) / (d + Z.dot(M_Z));
  Matrix6<T> P = Matrix6<T>::Identity();
  P -= (M_Z * inverse_D) * Z.transpose();
  return P;
}

/// Inward projection of inertia, P M: what the proximal link feels of M.   [chapter, equations 29,
/// 34]
template <typename T, typename Axes, typename Inertia>
Matrix6<T> inertiaProjection(const Matrix6<T>& M, const Axes& Z, const Inertia& d) {
  return forceProjection(M, Z, d) * M;
}

/// Outward projection of acceleration, P': what the distal link takes over of an acceleration of
/// the proximal one when the joint is free.                                        [chapter,
/// equation 39]
template <typename T, typename Axes, typename Inertia>
Matrix6<T> accelerationProjection(const Matrix6<T>& M, const Axes& Z, const Inertia& d) {
  return forceProjection(M, Z, d).transpose();
}

/** P M of a spherical joint, written out. Its axes are the three turns, so that Z' M Z = C and

        P = [ 1  -B C^-1 ]      P M = [ A - B C^-1 B'   0 ]
            [ 0     0    ]            [       0         0 ]

    The proximal link feels forces of accelerations of the joint's centre, and nothing else.
    @return A - B C^-1 B', the inertia that the centre offers [kg] */
template <typename T>
Symmetric3<T> inertiaThroughSpherical(const ArticulatedInertia<T>& M) {
  const Symmetric3<T>& C = M.C;  // its inverse, by cofactors
  const Symmetric3<T> cofactors = {C.yy * C.zz - C.yz * C.yz, C.xx * C.zz - C.xz * C.xz,
                                   C.xx * C.yy - C.xy * C.xy, C.xz * C.yz - C.xy * C.zz,
                                   C.xy * C.yz - C.xz * C.yy, C.xy * C.xz - C.xx * C.yz};
  const T inverse_det = T(1) / (C.xx * cofactors.xx + C.xy * cofactors.xy + C.xz * cofactors.xz);
  const Symmetric3<T> loss = cofactors.turnedBack(M.B.transpose());  // B C^-1 B' det C
  return {M.A.xx - loss.xx * inverse_det, M.A.yy - loss.yy * inverse_det,
          M.A.zz - loss.zz * inverse_det, M.A.xy - loss.xy * inverse_det,
          M.A.xz - loss.xz * inverse_det, M.A.yz - loss.yz * inverse_det};
}

/// What the articulated-body sweep makes of force and inertia on the way through one joint.
template <typename T>
struct SweptProjection {
  Matrix6<T> P;               ///< column k: what is left of the force e_k, no joint force acting
  ArticulatedInertia<T> P_M;  ///< what is left of the articulated inertia of the link
};

/** Reads P and P M of link i's joint off the sweep: unit forces and the articulated inertia go
    through the joint by the sweep's own steps, axis by axis (articulated_step.hpp, (3) to (5)).

    With a gyroscopic rotor that a link carries, G = (0, h z), they are

        P = 1 - U D^-1 Z',   P M = M - U D^-1 U',   U = M Z + G,   D = d + Z' M Z

    and without one the matrices above.
    @param x   the position at which forwardDynamics() has run on ws
    @param ws  U, D and u of the joint are written over, U and D with what they were */
template <typename T>
SweptProjection<T> sweptProjection(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                                   Workspace<T>& ws, int i) {
  const LinkModel<T>& link = model.links[i];
  SweptProjection<T> out{Matrix6<T>::Identity(), ws.M_A[i]};
  withJoints(model, [&](auto joints) {
    using Joints = decltype(joints);
    const std::vector<T>& no_rates = ws.u;  // without friction nobody asks for them
    ArticulatedSteps<Joints, T> step(model, x, no_rates, Terms::none(), ws);
    ArticulatedBody<T> body = step.body(i);
    for (int k = 0, d = link.dof; k < Joints::axes(link); ++k, ++d) step.project(d, body);
    out.P_M = body.M;
    for (int column = 0; column < 6; ++column) {
      const Vector6<T> unit = Matrix6<T>::Identity().col(column);
      body = {ws.M_A[i], {unit.template head<3>(), unit.template tail<3>()}};
      for (int k = 0, d = link.dof; k < Joints::axes(link); ++k, ++d) {
        step.formEquation(i, k, d, T(0), body);
        step.project(d, body);
      }
      out.P.col(column) = body.f.vector();
    }
  });
  return out;
}

}  // namespace dynwitness::recursive
