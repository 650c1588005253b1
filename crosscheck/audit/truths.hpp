// SPDX-License-Identifier: GPL-3.0-or-later
// What the chapter's formulas are held against: bodies as point masses that obey Newton's law,
// velocities and accelerations as derivatives of positions, joints as equations among many
// unknowns.
#pragma once

#include <stdexcept>
#include <vector>

#include "crosscheck/audit/trial.hpp"

namespace dynwitness::audit {

/// A function of time with its first two derivatives: x, xd, xdd.
template <typename T>
using Jet = Dual<Dual<T>>;

template <typename T>
Jet<T> jet(const T& x, const T& xd, const T& xdd) {
  return {{x, xd}, {xd, xdd}};
}
template <typename T>
Jet<T> constantJet(const T& x) {
  return jet<T>(x, T(0), T(0));
}

namespace detail {

template <typename T, int R, int C, typename Part>
Eigen::Matrix<T, R, C> mapped(const Eigen::Matrix<Jet<T>, R, C>& m, Part part) {
  Eigen::Matrix<T, R, C> out(m.rows(), m.cols());
  for (Eigen::Index i = 0; i < m.size(); ++i) out(i) = part(m(i));
  return out;
}

}  // namespace detail

template <typename T, int R, int C>
Eigen::Matrix<T, R, C> now(const Eigen::Matrix<Jet<T>, R, C>& m) {
  return detail::mapped<T>(m, [](const Jet<T>& x) { return x.value.value; });
}
template <typename T, int R, int C>
Eigen::Matrix<T, R, C> rate(const Eigen::Matrix<Jet<T>, R, C>& m) {
  return detail::mapped<T>(m, [](const Jet<T>& x) { return x.value.derivative; });
}
template <typename T, int R, int C>
Eigen::Matrix<T, R, C> secondRate(const Eigen::Matrix<Jet<T>, R, C>& m) {
  return detail::mapped<T>(m, [](const Jet<T>& x) { return x.derivative.derivative; });
}
/// The same vector or matrix at all times.
template <typename T, int R, int C>
Eigen::Matrix<Jet<T>, R, C> still(const Eigen::Matrix<T, R, C>& m) {
  Eigen::Matrix<Jet<T>, R, C> out(m.rows(), m.cols());
  for (Eigen::Index i = 0; i < m.size(); ++i) out(i) = constantJet(m(i));
  return out;
}

/** A moving frame in the world, by its positions: R(t) takes its coordinates to the world's, p(t)
    is its origin. All rates come from differentiating these. */
template <typename T>
struct Path {
  Matrix3<Jet<T>> R;
  Vector3<Jet<T>> p;

  Vector3<Jet<T>> place(const Vector3<T>& r) const;
  Matrix3<T> axes() const { return now<T, 3, 3>(R); }
  Vector3<T> origin() const { return now<T, 3, 1>(p); }
  /// w of Rd = w x R, in world axes
  Vector3<T> omega() const;
  Vector3<T> alpha() const;
  /// Of the body's point that is the frame's origin, in world axes.
  Motion<T> velocity() const;
  /// Derivative of velocity(): the acceleration of that point of the body.
  Motion<T> acceleration() const;

 private:
  static Vector3<T> unskewed(const Matrix3<T>& m) { return {m(2, 1), m(0, 2), m(1, 0)}; }
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
Vector3<Jet<T>> Path<T>::place(const Vector3<T>& r) const {
  return p + R * still<T, 3, 1>(r);
}

template <typename T>
Vector3<T> Path<T>::omega() const {
  return unskewed(rate<T, 3, 3>(R) * axes().transpose());
}

template <typename T>
Vector3<T> Path<T>::alpha() const {
  const Matrix3<T> Rd = rate<T, 3, 3>(R);
  return unskewed(secondRate<T, 3, 3>(R) * axes().transpose() + Rd * Rd.transpose());
}

template <typename T>
Motion<T> Path<T>::velocity() const {
  return {rate<T, 3, 1>(p), omega()};
}

template <typename T>
Motion<T> Path<T>::acceleration() const {
  return {secondRate<T, 3, 1>(p), alpha()};
}

enum class Start { kMoving, kNotTurning, kStandstill };

/// Any motion, to second order in time: a rational rotation of a quaternion that is any function of
/// time.
Path<T> anyPath(Point& at, Start start = Start::kMoving);

/// A joint coordinate with its rates.
template <typename T>
struct JointMotion {
  T q, qd, qdd;
};
inline JointMotion<T> anyJointMotion(Point& at, Start start = Start::kMoving) {
  const T q = at.number(), qd = start == Start::kMoving ? at.number() : T(0);
  return {q, qd, at.number()};
}

/// The frame that turns about z of a frame placed at (R, r) on the parent. cos and sin are `angle`
/// now.
template <typename T>
Path<T> turned(const Path<T>& parent, const Matrix3<T>& R, const Vector3<T>& r,
               const scene::CosSin<T>& angle, const JointMotion<T>& joint) {
  const T qd2 = joint.qd * joint.qd;
  const Jet<T> c = jet<T>(angle.c, -angle.s * joint.qd, -angle.c * qd2 - angle.s * joint.qdd);
  const Jet<T> s = jet<T>(angle.s, angle.c * joint.qd, -angle.s * qd2 + angle.c * joint.qdd);
  Matrix3<Jet<T>> turn = still<T, 3, 3>(Matrix3<T>::Identity());
  turn(0, 0) = turn(1, 1) = c;
  turn(1, 0) = s;
  turn(0, 1) = -s;
  return {Matrix3<Jet<T>>(parent.R * still<T, 3, 3>(R)) * turn, parent.place(r)};
}

/// The frame that slides along z of a frame placed at (R, r) on the parent.
template <typename T>
Path<T> slid(const Path<T>& parent, const Matrix3<T>& R, const Vector3<T>& r,
             const JointMotion<T>& joint) {
  Vector3<Jet<T>> place = still<T, 3, 1>(r);
  const Jet<T> q = jet<T>(joint.q, joint.qd, joint.qdd);
  for (int i = 0; i < 3; ++i) place(i) += constantJet<T>(R(i, 2)) * q;
  return {parent.R * still<T, 3, 3>(R), parent.p + parent.R * place};
}

/// A rigid body as point masses. Four in general places have every rigid inertia's generality that
/// the formulas can see.
template <typename T>
struct PointMasses {
  std::vector<T> m;
  std::vector<Vector3<T>> r;  ///< in the body's frame

