// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 9 and 10: inverse and forward dynamics, constraints as differential-algebraic equations.
#include "crosscheck/audit/robot.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::audit {
namespace {

const std::vector<JointKind> kTurns = {kTurn, kTurn, kTurn}, kMixed = {kTurn, kSlide, kTurn};

/// tau by inward Newton-Euler with an initial acceleration of the base.
template <typename T>
VectorX<T> newtonEuler(const SixVectors<T>& six, const Vector6<T>& a_0) {
  const int n = six.n();
  std::vector<Vector6<T>> a, f = six.b;
  for (int i = 0; i < n; ++i) {
    const Vector6<T>& a_p = six.parent(i) < 0 ? a_0 : a[six.parent(i)];
    a.push_back(six.X[i] * a_p + six.c[i] + six.Z[i] * six.robot.qdd[i]);
    f[i] += six.M[i] * a[i];
  }
  VectorX<T> tau(n);
  for (int i = n - 1; i >= 0; --i) {
    tau(i) = six.Z[i].dot(f[i]) + six.robot.rotor[i] * six.robot.qdd[i];
    if (six.parent(i) >= 0) f[six.parent(i)] += six.X[i].transpose() * f[i];
  }
  return tau;
}

std::vector<Claim> inverseDynamics() {
  std::vector<Claim> claims;

  claims.push_back(
      Claim("tip_inertia", "9.1", "Where the inward sweep of articulated inertias starts")
          .printed("`M_A,N = 0` at every tip N", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, {kTurn});
                     const Matrix6<T> M_A = Matrix6<T>::Zero();
                     const Vector6<T> Z = Vector6<T>::Unit(5);
                     at.equal("inertia about the last joint", T(Z.dot(M_A * Z) + robot.rotor[0]),
                              robot.massMatrix()(0, 0));
                   }))
          .corrected("`M_A,N = M_N` at every tip (what lies beyond a tip has `M_A = 0`)",
                     exact([](auto& at) {
                       const auto robot = anyRobot(at, {kTurn});
                       const SixVectors six(robot);
                       at.equal("inertia about the last joint", six.D[0], robot.massMatrix()(0, 0));
                     }))
          .why("A sweep that starts with nothing at the tip never sees the last link, and divides "
               "by 0 at its joint when there is no rotor. The recursion (49) adds the link's own "
               "inertia, so it is the link after the last that starts with zero.")
          .in("recursive/articulated_body.hpp"));

  claims.push_back(
      Claim("eq51", "9.1", "Joint force of a given motion")
          .printed("`tau_i = Z_i' (F_i + M_A,i (Xdd_i - Xdd_(i-1)))`, swept outward",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, kTurns);
                     auto coasting = robot;  // no joint torques are known yet
                     coasting.tau = robot.zeros();
                     const SixVectors<T> six(coasting);
                     const std::vector<Vector6<T>> F = six.biasForces();
                     const VectorX<T> truth = robot.forces(robot.qdd);
                     Vector6<T> a_p = six.gravityAtBase();
                     for (int i = 0; i < six.n(); ++i) {
                       const Vector6<T> a = six.X[i] * a_p + six.c[i] + six.Z[i] * robot.qdd[i];
                       at.equal("tau", T(six.Z[i].dot(F[i] + six.M_A[i] * (a - six.X[i] * a_p))),
                                truth(i));
                       a_p = a;
                     }
                   }))
          .corrected("`f_i = M_i Xdd_i + F_b,i - F_e,i + sum of X' f_child`, "
                     "`tau_i = Z_i' f_i + d_i qdd_i`, swept inward; equal to "
                     "`Z_i' (F_i + M_A,i Xdd_i) + d_i qdd_i` with the outboard torques in `F_i`",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       auto robot = anyRobot(at, kMixed);
                       const VectorX<T> truth = robot.forces(robot.qdd);
                       {
                         const SixVectors<T> six(robot);
                         at.equal("Newton-Euler", newtonEuler<T>(six, six.gravityAtBase()), truth);
                       }
                       // from the tip inward, each torque entering the F of the links before it
                       std::vector<Vector6<T>> a;
                       for (int i = 0; i < robot.n(); ++i) {
                         const SixVectors<T> six(robot);
                         const Vector6<T> a_p = i == 0 ? six.gravityAtBase() : a[i - 1];
                         a.push_back(six.X[i] * a_p + six.c[i] + six.Z[i] * robot.qdd[i]);
                       }
                       for (int i = robot.n() - 1; i >= 0; --i) {
                         const SixVectors<T> six(robot);
                         const std::vector<Vector6<T>> F = six.biasForces();
                         robot.tau[i] =
                             six.Z[i].dot(F[i] + six.M_A[i] * a[i]) + robot.rotor[i] * robot.qdd[i];
                         at.equal("by articulated inertias", robot.tau[i], truth(i));
                       }
                     }))
          .why("An articulated inertia is felt when the joints outboard are free to give way; in "
               "inverse dynamics their motion is prescribed. Three things go wrong: the "
               "acceleration that the proximal link hands on is subtracted (and gravity with it), "
               "the rotor's share is missing, and F_i contains the torques of the joints outboard, "
               "which an outward sweep does not know yet.")
          .in("recursive/newton_euler.hpp"));

  claims.push_back(
      Claim("id_order", "9.1", "Order of the torque recursion")
          .printed("the force `F_1` of the articulated inward sweep does not depend on the torques "
                   "outboard, so `tau_1` can be found before `tau_2`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     auto robot = anyRobot(at, {kTurn, kTurn});
                     const Vector6<T> with = SixVectors<T>(robot).biasForces()[0];
                     robot.tau = robot.zeros();
                     at.equal("F_1", with, SixVectors<T>(robot).biasForces()[0]);
                   }))
          .corrected("`F_1` contains `X_2' M_A,2 Z_2 D_2^-1 tau_2`: torques are found from the "
                     "tips inward",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       auto robot = anyRobot(at, {kTurn, kTurn});
                       const T tau_2 = robot.tau[1];
                       const Vector6<T> with = SixVectors<T>(robot).biasForces()[0];
                       robot.tau = robot.zeros();
                       const SixVectors<T> six(robot);
                       at.equal(
                           "F_1", with,
                           Vector6<T>(six.biasForces()[0] + six.X[1].transpose() * six.M_A[1] *
                                                                six.Z[1] * (tau_2 / six.D[1])));
                     }))
          .why("What a motor pushes with at joint 2, link 1 feels through the joint. In inverse "
               "dynamics tau_2 is an unknown, so link 1 has to wait for it.")
          .in("recursive/newton_euler.hpp"));

  claims.push_back(
      Claim("six_joints", "9.1", "Joint accelerations of an end-effector acceleration")
          .printed("with exactly six joints `J qdd = Xdd - Jd qd` has one solution in every pose: "
                   "`det J /= 0`",
                   differs([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     auto robot = anyRobot(at, {kTurn, kTurn, kTurn, kTurn, kTurn, kTurn});
                     robot.R[5] = Matrix3<T>::Identity();  // axes 5 and 6 in one line
                     robot.r[5] = Vector3<T>::Zero();
                     at.zero("det J", determinant<T>(robot.jacobian(5)));
                   }))
          .condition("the pose is not singular (a pose drawn at random is not)",
                     differs([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto robot = anyRobot(at, {kTurn, kTurn, kTurn, kTurn, kTurn, kTurn});
                       at.zero("det J", determinant<T>(robot.jacobian(5)));
                     }))
          .corrected(
              "`det J = 0` where two axes coincide, e.g. in a stretched wrist", exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                auto robot = anyRobot(at, {kTurn, kTurn, kTurn, kTurn, kTurn, kTurn});
                robot.R[5] = Matrix3<T>::Identity();
                robot.r[5] = Vector3<T>::Zero();
                at.equal("columns 5 and 6", robot.jacobian(5).col(4), robot.jacobian(5).col(5));
              }))
          .why("The number of joints is necessary, not sufficient: when two axes fall into one "
               "line the arm loses a direction, however many joints it has.")
          .in("recursive/operational_space.hpp"));
  return claims;
}

