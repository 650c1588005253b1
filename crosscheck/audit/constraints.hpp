// SPDX-License-Identifier: GPL-3.0-or-later
// What the statements about constrained robots share: the dense equations, the sweeps as the
// chapter writes them, and real robots for inequalities.
#pragma once

#include <utility>
#include <vector>

#include "crosscheck/audit/robot.hpp"
#include "recursive/operational_space.hpp"

namespace dynwitness::audit {

/// m constraints in any directions.
template <int M>
LinkConstraint<T> anyConstraint(Point& at, int link) {
  LinkConstraint<T> out;
  out.link = link;
  out.A = at.template matrix<6, M>();
  out.b = at.template matrix<M, 1>();
  return out;
}

/// A' a of a motion, a by differentiating places.
template <typename T>
VectorX<T> constrainedAcceleration(const Robot<T>& robot, const LinkConstraint<T>& held,
                                   const std::vector<T>& qdd) {
  return held.A.transpose() * robot.accelerationOf(robot.paths(robot.qd, qdd)[held.link]);
}

/// The motion under constraints, and the forces A nu on the links.
template <typename T>
struct Constrained {
  std::vector<T> qdd;
  VectorX<T> nu;
};

/// All at once: virtual work of the point masses and the constraints, n + m unknowns.
template <typename T>
Constrained<T> denseConstrained(const Robot<T>& robot, const std::vector<LinkConstraint<T>>& all) {
  const int n = robot.n();
  int m = 0;
  for (const auto& held : all) m += static_cast<int>(held.A.cols());
  const VectorX<T> x = solveAffine<T>(n + m, [&](const VectorX<T>& unknown) {
    const std::vector<T> qdd = Robot<T>::values(unknown.head(n));
    VectorX<T> residual(n + m);
    residual.head(n) = robot.forces(qdd) - Robot<T>::column(robot.tau);
    int row = n;
    for (const auto& held : all) {
      const Eigen::Index k = held.A.cols();
      residual.head(n) -=
          robot.jacobian(held.link).transpose() * (held.A * VectorX<T>(unknown.segment(row, k)));
      residual.segment(row, k) = constrainedAcceleration(robot, held, qdd) - held.b;
      row += static_cast<int>(k);
    }
    return residual;
  });
  return {Robot<T>::values(x.head(n)), x.tail(m)};
}

/// By recursive/constrained_dynamics.hpp.
template <typename T>
struct Swept : Constrained<T> {
  Swept(const Robot<T>& robot, const std::vector<LinkConstraint<T>>& all);
  MatrixX<T> N;
  std::vector<Eigen::Matrix<T, 6, Eigen::Dynamic>> E;  ///< what each link feels of unit forces
};

template <typename T>
Swept<T>::Swept(const Robot<T>& robot, const std::vector<LinkConstraint<T>>& all) {
  const recursive::Model<T> model = robot.model();
  int m = 0;
  for (const auto& held : all) m += static_cast<int>(held.A.cols());
  recursive::Workspace<T> ws(model);
  recursive::ConstraintWorkspace<T> cws(model, m);
  this->qdd = robot.zeros();
  recursive::constrainedForwardDynamics(model, robot.x, robot.qd, robot.tau, all, ws, cws,
                                        this->qdd);
  this->nu = cws.nu;
  N = cws.N;
  E = cws.E;
}

/// Jbar of one constraint, n x m, by recursive/operational_space.hpp.
template <typename T>
MatrixX<T> sweptConsistentInverse(const Robot<T>& robot, const LinkConstraint<T>& held) {
  const recursive::Model<T> model = robot.model();
  recursive::Workspace<T> ws(model);
  recursive::ConstraintWorkspace<T> cws(model, static_cast<int>(held.A.cols()));
  std::vector<T> qdd = robot.zeros();
  recursive::forwardDynamics(model, robot.x, robot.qd, robot.tau, ws, qdd);
  recursive::propagateConstraints(model, {held}, ws, cws);
  MatrixX<T> Jbar(robot.n(), held.A.cols());
  recursive::dynamicallyConsistentInverse(model, ws, cws, Jbar);
  return Jbar;
}

/// E_0' column by column: the acceleration along the constraints that unit accelerations of the
/// base cause when all joints are free and at rest, by point masses. 6 x m.
template <typename T>
MatrixX<T> responseToBase(Robot<T> robot, const LinkConstraint<T>& held) {
  robot.qd = robot.zeros();
  MatrixX<T> E(6, held.A.cols());
  for (int k = 0; k < 6; ++k) {
    Motion<T> base = Motion<T>::zero();
    (k < 3 ? base.linear(k) : base.angular(k - 3)) = T(1);
    const VectorX<T> qdd = solveAffine<T>(robot.n(), [&](const VectorX<T>& qdd) {
      return robot.forces(robot.qd, Robot<T>::values(qdd), Vector3<T>::Zero(), base);
    });
    const auto paths = robot.paths(robot.qd, Robot<T>::values(qdd), base);
    E.row(k) = (held.A.transpose() * robot.accelerationOf(paths[held.link])).transpose();
  }
  return E;
}

/// The chapter's inward sweeps (55) to (57), as corrected, for a constraint on one link.
template <typename T>
struct CarriedInward {
  std::vector<MatrixX<T>> E;  ///< where link i feels them; 6 x m
  MatrixX<T> E_0, N_0;        ///< N_0 with the chapter's sign
  VectorX<T> beta_0;
  std::vector<std::pair<VectorX<T>, T>> at_joints;  ///< E' Z and D of each joint
};
/// (Lazy products: Eigen's others ask scalars for ==, which balls do not have.)
/// @param a  the accelerations in alpha: by default the bias accelerations
/// @param transposed  whether (56) has E'
/// @param until  link to stop at: its E is the last, and E_0, N_0, beta_0 are those seen there
template <typename T>
CarriedInward<T> carriedInward(const SixVectors<T>& six, const LinkConstraint<T>& held,
                               const std::vector<Vector6<T>>& a, bool transposed, int until = -1) {
  const Eigen::Index m = held.A.cols();
  CarriedInward<T> out;
  out.E.assign(static_cast<std::size_t>(six.n()), MatrixX<T>::Constant(6, m, T(0)));
  out.E_0 = MatrixX<T>::Constant(6, m, T(0));
  out.N_0 = MatrixX<T>::Constant(m, m, T(0));
  out.beta_0 = VectorX<T>::Constant(m, T(0));
  const std::vector<Vector6<T>> F = six.biasForces();
  out.E[held.link] = held.A;
  for (int i = held.link; i != until; i = six.parent(i)) {
    const MatrixX<T>& E = out.E[i];
    const T left = six.robot.tau[i] - six.Z[i].dot(F[i] + six.M_A[i] * a[i]);
    const Vector6<T> alpha = a[i] + six.Z[i] * (left / six.D[i]);
    out.beta_0 += transposed ? VectorX<T>(E.transpose().lazyProduct(alpha))
                             : VectorX<T>(E.lazyProduct(alpha));
    const VectorX<T> e = E.transpose().lazyProduct(six.Z[i]);
    out.N_0 -= (e / six.D[i]).lazyProduct(e.transpose());
    out.at_joints.push_back({e, six.D[i]});
    (six.parent(i) < 0 ? out.E_0 : out.E[six.parent(i)]) =
        Matrix6<T>(six.X[i].transpose() * six.P(i)).lazyProduct(E);
  }
  return out;
}
template <typename T>
CarriedInward<T> carriedInward(const SixVectors<T>& six, const LinkConstraint<T>& held) {
  return carriedInward<T>(six, held, six.c, true);
}

enum class Printed { kYes, kNo };

/// (58), as printed with the accelerations that the dense solution gives, or corrected.
void compareOutward(Point& at, const Robot<T>& robot, const LinkConstraint<T>& held,
                    Printed printed);

/// A chain of turning joints at a random place, with positive masses and rotors.
Robot<Ball> realRobot(RealPoint& at, int n);
LinkConstraint<Ball> realConstraint(RealPoint& at, int link, int m);

/// Whether N_0 is always definite (definiteness.cpp).
Trials definiteness();

// over the field: compiled once (constraints_in_field.cpp)

extern template VectorX<T> constrainedAcceleration(const Robot<T>&, const LinkConstraint<T>&,
                                                   const std::vector<T>&);
extern template Constrained<T> denseConstrained(const Robot<T>&,
                                                const std::vector<LinkConstraint<T>>&);
extern template struct Swept<T>;
extern template MatrixX<T> sweptConsistentInverse(const Robot<T>&, const LinkConstraint<T>&);
extern template MatrixX<T> responseToBase(Robot<T>, const LinkConstraint<T>&);
extern template CarriedInward<T> carriedInward(const SixVectors<T>&, const LinkConstraint<T>&,
                                               const std::vector<Vector6<T>>&, bool, int);

}  // namespace dynwitness::audit
