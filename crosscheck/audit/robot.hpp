// SPDX-License-Identifier: GPL-3.0-or-later
// Random robots for the statements about whole chains: their truth by point masses and virtual
// work, and the six-vectors that the chapter's recursions are written in.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "crosscheck/audit/truths.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/constrained_dynamics.hpp"

namespace dynwitness::audit {

using recursive::JointKind;
using recursive::LinkConstraint;

/// Solves r(x) = 0 for an r that is affine in x, from its values at 0 and at the unit vectors.
template <typename T>
VectorX<T> solveAffine(int size, const std::function<VectorX<T>(const VectorX<T>&)>& r) {
  const VectorX<T> zero = VectorX<T>::Constant(size, T(0));
  const VectorX<T> r_0 = r(zero);
  MatrixX<T> A(size, size);
  for (int k = 0; k < size; ++k) {
    VectorX<T> unit = zero;
    unit(k) = T(1);
    A.col(k) = r(unit) - r_0;
  }
  return solveDense<T>(A, VectorX<T>(-r_0));
}

/// B of A B = 1, column by column.
template <typename T>
MatrixX<T> inverseDense(const MatrixX<T>& A) {
  MatrixX<T> B(A.rows(), A.cols());
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    VectorX<T> unit = VectorX<T>::Constant(A.rows(), T(0));
    unit(k) = T(1);
    B.col(k) = solveDense<T>(A, unit);
  }
  return B;
}

/// Determinant by elimination in any field.
template <typename T>
T determinant(MatrixX<T> A) {
  T product = T(1);
  const Eigen::Index n = A.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = k;
    while (pivot < n && A(pivot, k) == T(0)) ++pivot;
    if (pivot == n) return T(0);
    if (pivot != k) {
      A.row(k).swap(A.row(pivot));
      product = -product;
    }
    product *= A(k, k);
    for (Eigen::Index i = k + 1; i < n; ++i) {
      if (A(i, k) == T(0)) continue;
      const T factor = A(i, k) / A(k, k);
      for (Eigen::Index j = k; j < n; ++j) A(i, j) -= factor * A(k, j);
    }
  }
  return product;
}

/** A tree of one-dof joints whose links are point masses, in any state, with joint forces and
    gravity.

    Its truth knows no spatial vector, inertia or recursion: places of points as functions of time
    (truths.hpp), Newton's law for each, and the principle of virtual work,
        tau_i = sum over points m (dx/dq_i)' (xdd - gravity) + d_i qdd_i. */
template <typename T>
struct Robot {
  std::vector<int> parent;
  std::vector<JointKind> kind;
  std::vector<Matrix3<T>> R;  ///< joint frame on the parent: x_parent = R x + r
  std::vector<Vector3<T>> r;
  std::vector<PointMasses<T>> body;
  std::vector<T> rotor, qd, qdd, tau;
  std::vector<scene::JointPosition<T>> x;
  Vector3<T> gravity = Vector3<T>::Zero();
  Motion<T> base_velocity = Motion<T>::zero();
  PointMasses<T> base_body;  ///< used where the base floats

  int n() const { return static_cast<int>(parent.size()); }
  std::vector<T> zeros() const { return std::vector<T>(parent.size(), T(0)); }
  std::vector<T> unit(int i) const;

  /// Where all link frames are, were and will be; `base`: spatial acceleration of the base in its
  /// axes.
  std::vector<Path<T>> paths(const std::vector<T>& qd, const std::vector<T>& qdd,
                             const Motion<T>& base = Motion<T>::zero(),
                             bool base_moves = true) const;
  /// The base frame is the world's now and moves with base_velocity.
  Path<T> basePath(const Motion<T>& acceleration, bool base_moves = true) const;

  /// Joint forces of a motion, by virtual work.
  VectorX<T> forces(const std::vector<T>& qd, const std::vector<T>& qdd, const Vector3<T>& gravity,
                    const Motion<T>& base = Motion<T>::zero()) const;
  VectorX<T> forces(const std::vector<T>& qdd) const { return forces(qd, qdd, gravity); }
  /// The qdd that tau causes.
  std::vector<T> accelerations() const;
  MatrixX<T> massMatrix() const;
  /// Force and moment about the base's origin that all bodies together need beyond their weight.
  Force<T> baseForce(const std::vector<T>& qdd, const Motion<T>& base) const;
  Force<T> net(const PointMasses<T>& masses, const Path<T>& path) const;

