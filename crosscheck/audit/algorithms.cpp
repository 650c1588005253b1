// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 9 and 10: inverse and forward dynamics, constraints as differential-algebraic equations.
#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/robot.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::audit {
namespace {

const std::vector<JointKind> kTurns = {kTurn, kTurn, kTurn};

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

Trials tipInertia() {
  return Trials("tip_inertia")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn});
        const Matrix6<T> M_A = Matrix6<T>::Zero();
        const Vector6<T> Z = Vector6<T>::Unit(5);
        at.equal("inertia about the last joint", T(Z.dot(M_A * Z) + robot.rotor[0]),
                 robot.massMatrix()(0, 0));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn});
        const SixVectors six(robot);
        at.equal("inertia about the last joint", six.D[0], robot.massMatrix()(0, 0));
      }))
      .numbers([] {
        const OnTheBoard arm("double_pendulum");
        return Rows{{"elbow", "0", onBoard(arm.ws.D[1])}};
      });
}

Trials eq51() {
  return Trials("eq51")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, kTurns);
        auto coasting = robot;  // no joint torques are known yet
        coasting.tau = robot.zeros();
        const SixVectors<T> six(coasting);
        const std::vector<Vector6<T>> F = six.biasForces();
        const VectorX<T> truth = robot.forces(robot.qdd);
        Vector6<T> a_p = six.gravityAtBase();
        for (int i = 0; i < six.n(); ++i) {
          const Vector6<T> a = six.X[i] * a_p + six.c[i] + six.Z[i] * robot.qdd[i];
          at.equal("tau", T(six.Z[i].dot(F[i] + six.M_A[i] * (a - six.X[i] * a_p))), truth(i));
          a_p = a;
        }
      }))
      .corrected(exact([](Point& at) {
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
          robot.tau[i] = six.Z[i].dot(F[i] + six.M_A[i] * a[i]) + robot.rotor[i] * robot.qdd[i];
          at.equal("by articulated inertias", robot.tau[i], truth(i));
        }
        const recursive::Model<T> model = robot.model();
        recursive::Workspace<T> ws(model);
        std::vector<T> tau = robot.zeros();
        recursive::inverseDynamics(model, robot.x, robot.qd, robot.qdd, ws, tau);
        at.equal("our code", Robot<T>::column(tau), truth);
      }))
      .numbers([] {
        OnTheBoard arm("puma_560", 1);  // moved without torques: F as the sweep leaves it
        auto motion = arm.ws;
        const std::vector<double> qdd(arm.n(), 1.0);
        std::vector<double> tau(arm.n());
        recursive::inverseDynamics(arm.model, arm.x, arm.qd, qdd, motion, tau);
        Rows rows;
        for (std::size_t i = 0; i < arm.n(); ++i) {
          const Vector6<double> a_p = i == 0 ? arm.gravityAtBase() : motion.a[i - 1].vector();
          const Vector6<double> F =
              arm.F(i) + arm.M_A(i) * (motion.a[i].vector() - arm.T_V(i) * a_p);
          rows.push_back({std::to_string(i + 1), onBoard(F(5)), onBoard(tau[i])});
        }
        return rows;
      });
}

Trials idOrder() {
  return Trials("id_order")
      .printed(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn});
        const Vector6<T> with = SixVectors<T>(robot).biasForces()[0];
        robot.tau = robot.zeros();
        at.equal("F_1", with, SixVectors<T>(robot).biasForces()[0]);
      }))
      .corrected(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn});
        const T tau_2 = robot.tau[1];
        const Vector6<T> with = SixVectors<T>(robot).biasForces()[0];
        robot.tau = robot.zeros();
        const SixVectors<T> six(robot);
        at.equal("F_1", with,
                 Vector6<T>(six.biasForces()[0] +
                            six.X[1].transpose() * six.M_A[1] * six.Z[1] * (tau_2 / six.D[1])));
      }))
      .numbers([] {
        OnTheBoard arm("double_pendulum");
        const Vector6<double> without = arm.F(0);
        arm.tau[1] = 1;
        arm.move();
        return componentRows(kForceNames, without, arm.F(0));
      });
}

Trials sixJoints() {
  return Trials("six_joints")
      .printed(differs([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn, kTurn, kTurn, kTurn, kTurn});
        robot.R[5] = Matrix3<T>::Identity();  // axes 5 and 6 in one line
        robot.r[5] = Vector3<T>::Zero();
        at.zero("det J", determinant<T>(robot.jacobian(5)));
      }))
      .condition(differs([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn, kTurn, kTurn, kTurn, kTurn});
        at.zero("det J", determinant<T>(robot.jacobian(5)));
      }))
      .corrected(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn, kTurn, kTurn, kTurn, kTurn});
        robot.R[5] = Matrix3<T>::Identity();
        robot.r[5] = Vector3<T>::Zero();
        at.equal("columns 5 and 6", robot.jacobian(5).col(4), robot.jacobian(5).col(5));
      }));
}

