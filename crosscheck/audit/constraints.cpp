// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 11 to 13: constrained robots by sweeps, their base, tasks as constraints.
#include "crosscheck/audit/constraints.hpp"
#include "crosscheck/audit/ours.hpp"

#include "crosscheck/audit/board.hpp"

namespace dynwitness::audit {
namespace {

Trials eq53() {
  return Trials("eq53").printed(exact([](Point& at) {
    const auto path = anyPath(at);
    const Vector3<T> u = at.vector(), r = at.vector();
    const Vector3<T> xdd = secondRate<T, 3, 1>(path.place(r));
    const Matrix3<T> R = path.axes();
    const Vector3<T> Ru = R.transpose() * u;
    const Vector6<T> A = Force<T>{Ru, r.cross(Ru)}.vector();
    const Motion<T> a = path.acceleration();
    const Vector6<T> Xdd = Motion<T>{R.transpose() * a.linear, R.transpose() * a.angular}.vector();
    const T b = -u.dot(path.omega().cross(path.omega().cross(R * r)));
    at.equal("u' xdd", T(A.dot(Xdd) - b), T(u.dot(xdd)));
  }));
}

Trials bCurvature() {
  return Trials("b_curvature")
      .printed(exact([](Point& at) {
        // a particle that moves freely on a sphere: n unit normal, v tangent, radius rho
        const Matrix3<T> R = at.rotation();
        const Vector3<T> n = R.col(0), v = R.col(1) * at.number();
        const T rho = at.number(), b = -v.dot(v) / rho;
        const Vector3<T> xdd = n * b;  // the normal force alone acts
        const Vector3<T> tangential = xdd - n * n.dot(xdd);
        at.equal("b", b, T(tangential.dot(tangential)));
      }))
      .corrected(exact([](Point& at) {
        // the great circle as a function of time, x = rho R (cos, sin, 0)
        const Matrix3<T> R = at.rotation();
        const T rho = at.number(), w = at.number();
        const scene::CosSin<T> p = at.angle();
        const T w2 = w * w;
        const Jet<T> c = jet<T>(p.c, -p.s * w, -p.c * w2), s = jet<T>(p.s, p.c * w, -p.s * w2);
        Vector3<Jet<T>> x;
        for (int i = 0; i < 3; ++i)
          x(i) = constantJet<T>(rho * R(i, 0)) * c + constantJet<T>(rho * R(i, 1)) * s;
        const Vector3<T> n = now<T, 3, 1>(x) / rho, v = rate<T, 3, 1>(x);
        const Vector3<T> xdd = secondRate<T, 3, 1>(x);
        at.equal("b", T(n.dot(xdd)), T(-v.dot(v) / rho));
        at.zero("tangential acceleration", Vector3<T>(xdd - n * n.dot(xdd)));
      }))
      .numbers([] {
        const double speed = 1, radius = 0.5;
        return Rows{{"`b` [m/s^2]", "0", onBoard(-speed * speed / radius)}};
      });
}

Trials eq54() {
  return Trials("eq54")
      .printed(exact([](Point& at) {
        const Vector6<T> A = at.vector6();  // m = 1, the only case of fitting shapes
        const T nu = at.number();
        at.equal("A", A, Vector6<T>(A * nu));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        const auto held = anyConstraint<2>(at, 2);
        const Swept<T> swept(robot, {held});
        const VectorX<T> F_c = held.A * VectorX<T>(-swept.nu);
        at.equal("our code: tau", Robot<T>::column(robot.tau),
                 VectorX<T>(robot.forces(swept.qdd) + robot.jacobian(2).transpose() * F_c));
        at.equal("our code: A' a", constrainedAcceleration(robot, held, swept.qdd), held.b);
      }))
      .numbers([] {
        const HeldElbow elbow(0);
        const double nu = elbow.nu();
        return Rows{{"`f_x`", onBoard(elbow.held.A(0)), onBoard(elbow.held.A(0) * nu),
                     onBoard(elbow.held.A(0) * nu) + " N"}};
      });
}

Trials eq55() {
  return Trials("eq55")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn});
        const auto held = anyConstraint<1>(at, 1);
        const SixVectors<T> six(robot);
        at.equal("E_0", MatrixX<T>(six.P(0) * six.P(1) * held.A), responseToBase(robot, held));
      }))
      .condition(exact([](Point& at) {
        // P and E of both links in the axes of the base, about its origin
        const auto robot = anyRobot(at, {kTurn, kSlide});
        const auto held = anyConstraint<2>(at, 1);
        const SixVectors<T> six(robot);
        MatrixX<T> E = six.fromBase(1).transpose() * held.A;
        for (int i = 1; i >= 0; --i) {
          const MatrixX<T> T_F = six.fromBase(i).transpose();
          E = MatrixX<T>(T_F * six.P(i) * inverseDense<T>(T_F) * E);
        }
        at.equal("E_0", E, responseToBase(robot, held));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide});
        const auto held = anyConstraint<2>(at, 1);
        const auto inward = carriedInward(SixVectors<T>(robot), held);
        at.equal("E_0", inward.E_0, responseToBase(robot, held));
        at.equal("our code: E_1", MatrixX<T>(Swept<T>(robot, {held}).E[0]), inward.E[0]);
      }))
      .numbers([] {
        const HeldElbow elbow(0);
        const Vector6<double> printed = elbow.arm.P(1) * elbow.E(1);
        const SixNames names = {"`f_x`", "`f_y`", "`f_z`", "`m_x` [m]", "`m_y` [m]", "`m_z` [m]"};
        return componentRows(names, printed, elbow.E(0));
      });
}