  /// Velocity of link i in its own axes, of its origin.
  Vector6<T> velocityOf(const Path<T>& path) const;
  /// Spatial acceleration in its own axes: of its origin, less w x v.
  Vector6<T> accelerationOf(const Path<T>& path) const;
  /// 6 x n: velocities of a link of unit joint rates.
  MatrixX<T> jacobian(int link) const;

  static VectorX<T> column(const std::vector<T>& v);
  static std::vector<T> values(const VectorX<T>& v) { return {v.data(), v.data() + v.size()}; }

  /// What the sweeps of recursive/ read.
  recursive::Model<T> model() const;
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
std::vector<T> Robot<T>::unit(int i) const {
  std::vector<T> e = zeros();
  e[i] = T(1);
  return e;
}

template <typename T>
std::vector<Path<T>> Robot<T>::paths(const std::vector<T>& qd, const std::vector<T>& qdd,
                                     const Motion<T>& base, bool base_moves) const {
  std::vector<Path<T>> out;
  const Path<T> root = basePath(base, base_moves);
  for (int i = 0; i < n(); ++i) {
    const Path<T>& on = parent[i] < 0 ? root : out[parent[i]];
    const JointMotion<T> motion = {x[i].q, qd[i], qdd[i]};
    out.push_back(kind[i] == JointKind::kPrismatic
                      ? slid(on, R[i], r[i], motion)
                      : turned(on, R[i], r[i], scene::CosSin<T>{x[i].c, x[i].s}, motion));
  }
  return out;
}

template <typename T>
Path<T> Robot<T>::basePath(const Motion<T>& acceleration, bool base_moves) const {
  const Motion<T> v = base_moves ? base_velocity : Motion<T>::zero();
  const Matrix3<T> w = skew<T>(v.angular), one = Matrix3<T>::Identity();
  const Matrix3<T> wd = skew<T>(acceleration.angular) + w * w;
  const Vector3<T> pdd = acceleration.linear + v.angular.cross(v.linear);
  Path<T> path{still<T, 3, 3>(one), still<T, 3, 1>(Vector3<T>::Zero())};
  for (int i = 0; i < 3; ++i) {
    path.p(i) = jet<T>(T(0), v.linear(i), pdd(i));
    for (int j = 0; j < 3; ++j) path.R(i, j) = jet<T>(one(i, j), w(i, j), wd(i, j));
  }
  return path;
}

template <typename T>
VectorX<T> Robot<T>::forces(const std::vector<T>& qd, const std::vector<T>& qdd,
                            const Vector3<T>& gravity, const Motion<T>& base) const {
  const std::vector<Path<T>> motion = paths(qd, qdd, base);
  VectorX<T> out(n());
  for (int i = 0; i < n(); ++i) {
    const std::vector<Path<T>> varied = paths(unit(i), zeros(), Motion<T>::zero(), false);
    out(i) = rotor[i] * qdd[i];
    for (int k = 0; k < n(); ++k)
      for (std::size_t j = 0; j < body[k].m.size(); ++j) {
        const Vector3<T> dx = rate<T, 3, 1>(varied[k].place(body[k].r[j]));
        const Vector3<T> xdd = secondRate<T, 3, 1>(motion[k].place(body[k].r[j]));
        out(i) += body[k].m[j] * dx.dot(xdd - gravity);
      }
  }
  return out;
}

template <typename T>
std::vector<T> Robot<T>::accelerations() const {
  return values(solveAffine<T>(
      n(), [&](const VectorX<T>& qdd) { return VectorX<T>(forces(values(qdd)) - column(tau)); }));
}

template <typename T>
MatrixX<T> Robot<T>::massMatrix() const {
  MatrixX<T> M(n(), n());
  for (int j = 0; j < n(); ++j) M.col(j) = forces(zeros(), unit(j), Vector3<T>::Zero());
  return M;
}

template <typename T>
Force<T> Robot<T>::baseForce(const std::vector<T>& qdd, const Motion<T>& base) const {
  const Path<T> root = basePath(base);
  Force<T> sum = net(base_body, root);
  const std::vector<Path<T>> motion = paths(qd, qdd, base);
  for (int i = 0; i < n(); ++i) sum = sum + net(body[i], motion[i]);
  return sum;
}

template <typename T>
Force<T> Robot<T>::net(const PointMasses<T>& masses, const Path<T>& path) const {
  Force<T> sum = Force<T>::zero();
  for (std::size_t k = 0; k < masses.m.size(); ++k) {
    const Vector3<Jet<T>> place = path.place(masses.r[k]);
    const Vector3<T> f = (secondRate<T, 3, 1>(place) - gravity) * masses.m[k];
    sum = sum + Force<T>{f, now<T, 3, 1>(place).cross(f)};
  }
  return sum;
}

template <typename T>
Vector6<T> Robot<T>::velocityOf(const Path<T>& path) const {
  const Matrix3<T> Rt = path.axes().transpose();
  const Motion<T> v = path.velocity();
  return Motion<T>{Rt * v.linear, Rt * v.angular}.vector();
}

template <typename T>
Vector6<T> Robot<T>::accelerationOf(const Path<T>& path) const {
  const Matrix3<T> Rt = path.axes().transpose();
  const Motion<T> v = path.velocity(), a = path.acceleration();
  return Motion<T>{Rt * (a.linear - v.angular.cross(v.linear)), Rt * a.angular}.vector();
}

template <typename T>
MatrixX<T> Robot<T>::jacobian(int link) const {
  MatrixX<T> J(6, n());
  for (int j = 0; j < n(); ++j)
    J.col(j) = velocityOf(paths(unit(j), zeros(), Motion<T>::zero(), false)[link]);
  return J;
}

template <typename T>
VectorX<T> Robot<T>::column(const std::vector<T>& v) {
  return Eigen::Map<const VectorX<T>>(v.data(), static_cast<Eigen::Index>(v.size()));
}

template <typename T>
recursive::Model<T> Robot<T>::model() const {
  recursive::Model<T> out;
  out.gravity = gravity;
  out.positions = n();
  for (int i = 0; i < n(); ++i) {
    recursive::LinkModel<T> link;
    link.parent = parent[i];
    link.dof = link.slot = i;
    link.kind = kind[i];
    link.X_tree = {R[i].transpose(), r[i]};
    link.M = body[i].inertia();
    link.rotor = rotor[i];
    out.links.push_back(link);
    out.link_of_dof.push_back(i);
  }
  return out;
}

/// T and V of a robot's point masses and rotors at the rates qd: sums of m v^2 / 2 and d qd^2 / 2,
/// and of -m g' x.
template <typename T>
std::pair<T, T> energiesOf(const Robot<T>& robot, const std::vector<T>& qd) {
  T twice_kinetic = T(0), potential = T(0);
  const auto paths = robot.paths(qd, robot.zeros());
  for (int i = 0; i < robot.n(); ++i) {
    twice_kinetic += robot.rotor[i] * qd[i] * qd[i];
    for (std::size_t k = 0; k < robot.body[i].m.size(); ++k) {
      const Vector3<Jet<T>> place = paths[i].place(robot.body[i].r[k]);
      const Vector3<T> v = rate<T, 3, 1>(place);
      twice_kinetic += robot.body[i].m[k] * v.dot(v);
      potential -= robot.body[i].m[k] * robot.gravity.dot(now<T, 3, 1>(place));
    }
  }
  return {twice_kinetic / T(2), potential};
}

enum class Rotors { kNone, kAll };

/// Any robot with these joints, link i on link parent[i] (on the one before it, when left out).
Robot<T> anyRobot(Point& at, const std::vector<JointKind>& kinds, Rotors rotors = Rotors::kAll,
                  const std::vector<int>& parents = {});

inline constexpr JointKind kTurn = JointKind::kRevolute, kSlide = JointKind::kPrismatic;
inline const std::vector<JointKind> kMixed = {kTurn, kSlide, kTurn};

/** The chapter's quantities of a robot as six-vectors and 6 x 6 matrices in link coordinates,
    linear part first, with spatial accelerations: X takes motions from parent to link (the
    chapter's T_V), its transpose takes forces back (T_F); Z the joint axis, d the rotor; c the bias
    acceleration, b the bias force of the link alone; M_A and D the articulated inertia and d + Z'
    M_A Z. */
template <typename T>
struct SixVectors {
  explicit SixVectors(const Robot<T>& robot);
  int n() const { return robot.n(); }
  int parent(int i) const { return robot.parent[i]; }
  /// v x as a matrix on motions; the one on forces is the negative of its transpose.
  static Matrix6<T> crossMatrix(const Vector6<T>& v);
  /// 1 - M_A Z D^-1 Z'
  Matrix6<T> P(int i) const;
  /// The force that link i and what hangs on it need besides M_A a, the joints outboard being
  /// driven by their tau: b + sum X' (P p + M_A Z D^-1 tau + P M_A c).
  std::vector<Vector6<T>> biasForces() const;
  Vector6<T> passedOn(int i, const Vector6<T>& p_i) const;
  /// a_0 = -gravity
  Vector6<T> gravityAtBase() const;
  /// X down to the base: base to link i.
  Matrix6<T> fromBase(int i) const;