Trials eq52() {
  return Trials("eq52")
      .printed(exact([](Point& at) {
        auto robot = anyRobot(at, kTurns);
        robot.tau = Robot<T>::values(robot.forces(robot.qdd));
        const SixVectors<T> six(robot);
        const std::vector<Vector6<T>> F = six.biasForces();
        Vector6<T> a = six.gravityAtBase();
        for (int i = 0; i < six.n(); ++i) {
          a = (six.X[i] * a).eval();
          at.equal("qdd", T((robot.tau[i] - six.Z[i].dot(F[i] + six.M_A[i] * a)) / six.D[i]),
                   robot.qdd[i]);
          a += six.c[i] + six.Z[i] * robot.qdd[i];
        }
      }))
      .condition(exact([](Point& at) {
        auto robot = anyRobot(at, kTurns);
        robot.qd = robot.zeros();
        robot.tau = Robot<T>::values(robot.forces(robot.qdd));
        const SixVectors<T> six(robot);
        const std::vector<Vector6<T>> F = six.biasForces();
        Vector6<T> a = six.gravityAtBase();
        for (int i = 0; i < six.n(); ++i) {
          a = (six.X[i] * a).eval();
          at.equal("qdd", T((robot.tau[i] - six.Z[i].dot(F[i] + six.M_A[i] * a)) / six.D[i]),
                   robot.qdd[i]);
          a += six.Z[i] * robot.qdd[i];
        }
      }))
      .corrected(exact([](Point& at) {
        auto robot = anyRobot(at, kMixed);
        robot.tau = Robot<T>::values(robot.forces(robot.qdd));
        const SixVectors<T> six(robot);
        const std::vector<Vector6<T>> F = six.biasForces();
        Vector6<T> a = six.gravityAtBase();
        for (int i = 0; i < six.n(); ++i) {
          a = (six.X[i] * a + six.c[i]).eval();
          at.equal("qdd", T((robot.tau[i] - six.Z[i].dot(F[i] + six.M_A[i] * a)) / six.D[i]),
                   robot.qdd[i]);
          a += six.Z[i] * robot.qdd[i];
        }
        const recursive::Model<T> model = robot.model();
        recursive::Workspace<T> ws(model);
        std::vector<T> qdd = robot.zeros();
        recursive::forwardDynamics(model, robot.x, robot.qd, robot.tau, ws, qdd);
        at.equal("our code", Robot<T>::column(qdd), Robot<T>::column(robot.qdd));
      }))
      .numbers([] {
        const OnTheBoard arm("double_pendulum", 1);
        Rows rows;
        for (std::size_t i = 0; i < arm.n(); ++i) {
          const Vector6<double> a_p =
              arm.T_V(i) * (i == 0 ? arm.gravityAtBase() : arm.ws.a[i - 1].vector());
          const Vector6<double> F = arm.F(i) + arm.M_A(i) * a_p;
          rows.push_back({std::to_string(i + 1), onBoard((arm.tau[i] - F(5)) / arm.ws.D[i]),
                          onBoard(arm.qdd[i])});
        }
        return rows;
      });
}

Trials gravityStart() {
  return Trials("gravity_start")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, kTurns);
        const SixVectors<T> six(robot);
        at.equal("tau", newtonEuler<T>(six, Vector6<T>(-six.gravityAtBase())),
                 robot.forces(robot.qdd));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, kTurns);
        const SixVectors<T> six(robot);
        at.equal("tau", newtonEuler<T>(six, six.gravityAtBase()), robot.forces(robot.qdd));
      }))
      .numbers([] {
        OnTheBoard arm("double_pendulum");
        const auto torques = [&](double sign) {
          recursive::Model<double> model = arm.model;
          model.gravity *= sign;
          std::vector<double> tau(arm.n());
          recursive::inverseDynamics(model, arm.x, arm.qd, arm.qd, arm.ws, tau);
          return tau;
        };
        const std::vector<double> printed = torques(-1), so = torques(1);
        Rows rows;
        for (std::size_t i = 0; i < arm.n(); ++i)
          rows.push_back({std::to_string(i + 1), onBoard(printed[i]), onBoard(so[i])});
        return rows;
      });
}

/// `tau_1` of a motion in which the elbow does not accelerate, with and without a rotor there.
Rows elbowRotorRows() {
  Rows rows;
  for (const double rotor : {0.0, 0.1}) {
    OnTheBoard arm("double_pendulum", 1);
    arm.model.links[1].rotor = rotor;
    arm.move();
    auto motion = arm.ws;
    const std::vector<double> qdd = {1, 0};
    std::vector<double> tau(arm.n());
    recursive::inverseDynamics(arm.model, arm.x, arm.qd, qdd, motion, tau);
    const Vector6<double> by_51 =
        arm.F(0) + arm.M_A(0) * (motion.a[0].vector() - arm.T_V(0) * arm.gravityAtBase());
    rows.push_back({onBoard(rotor), onBoard(arm.M_A(0)(5, 5)), onBoard(by_51(5)), onBoard(tau[0])});
  }
  return rows;
}

Trials inertiaSweepShared() {
  return Trials("inertia_sweep_shared")
      .printed(differs([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn});
        auto heavy = robot;  // another rotor at the last joint, which does not accelerate
        heavy.qdd[1] = T(0);
        auto light = heavy;
        light.rotor[1] = at.number();
        at.equal("tau_1", heavy.forces(heavy.qdd)(0), light.forces(light.qdd)(0));
      }))
      .corrected(both(differs([](Point& at) {
                        const auto robot = anyRobot(at, {kTurn, kTurn});
                        auto other = robot;
                        other.rotor[1] = at.number();
                        at.equal("M_A,1", SixVectors(robot).M_A[0], SixVectors(other).M_A[0]);
                      }),
                      exact([](Point& at) {
                        const auto robot = anyRobot(at, {kTurn, kTurn});
                        auto other = robot;
                        other.rotor[1] = at.number();
                        at.equal("tau_1", robot.forces(robot.qdd)(0), other.forces(other.qdd)(0));
                      })))
      .numbers(elbowRotorRows);
}

}  // namespace

std::vector<Trials> algorithms() {
  return {tipInertia(), eq51(),         idOrder(),           sixJoints(),
          eq52(),       gravityStart(), inertiaSweepShared()};
}

}  // namespace dynwitness::audit