Trials eq56() {
  return Trials("eq56")
      .printed(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn});
        robot.gravity = Vector3<T>::Zero();
        const auto held = anyConstraint<6>(at, 1);
        const std::vector<T> qdd = robot.accelerations();
        const SixVectors<T> six(robot);
        std::vector<Vector6<T>> a;  // the accelerations, were they known
        for (const auto& path : robot.paths(robot.qd, qdd)) a.push_back(robot.accelerationOf(path));
        at.equal("beta_0", carriedInward<T>(six, held, a, false).beta_0,
                 constrainedAcceleration(robot, held, qdd));
      }))
      .corrected(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        robot.gravity = Vector3<T>::Zero();
        const auto held = anyConstraint<2>(at, 2);
        at.equal("beta_0", carriedInward(SixVectors<T>(robot), held).beta_0,
                 constrainedAcceleration(robot, held, robot.accelerations()));
        // our sweep asks the free motion for it: b - beta_0 is what constraint forces have to add
        const Swept<T> swept(robot, {held});
        at.equal("our code: N nu", VectorX<T>(swept.N * swept.nu),
                 VectorX<T>(held.b - carriedInward(SixVectors<T>(robot), held).beta_0));
      }))
      .numbers([] {
        OnTheBoard arm("double_pendulum", 1);
        arm.move(recursive::Terms::none());
        Vector6<double> printed = Vector6<double>::Zero();
        Matrix6<double> E = Matrix6<double>::Identity();
        for (std::size_t i = arm.n(); i-- > 0; E = (arm.T_F(i) * arm.P(i) * E).eval()) {
          const Vector6<double> a = arm.ws.a[i].vector();  // were it known
          const double left = arm.tau[i] - OnTheBoard::Z().dot(arm.F(i) + arm.M_A(i) * a);
          printed += E * (a + OnTheBoard::Z() * (left / arm.ws.D[i]));
        }
        return componentRows(kAccelerationNames, printed, arm.ws.a[1].vector());
      });
}