  const Robot<T>& robot;
  std::vector<Matrix6<T>> X, M, M_A;
  std::vector<Vector6<T>> Z, v, c, b;
  std::vector<T> D;
};

template <typename T>
SixVectors<T>::SixVectors(const Robot<T>& robot) : robot(robot) {
  const int n = robot.n();
  const recursive::Model<T> model = robot.model();
  for (int i = 0; i < n; ++i) {
    const Transform<T> X_up = recursive::AnyJoints::transform(model.links[i], robot.x);
    X.push_back(X_up.motionMatrix());
    Z.push_back(Vector6<T>::Unit(robot.kind[i] == kSlide ? 2 : 5));
    const Vector6<T> v_J = Z[i] * robot.qd[i];
    const Vector6<T> v_p = parent(i) < 0 ? robot.base_velocity.vector() : v[parent(i)];
    v.push_back(X[i] * v_p + v_J);
    c.push_back(crossMatrix(v[i]) * v_J);
    M.push_back(massMatrix6(robot.body[i]));
    b.push_back(-(crossMatrix(v[i]).transpose() * (M[i] * v[i])));
  }
  M_A = M;
  D.resize(static_cast<std::size_t>(n), T(0));
  for (int i = n - 1; i >= 0; --i) {
    D[i] = robot.rotor[i] + Z[i].dot(M_A[i] * Z[i]);
    if (parent(i) >= 0) M_A[parent(i)] += X[i].transpose() * (P(i) * M_A[i]) * X[i];
  }
}

template <typename T>
Matrix6<T> SixVectors<T>::crossMatrix(const Vector6<T>& v) {
  const Vector3<T> linear = v.template head<3>(), angular = v.template tail<3>();
  Matrix6<T> m;
  m << skew<T>(angular), skew<T>(linear), Matrix3<T>::Zero(), skew<T>(angular);
  return m;
}

template <typename T>
Matrix6<T> SixVectors<T>::P(int i) const {
  Matrix6<T> P = Matrix6<T>::Identity();
  P -= (M_A[i] * Z[i]) * (T(1) / D[i]) * Z[i].transpose();
  return P;
}

template <typename T>
std::vector<Vector6<T>> SixVectors<T>::biasForces() const {
  std::vector<Vector6<T>> p = b;
  for (int i = n() - 1; i >= 0; --i)
    if (parent(i) >= 0) p[parent(i)] += passedOn(i, p[i]);
  return p;
}

template <typename T>
Vector6<T> SixVectors<T>::passedOn(int i, const Vector6<T>& p_i) const {
  return X[i].transpose() * (P(i) * (p_i + M_A[i] * c[i]) + M_A[i] * Z[i] * (robot.tau[i] / D[i]));
}

template <typename T>
Vector6<T> SixVectors<T>::gravityAtBase() const {
  Vector6<T> a = Vector6<T>::Zero();
  a.template head<3>() = -robot.gravity;
  return a;
}

template <typename T>
Matrix6<T> SixVectors<T>::fromBase(int i) const {
  Matrix6<T> X_i0 = Matrix6<T>::Identity();
  for (; i >= 0; i = parent(i)) X_i0 = X_i0 * X[i];
  return X_i0;
}

// over the field and in balls: compiled once (robot_in_field.cpp, robot_in_balls.cpp)

extern template MatrixX<T> inverseDense(const MatrixX<T>&);
extern template T determinant(MatrixX<T>);
extern template struct Robot<T>;
extern template struct SixVectors<T>;
extern template struct Robot<Ball>;
extern template struct SixVectors<Ball>;

}  // namespace dynwitness::audit
