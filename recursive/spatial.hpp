// SPDX-License-Identifier: Apache-2.0
// Spatial (6-D) algebra: motions, forces, frame transformations, rigid and articulated inertia.
//
// "Chapter" is H. Bruyninckx, Dynamics of robots (2005). Six-vectors are linear part first, as
// there: X = (v, w), F = (f, m); this file is the only one that knows the order. A motion refers to
// the body point at the origin of the frame that it is expressed in, a force to the moment about
// that origin.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dynwitness::recursive {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;
template <typename T>
using Vector6 = Eigen::Matrix<T, 6, 1>;
template <typename T>
using Matrix6 = Eigen::Matrix<T, 6, 6>;

/// The matrix of the cross product: skew(r) x = r x x.                       [chapter, equation 4]
template <typename T>
Matrix3<T> skew(const Vector3<T>& r) {
  Matrix3<T> m;
  m << T(0), -r.z(), r.y(), r.z(), T(0), -r.x(), -r.y(), r.x(), T(0);
  return m;
}

/// Velocity or acceleration of a link: [m/s, rad/s] or [m/s^2, rad/s^2].
template <typename T>
struct Motion {
  Vector3<T> linear, angular;

  static Motion zero() { return {Vector3<T>::Zero(), Vector3<T>::Zero()}; }
  Motion operator+(const Motion& b) const { return {linear + b.linear, angular + b.angular}; }
  Motion operator-(const Motion& b) const { return {linear - b.linear, angular - b.angular}; }
  Motion operator*(const T& s) const { return {linear * s, angular * s}; }
  Vector6<T> vector() const { return (Vector6<T>() << linear, angular).finished(); }
};

/// Force or momentum of a link: [N, N m] or [N s, N m s].
template <typename T>
struct Force {
  Vector3<T> force, moment;

  static Force zero() { return {Vector3<T>::Zero(), Vector3<T>::Zero()}; }
  Force operator+(const Force& b) const { return {force + b.force, moment + b.moment}; }
  Force operator-(const Force& b) const { return {force - b.force, moment - b.moment}; }
  Force operator*(const T& s) const { return {force * s, moment * s}; }
  Vector6<T> vector() const { return (Vector6<T>() << force, moment).finished(); }
};

/// Power of a force on a motion [W]: the only product of the two.
template <typename T>
T dot(const Motion<T>& x, const Force<T>& f) {
  return x.linear.dot(f.force) + x.angular.dot(f.moment);
}

/// Rate of change of a motion that is constant in a frame moving with velocity x.
template <typename T>
Motion<T> cross(const Motion<T>& x, const Motion<T>& y) {
  return {x.angular.cross(y.linear) + x.linear.cross(y.angular), x.angular.cross(y.angular)};
}

/// Rate of change of a force that is constant in a frame moving with velocity x.
template <typename T>
Force<T> cross(const Motion<T>& x, const Force<T>& f) {
  return {x.angular.cross(f.force), x.angular.cross(f.moment) + x.linear.cross(f.force)};
}

/// A symmetric 3 x 3 matrix as its six numbers: rounding cannot make it unsymmetric.
template <typename T>
struct Symmetric3 {
  T xx, yy, zz, xy, xz, yz;

  static Symmetric3 zero() { return {T(0), T(0), T(0), T(0), T(0), T(0)}; }
  static Symmetric3 diagonal(const T& d) { return {d, d, d, T(0), T(0), T(0)}; }
  /// The symmetric matrix whose upper triangle is that of m.
  static Symmetric3 fromUpper(const Matrix3<T>& m) {
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)};
  }
  Symmetric3 operator+(const Symmetric3& b) const {
    return {xx + b.xx, yy + b.yy, zz + b.zz, xy + b.xy, xz + b.xz, yz + b.yz};
  }
  Symmetric3 operator-(const Symmetric3& b) const {
    return {xx - b.xx, yy - b.yy, zz - b.zz, xy - b.xy, xz - b.xz, yz - b.yz};
  }
  Vector3<T> operator*(const Vector3<T>& r) const {
    return {xx * r.x() + xy * r.y() + xz * r.z(), xy * r.x() + yy * r.y() + yz * r.z(),
            xz * r.x() + yz * r.y() + zz * r.z()};
  }
  Vector3<T> column(int j) const {
    return j == 0   ? Vector3<T>(xx, xy, xz)
           : j == 1 ? Vector3<T>(xy, yy, yz)
                    : Vector3<T>(xz, yz, zz);
  }
  Matrix3<T> matrix() const {
    Matrix3<T> m;
    m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return m;
  }
  /// R' S R: the same matrix in the axes that R turns into these.
  Symmetric3 turnedBack(const Matrix3<T>& R) const {
    const Matrix3<T> S_R = (Matrix3<T>() << *this * Vector3<T>(R.col(0)),
                            *this * Vector3<T>(R.col(1)), *this * Vector3<T>(R.col(2)))
                               .finished();
    return {R.col(0).dot(S_R.col(0)), R.col(1).dot(S_R.col(1)), R.col(2).dot(S_R.col(2)),
            R.col(0).dot(S_R.col(1)), R.col(0).dot(S_R.col(2)), R.col(1).dot(S_R.col(2))};
  }
  /// u u' s
  static Symmetric3 outer(const Vector3<T>& u, const T& s) {
    const Vector3<T> us = u * s;
    return {us.x() * u.x(), us.y() * u.y(), us.z() * u.z(),
            us.x() * u.y(), us.x() * u.z(), us.y() * u.z()};
  }
};