Trials eq57() {
  return Trials("eq57")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        const auto held = anyConstraint<2>(at, 2);
        const MatrixX<T> J = held.A.transpose() * robot.jacobian(2);
        const MatrixX<T> N_0 = -(J * inverseDense<T>(robot.massMatrix()) * J.transpose());
        at.equal("N_0", carriedInward(SixVectors<T>(robot), held).N_0, N_0);
      }))
      .ours(ourConstraints());
}

Trials balance() {
  return Trials("balance")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn, kTurn});
        const auto held = anyConstraint<1>(at, 2);
        const SixVectors<T> six(robot);
        const CarriedInward<T> inward = carriedInward(six, held);
        const Vector6<T> Xdd_0 = -six.gravityAtBase();
        at.equal("N_0 nu", VectorX<T>(inward.N_0 * -denseConstrained(robot, {held}).nu),
                 VectorX<T>(held.b - inward.E_0.transpose() * Xdd_0 - inward.beta_0));
      }))
      .condition(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn, kTurn});
        robot.gravity = Vector3<T>::Zero();
        const auto held = anyConstraint<1>(at, 2);
        const CarriedInward<T> inward = carriedInward(SixVectors<T>(robot), held);
        at.equal("N_0 nu", VectorX<T>(inward.N_0 * -denseConstrained(robot, {held}).nu),
                 VectorX<T>(held.b - inward.beta_0));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        const auto held = anyConstraint<2>(at, 2);
        const SixVectors<T> six(robot);
        const CarriedInward<T> inward = carriedInward(six, held);
        const Vector6<T> Xdd_0 = six.gravityAtBase();
        const Vector6<T> g_N = six.fromBase(2) * -Xdd_0;
        at.equal("N_0 nu", VectorX<T>(inward.N_0 * -denseConstrained(robot, {held}).nu),
                 VectorX<T>(held.b - held.A.transpose() * g_N - inward.E_0.transpose() * Xdd_0 -
                            inward.beta_0));
      }));
}

Trials redundantQdd() {
  return Trials("redundant_qdd").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kTurn});
    const auto once = anyConstraint<1>(at, 1);
    const Swept<T> swept(robot, {once});
    // the same total, shared in any way
    const T share = at.number();
    const VectorX<T> force =
        robot.jacobian(1).transpose() *
        (once.A * (swept.nu(0) * share) + once.A * (swept.nu(0) * (T(1) - share)));
    at.equal("tau", VectorX<T>(robot.forces(swept.qdd) - Robot<T>::column(robot.tau)), force);
    at.equal("A' a", constrainedAcceleration(robot, once, swept.qdd), once.b);
  }));
}

Trials eq58() {
  return Trials("eq58")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn});
        compareOutward(at, robot, anyConstraint<1>(at, 1), Printed::kYes);
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        const auto held = anyConstraint<1>(at, 2);
        compareOutward(at, robot, held, Printed::kNo);
        at.equal("our code", Robot<T>::column(Swept<T>(robot, {held}).qdd),
                 Robot<T>::column(denseConstrained<T>(robot, {held}).qdd));
      }))
      .numbers([] {
        const HeldElbow elbow(1);
        const OnTheBoard& arm = elbow.arm;
        Rows rows;
        for (std::size_t i = 0; i < arm.n(); ++i) {
          const Vector6<double> gained =
              arm.A(i) + OnTheBoard::Z() * arm.qdd[i];  // Xdd_i - Xdd_i-1
          const Vector6<double> F = arm.F(i) + arm.M_A(i) * gained + elbow.E(i) * elbow.nu();
          rows.push_back({std::to_string(i + 1), onBoard((arm.tau[i] - F(5)) / arm.ws.D[i]),
                          onBoard(arm.qdd[i])});
        }
        return rows;
      });
}

}  // namespace

std::vector<Trials> constraints() {
  return {eq53(), bCurvature(), eq54(),         eq55(),         eq56(),
          eq57(), balance(),    definiteness(), redundantQdd(), eq58()};
}

}  // namespace dynwitness::audit