std::vector<Claim> forwardDynamicsClaims() {
  std::vector<Claim> claims;
  claims.push_back(
      Claim("eq52", "9.2", "Joint acceleration in the outward sweep")
          .printed("`qdd_i = (d_i + Z_i' M_A,i Z_i)^-1 (tau_i - Z_i' (F_i + M_A,i Xdd_(i-1)))`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     auto robot = anyRobot(at, kTurns);
                     robot.tau = Robot<T>::values(robot.forces(robot.qdd));
                     const SixVectors<T> six(robot);
                     const std::vector<Vector6<T>> F = six.biasForces();
                     Vector6<T> a = six.gravityAtBase();
                     for (int i = 0; i < six.n(); ++i) {
                       at.equal("qdd",
                                T((robot.tau[i] - six.Z[i].dot(F[i] + six.M_A[i] * a)) / six.D[i]),
                                robot.qdd[i]);
                       a = (six.X[i] * a + six.c[i] + six.Z[i] * robot.qdd[i]).eval();
                     }
                   }))
          .condition("the robot is at rest (qd = 0) and Xdd_(i-1) has been taken to frame i",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       auto robot = anyRobot(at, kTurns);
                       robot.qd = robot.zeros();
                       robot.tau = Robot<T>::values(robot.forces(robot.qdd));
                       const SixVectors<T> six(robot);
                       const std::vector<Vector6<T>> F = six.biasForces();
                       Vector6<T> a = six.gravityAtBase();
                       for (int i = 0; i < six.n(); ++i) {
                         a = (six.X[i] * a).eval();
                         at.equal(
                             "qdd",
                             T((robot.tau[i] - six.Z[i].dot(F[i] + six.M_A[i] * a)) / six.D[i]),
                             robot.qdd[i]);
                         a += six.Z[i] * robot.qdd[i];
                       }
                     }))
          .corrected("`qdd_i = D_i^-1 (tau_i - Z_i' (F_i + M_A,i (T_V Xdd_(i-1) + A_i)))`, "
                     "`F_(i-1)` receiving `P_i M_A,i A_i` and `+ M_A,i Z_i D_i^-1 tau_i`",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       auto robot = anyRobot(at, kMixed);
                       robot.tau = Robot<T>::values(robot.forces(robot.qdd));
                       const SixVectors<T> six(robot);
                       const std::vector<Vector6<T>> F = six.biasForces();
                       Vector6<T> a = six.gravityAtBase();
                       for (int i = 0; i < six.n(); ++i) {
                         a = (six.X[i] * a + six.c[i]).eval();
                         at.equal(
                             "qdd",
                             T((robot.tau[i] - six.Z[i].dot(F[i] + six.M_A[i] * a)) / six.D[i]),
                             robot.qdd[i]);
                         a += six.Z[i] * robot.qdd[i];
                       }
                     }))
          .why("The link would move with T_V Xdd_(i-1) + A_i if its joint did not accelerate; both "
               "the change of reference point and the bias acceleration A_i of a moving robot "
               "belong to it.")
          .in("recursive/articulated_body.hpp"));

  claims.push_back(
      Claim("gravity_start", "9.2", "Gravity as an acceleration of the base")
          .printed("`Xdd_0 = g` with g the gravitational acceleration", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, kTurns);
                     const SixVectors<T> six(robot);
                     at.equal("tau", newtonEuler<T>(six, Vector6<T>(-six.gravityAtBase())),
                              robot.forces(robot.qdd));
                   }))
          .corrected("`Xdd_0 = (-g, 0)`", exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto robot = anyRobot(at, kTurns);
                       const SixVectors<T> six(robot);
                       at.equal("tau", newtonEuler<T>(six, six.gravityAtBase()),
                                robot.forces(robot.qdd));
                     }))
          .why("A robot that stands in a field g feels what it would feel without the field in a "
               "lift that accelerates upward, against g. With the other sign a robot at rest would "
               "need torques that push it down.")
          .in("recursive/newton_euler.hpp"));

  claims.push_back(
      Claim("inertia_sweep_shared", "9.2",
            "The same inertia sweep for inverse and forward dynamics")
          .printed("step 2, the articulated inertias, is a step of both: `tau_1` of a given motion "
                   "depends on `M_A,1`, and with it on the rotor of joint 2 even where `qdd_2 = 0`",
                   differs([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, {kTurn, kTurn});
                     auto heavy =
                         robot;  // another rotor at the last joint, which does not accelerate
                     heavy.qdd[1] = T(0);
                     auto light = heavy;
                     light.rotor[1] = at.number();
                     at.equal("tau_1", heavy.forces(heavy.qdd)(0), light.forces(light.qdd)(0));
                   }))
          .corrected(
              "`M_A,1` depends on the rotor of joint 2 and `tau_1` of a given motion does not",
              both(differs([](auto& at) {
                     const auto robot = anyRobot(at, {kTurn, kTurn});
                     auto other = robot;
                     other.rotor[1] = at.number();
                     at.equal("M_A,1", SixVectors(robot).M_A[0], SixVectors(other).M_A[0]);
                   }),
                   exact([](auto& at) {
                     const auto robot = anyRobot(at, {kTurn, kTurn});
                     auto other = robot;
                     other.rotor[1] = at.number();
                     at.equal("tau_1", robot.forces(robot.qdd)(0), other.forces(other.qdd)(0));
                   })))
          .why("Articulated inertias answer what happens when joints are free. A given motion "
               "leaves nothing free: rigid inertias suffice, and the sweep of step 2 is wasted "
               "work.")
          .in("recursive/newton_euler.hpp"));
  return claims;
}

}  // namespace

std::vector<Claim> algorithms() {
  std::vector<Claim> claims = inverseDynamics();
  for (Claim& claim : forwardDynamicsClaims()) claims.push_back(std::move(claim));
  return claims;
}

}  // namespace dynwitness::audit