/** Inertia of a rigid body in a frame: mass [kg], first moment h = m r_c [kg m], and rotational
    inertia I about the frame's origin [kg m^2]. As a matrix                 [chapter, equation 18]

        M = [ m 1    -skew(h) ]
            [ skew(h)    I    ]                                                                   */
template <typename T>
struct RigidInertia {
  T mass;
  Vector3<T> h;
  Symmetric3<T> I;

  static RigidInertia zero() { return {T(0), Vector3<T>::Zero(), Symmetric3<T>::zero()}; }

  /// From mass, centre of mass r_c [m] and inertia about it:  I = I_c - m skew(r_c)^2.
  ///                                                                        [chapter, equation 16]
  static RigidInertia aboutCenterOfMass(const T& mass, const Vector3<T>& r_c,
                                        const Symmetric3<T>& I_c) {
    const Vector3<T> h = r_c * mass;
    const Symmetric3<T> shift = {r_c.y() * h.y() + r_c.z() * h.z(),
                                 r_c.x() * h.x() + r_c.z() * h.z(),
                                 r_c.x() * h.x() + r_c.y() * h.y(),
                                 -(r_c.x() * h.y()),
                                 -(r_c.x() * h.z()),
                                 -(r_c.y() * h.z())};
    return {mass, h, I_c + shift};
  }

  RigidInertia operator+(const RigidInertia& b) const { return {mass + b.mass, h + b.h, I + b.I}; }

  /// Momentum of a velocity, or the inertial part of the force of an acceleration.
  Force<T> operator*(const Motion<T>& x) const {
    return {x.linear * mass + x.angular.cross(h), h.cross(x.linear) + I * x.angular};
  }
  /// M (e_j, 0) and M (0, e_j): the columns of the matrix.
  Force<T> linearColumn(int j) const {
    Force<T> column{Vector3<T>::Zero(), crossUnit(h, j)};
    column.force(j) = mass;
    return column;
  }
  Force<T> angularColumn(int j) const { return {-crossUnit(h, j), I.column(j)}; }

 private:
  /// r x e_j
  static Vector3<T> crossUnit(const Vector3<T>& r, int j) {
    return j == 0   ? Vector3<T>(T(0), r.z(), -r.y())
           : j == 1 ? Vector3<T>(-r.z(), T(0), r.x())
                    : Vector3<T>(r.y(), -r.x(), T(0));
  }
};

/** Bias force of a rigid body moving with velocity x: the force that its motion needs without any
    spatial acceleration,  F_b = x cross* (M x).                                              [N, N
    m]

    The chapter's (15) gives the part for a body whose origin is momentarily at rest, with the
    acceleration of the body's point: (w x (w x m r_c), w x I w). Spatial acceleration carries the
    rest, v x w, on the acceleration's side. */
template <typename T>
Force<T> biasForce(const RigidInertia<T>& M, const Motion<T>& x) {
  return cross(x, M * x);
}

/** Inertia of a link with everything that is jointed to it, a general symmetric 6 x 6 matrix

        M = [ A   B ]      A: acceleration of the origin to force [kg],
            [ B'  C ]      C: angular acceleration to moment [kg m^2], B [kg m]

    kept as 6 + 9 + 6 numbers, so that it stays symmetric to the last bit. */
template <typename T>
struct ArticulatedInertia {
  Symmetric3<T> A;
  Matrix3<T> B;
  Symmetric3<T> C;