  T mass() const;
  Vector3<T> firstMoment() const;
  Vector3<T> center() const { return firstMoment() / mass(); }
  /// sum m (r'r 1 - r r') about this point of the body's frame
  Matrix3<T> inertiaAbout(const Vector3<T>& point) const;
  RigidInertia<T> inertia() const;
  /// The same masses seen from another frame: places R r + p.
  PointMasses seenFrom(const Matrix3<T>& R, const Vector3<T>& p) const;
  /// The force that Newton's law says this motion needs: sum m xdd, and its moment about `point`
  /// [world].
  Force<T> force(const Path<T>& path, const Vector3<T>& point) const;
};

template <typename T>
T PointMasses<T>::mass() const {
  T sum = T(0);
  for (const T& m_k : m) sum += m_k;
  return sum;
}

template <typename T>
Vector3<T> PointMasses<T>::firstMoment() const {
  Vector3<T> sum = Vector3<T>::Zero();
  for (std::size_t k = 0; k < m.size(); ++k) sum += r[k] * m[k];
  return sum;
}

template <typename T>
Matrix3<T> PointMasses<T>::inertiaAbout(const Vector3<T>& point) const {
  Matrix3<T> I = Matrix3<T>::Zero();
  for (std::size_t k = 0; k < m.size(); ++k) {
    const Vector3<T> d = r[k] - point;
    I += (Matrix3<T>::Identity() * d.dot(d) - d * d.transpose()) * m[k];
  }
  return I;
}

template <typename T>
RigidInertia<T> PointMasses<T>::inertia() const {
  return {mass(), firstMoment(), Symmetric3<T>::fromUpper(inertiaAbout(Vector3<T>::Zero()))};
}

template <typename T>
PointMasses<T> PointMasses<T>::seenFrom(const Matrix3<T>& R, const Vector3<T>& p) const {
  PointMasses out = *this;
  for (Vector3<T>& place : out.r) place = R * place + p;
  return out;
}

template <typename T>
Force<T> PointMasses<T>::force(const Path<T>& path, const Vector3<T>& point) const {
  Force<T> sum = Force<T>::zero();
  for (std::size_t k = 0; k < m.size(); ++k) {
    const Vector3<Jet<T>> x = path.place(r[k]);
    const Vector3<T> f = secondRate<T, 3, 1>(x) * m[k];
    sum = sum + Force<T>{f, (now<T, 3, 1>(x) - point).cross(f)};
  }
  return sum;
}

PointMasses<T> anyBody(Point& at);

/// [ m 1, -m hat(r_c); m hat(r_c), I ] written out.                             [chapter, equation
/// 18]
template <typename T>
Matrix6<T> massMatrix6(const T& m, const Vector3<T>& h, const Matrix3<T>& I) {
  Matrix6<T> M;
  M << Matrix3<T>(Matrix3<T>::Identity() * m), Matrix3<T>(-skew<T>(h)), skew<T>(h), I;
  return M;
}
template <typename T>
Matrix6<T> massMatrix6(const PointMasses<T>& body) {
  return massMatrix6<T>(body.mass(), body.firstMoment(), body.inertiaAbout(Vector3<T>::Zero()));
}

namespace detail {

template <typename T>
bool isZero(const T& x) {
  return x == T(0);
}
inline bool isZero(const Ball& x) {
  return x.isZero();
}

}  // namespace detail

/// Solves A x = b by elimination in any field. @throws DivisionByZero when A is singular.
template <typename T>
VectorX<T> solveDense(MatrixX<T> A, VectorX<T> b) {
  const Eigen::Index n = A.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = k;
    while (pivot < n && detail::isZero(A(pivot, k))) ++pivot;
    if (pivot == n) throw crosscheck::DivisionByZero("singular system");
    A.row(k).swap(A.row(pivot));
    std::swap(b(k), b(pivot));
    for (Eigen::Index i = k + 1; i < n; ++i) {
      if (detail::isZero(A(i, k))) continue;
      const T factor = A(i, k) / A(k, k);
      for (Eigen::Index j = k; j < n; ++j) A(i, j) -= factor * A(k, j);
      b(i) -= factor * b(k);
    }
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    for (Eigen::Index j = k + 1; j < n; ++j) b(k) -= A(k, j) * b(j);
    b(k) /= A(k, k);
  }
  return b;
}

/// (27) and, with a rotor, (35), as the chapter writes them: 1 - M Z (d + Z' M Z)^-1 Z'.
template <typename T>
Matrix6<T> projectionOf(const Matrix6<T>& M, const Vector6<T>& Z, const T& d) {
  const Vector6<T> M_Z = M * Z;
  return Matrix6<T>::Identity() - Matrix6<T>(M_Z * Z.transpose()) / T(d + Z.dot(M_Z));
}

/// P M of (29).
template <typename T>
Matrix6<T> projectedInertia(const Matrix6<T>& M, const Vector6<T>& Z, const T& d) {
  return projectionOf<T>(M, Z, d) * M;
}

/// A distal link on a joint, all in one frame, and what acts on it.
template <typename T>
struct JointProblem {
  Matrix6<T> M_2;                         ///< of the distal link
  Vector6<T> Z;                           ///< joint axis
  T gear = T(0), rotor = T(0);            ///< the motor's shaft turns by gear qdd, its inertia
  Vector6<T> Xdd_1 = Vector6<T>::Zero();  ///< of the proximal link
  Vector6<T> bias_acceleration = Vector6<T>::Zero(), bias_force = Vector6<T>::Zero();
  Vector6<T> applied = Vector6<T>::Zero();  ///< force on the distal link from outside
  T tau = T(0);  ///< motor torque, at the joint: gear times that of the shaft
};
template <typename T>
struct JointSolution {
  Vector6<T> Xdd_2, transmitted;  ///< the force that link 1 exerts on link 2
  T qdd;
};

/** Newton-Euler for the distal link, the joint, and the motor's shaft as one linear system in 14
    unknowns (Xdd_2, qdd, the joint's force f, the shaft's torque s on the gear):

        M_2 Xdd_2 - f = applied - bias_force
        Xdd_2 - Z qdd = Xdd_1 + bias_acceleration
        Z' f = gear s
        rotor gear qdd = tau / gear - s

    (the last two times gear; without a motor gear = 0, and s is what the shaft makes of tau). */
template <typename T>
JointSolution<T> solveJoint(const JointProblem<T>& problem) {
  MatrixX<T> A = MatrixX<T>::Constant(14, 14, T(0));
  VectorX<T> b = VectorX<T>::Constant(14, T(0));
  A.block(0, 0, 6, 6) = problem.M_2;
  for (int i = 0; i < 6; ++i) {
    A(i, 7 + i) = T(-1);
    A(6 + i, i) = T(1);
    A(6 + i, 6) = -problem.Z(i);
    A(12, 7 + i) = problem.Z(i);
    b(i) = problem.applied(i) - problem.bias_force(i);
    b(6 + i) = problem.Xdd_1(i) + problem.bias_acceleration(i);
  }
  A(12, 13) = T(-1);  // Z' f = (gear s)
  A(13, 13) = T(1);   // (gear s) = tau - gear rotor gear qdd
  A(13, 6) = problem.gear * problem.rotor * problem.gear;
  b(13) = problem.tau;
  const VectorX<T> x = solveDense<T>(A, b);
  return {x.template segment<6>(0), x.template segment<6>(7), x(6)};
}

// over the field: compiled once (robot_in_field.cpp), and not again in every file that draws one

extern template Matrix3<T> Point::rotationOf(const T&, const Vector3<T>&);
extern template Matrix3<Jet<T>> Point::rotationOf(const Jet<T>&, const Vector3<Jet<T>>&);
extern template struct Path<T>;
extern template struct PointMasses<T>;
extern template Path<T> turned(const Path<T>&, const Matrix3<T>&, const Vector3<T>&,
                               const scene::CosSin<T>&, const JointMotion<T>&);
extern template Path<T> slid(const Path<T>&, const Matrix3<T>&, const Vector3<T>&,
                             const JointMotion<T>&);
extern template Matrix6<T> massMatrix6(const PointMasses<T>&);
extern template VectorX<T> solveDense(MatrixX<T>, VectorX<T>);
extern template Matrix6<T> projectionOf(const Matrix6<T>&, const Vector6<T>&, const T&);
extern template Matrix6<T> projectedInertia(const Matrix6<T>&, const Vector6<T>&, const T&);
extern template JointSolution<T> solveJoint(const JointProblem<T>&);

}  // namespace dynwitness::audit