  static ArticulatedInertia zero() {
    return {Symmetric3<T>::zero(), Matrix3<T>::Zero(), Symmetric3<T>::zero()};
  }
  static ArticulatedInertia fromRigid(const RigidInertia<T>& M) {
    return {Symmetric3<T>::diagonal(M.mass), skew<T>(-M.h), M.I};
  }
  ArticulatedInertia operator+(const ArticulatedInertia& b) const {
    return {A + b.A, B + b.B, C + b.C};
  }
  Force<T> operator*(const Motion<T>& x) const {
    return {A * x.linear + B * x.angular, B.transpose() * x.linear + C * x.angular};
  }
  /// M (e_j, 0) and M (0, e_j): the columns of the matrix.
  Force<T> linearColumn(int j) const { return {A.column(j), B.row(j).transpose()}; }
  Force<T> angularColumn(int j) const { return {B.col(j), C.column(j)}; }
  /// M - U U' / D, the rank-one loss through a joint; `inverse_D` is 1 / D.
  ArticulatedInertia minusOuter(const Force<T>& U, const T& inverse_D) const {
    return {A - Symmetric3<T>::outer(U.force, inverse_D),
            B - (U.force * inverse_D) * U.moment.transpose(),
            C - Symmetric3<T>::outer(U.moment, inverse_D)};
  }
  Matrix6<T> matrix() const {
    Matrix6<T> m;
    m << A.matrix(), B, B.transpose(), C.matrix();
    return m;
  }
};

/** Coordinate transformation X_BA from frame A to frame B:
    R = R_BA turns coordinates in A into coordinates in B; p = p_AB_A is B's origin seen from A's,
    in A's axes [m]. Velocities and accelerations share one 6 x 6 matrix, forces and momenta its
    dual:

        T^V_BA = [ R  -R skew(p) ]     T^F_BA = [ R           0 ] = (T^V_AB)'
                 [ 0       R     ]              [ -R skew(p)  R ]   [chapter, equations 6 to 13] */
template <typename T>
struct Transform {
  Matrix3<T> R;
  Vector3<T> p;

  static Transform identity() { return {Matrix3<T>::Identity(), Vector3<T>::Zero()}; }

  /// X_CB * X_BA = X_CA
  Transform operator*(const Transform& X_BA) const {
    return {R * X_BA.R, X_BA.p + X_BA.R.transpose() * p};
  }
  Transform inverse() const { return {R.transpose(), R * -p}; }

  Motion<T> operator*(const Motion<T>& x_A) const {
    return {R * (x_A.linear + x_A.angular.cross(p)), R * x_A.angular};
  }
  Force<T> operator*(const Force<T>& f_A) const {
    return {R * f_A.force, R * (f_A.moment - p.cross(f_A.force))};
  }
  /// T^V_AB x_B: the same motion in A.
  Motion<T> inverseTimes(const Motion<T>& x_B) const {
    const Vector3<T> angular = R.transpose() * x_B.angular;
    return {R.transpose() * x_B.linear + p.cross(angular), angular};
  }
  /// T^F_AB f_B = (T^V_BA)' f_B: the same force (or momentum) in A.
  Force<T> inverseTimes(const Force<T>& f_B) const {
    const Vector3<T> force = R.transpose() * f_B.force;
    return {force, R.transpose() * f_B.moment + p.cross(force)};
  }
  /// T^F_AB M_B (T^F_AB)' for a rigid body: turn, then shift by p.          [chapter, equation 19]
  RigidInertia<T> inverseTimes(const RigidInertia<T>& M_B) const {
    const Vector3<T> h = R.transpose() * M_B.h;
    const Vector3<T> h_A = h + p * M_B.mass;
    // I_A = I - skew(p) skew(h) - skew(h_A) skew(p); it is symmetric, so the upper half will do
    const Symmetric3<T> shift = {p.y() * h.y() + p.z() * h.z() + h_A.y() * p.y() + h_A.z() * p.z(),
                                 p.x() * h.x() + p.z() * h.z() + h_A.x() * p.x() + h_A.z() * p.z(),
                                 p.x() * h.x() + p.y() * h.y() + h_A.x() * p.x() + h_A.y() * p.y(),
                                 -(p.y() * h.x() + h_A.y() * p.x()),
                                 -(p.z() * h.x() + h_A.z() * p.x()),
                                 -(p.z() * h.y() + h_A.z() * p.y())};
    return {M_B.mass, h_A, M_B.I.turnedBack(R) + shift};
  }
  /// The same for an articulated inertia.
  ArticulatedInertia<T> inverseTimes(const ArticulatedInertia<T>& M_B) const {
    const Symmetric3<T> A = M_B.A.turnedBack(R);
    const Matrix3<T> B = R.transpose() * M_B.B * R;
    const Matrix3<T> p_hat = skew<T>(p);
    const Matrix3<T> p_B = p_hat * B;
    const Matrix3<T> B_A = B - A.matrix() * p_hat;
    const Matrix3<T> shift = p_hat * B_A + p_B.transpose();
    return {A, B_A, M_B.C.turnedBack(R) + Symmetric3<T>::fromUpper(shift)};
  }

  Matrix6<T> motionMatrix() const {
    Matrix6<T> m;
    m << R, -(R * skew<T>(p)), Matrix3<T>::Zero(), R;
    return m;
  }
  Matrix6<T> forceMatrix() const {
    Matrix6<T> m;
    m << R, Matrix3<T>::Zero(), -(R * skew<T>(p)), R;
    return m;
  }
};

}  // namespace dynwitness::recursive
