// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/ours.hpp"

#include <array>
#include <utility>

#include "crosscheck/audit/constraints.hpp"
#include "crosscheck/audit/lifted.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::audit {
namespace {

/// A vector in the axes that R takes its coordinates to.
template <typename Six>
Vector6<T> turnedBy(const Matrix3<T>& R, const Six& x) {
  Vector6<T> out;
  out << R * Vector3<T>(x.vector().template head<3>()),
      R * Vector3<T>(x.vector().template tail<3>());
  return out;
}

void compareProjections(Point& at, Rotors rotors) {
  const Robot<T> robot = anyRobot(at, {kTurn, kTurn}, rotors);
  const SixVectors<T> six(robot);
  const recursive::Model<T> model = robot.model();
  recursive::Workspace<T> ws(model);
  std::vector<T> qdd = robot.zeros();
  recursive::forwardDynamics(model, robot.x, robot.qd, robot.tau, ws, qdd);
  at.equal("our code: qdd", Robot<T>::column(qdd), Robot<T>::column(robot.accelerations()));
  for (int i = 0; i < 2; ++i) {
    const auto swept = recursive::sweptProjection(model, robot.x, ws, i);
    at.equal("our code: M_A", ws.M_A[i].matrix(), six.M_A[i]);
    at.equal("our code: P", swept.P, six.P(i));
    at.equal("our code: P M", swept.P_M.matrix(), Matrix6<T>(six.P(i) * six.M_A[i]));
  }
  const Matrix6<T> M = at.template symmetric<6>();
  const Vector6<T> Z = at.vector6();
  const T d = rotors == Rotors::kAll ? at.number() : T(0);
  const Matrix6<T> P = projectionOf(M, Z, d);
  at.equal("our code: P of any inertia", recursive::forceProjection<T>(M, Z, d), P);
  at.equal("our code: P M of any inertia", recursive::inertiaProjection<T>(M, Z, d),
           Matrix6<T>(P * M));
  at.equal("our code: P'", recursive::accelerationProjection<T>(M, Z, d), P.transpose());
}

}  // namespace

Trial ourTransformations() {
  return exact([](Point& at) {
    // one force and one motion, seen from two frames
    const Matrix3<T> R_1 = at.rotation(), R_2 = at.rotation();
    const Vector3<T> p_1 = at.vector(), p_2 = at.vector(), place = at.vector(), f = at.vector();
    const auto force = [&](const Matrix3<T>& R, const Vector3<T>& p) {
      return turnedBy(R.transpose(), Force<T>{f, (place - p).cross(f)});
    };
    const Path<T> path = anyPath(at);
    const Vector3<T> w = path.omega();
    const auto motion = [&](const Matrix3<T>& R, const Vector3<T>& p) {
      return turnedBy(R.transpose(),
                      Motion<T>{path.velocity().linear + w.cross(p - path.origin()), w});
    };
    const Transform<T> X_21{R_2.transpose() * R_1, R_1.transpose() * (p_2 - p_1)};
    at.equal("our code: force", force(R_2, p_2), X_21.forceMatrix() * force(R_1, p_1));
    at.equal("our code: force back", force(R_1, p_1),
             X_21.inverse().forceMatrix() * force(R_2, p_2));
    at.equal("our code: motion", motion(R_2, p_2), X_21.motionMatrix() * motion(R_1, p_1));
    at.equal("our code: motion back", motion(R_1, p_1),
             X_21.inverse().motionMatrix() * motion(R_2, p_2));
  });
}

Trial ourBodies() {
  return exact([](Point& at) {
    const Path<T> path = anyPath(at);
    const PointMasses<T> body = anyBody(at);
    const RigidInertia<T> M = body.seenFrom(path.axes(), Vector3<T>::Zero()).inertia();
    const Motion<T> v = path.velocity(), a = path.acceleration();
    const Motion<T> spatial{a.linear - v.angular.cross(v.linear), a.angular};
    at.equal("our code: force", body.force(path, path.origin()).vector(),
             (M * spatial + biasForce(M, v)).vector());
    const Matrix3<T> R = at.rotation();
    const Vector3<T> r = at.vector();
    const Transform<T> X_12 = Transform<T>{R.transpose(), r};
    at.equal(
        "our code: inertia in another frame", massMatrix6(body.seenFrom(R, r)),
        recursive::ArticulatedInertia<T>::fromRigid(X_12.inverseTimes(body.inertia())).matrix());
  });
}

Trial ourProjections(Rotors rotors) {
  return exact([rotors](Point& at) { compareProjections(at, rotors); });
}

Trial ourChain() {
  return exact([](Point& at) {
    auto robot = anyRobot(at, {kTurn, kTurn});
    robot.gravity = Vector3<T>::Zero();
    const recursive::Model<T> model = robot.model();
    recursive::Workspace<T> ws(model);
    std::vector<T> tau = robot.zeros(), qdd = tau;
    recursive::inverseDynamics(model, robot.x, robot.qd, robot.qdd, ws, tau);
    const auto paths = robot.paths(robot.qd, robot.qdd);
    at.equal("our code: Xd", ws.v[1].vector(), robot.velocityOf(paths[1]));
    at.equal("our code: Xdd", ws.a[1].vector(), robot.accelerationOf(paths[1]));
    recursive::forwardDynamics(model, robot.x, robot.qd, robot.tau, ws, qdd);
    at.equal("our code: M_A", ws.M_A[0].matrix(), SixVectors<T>(robot).M_A[0]);
  });
}

Trial ourAlgorithms() {
  return exact([](Point& at) {
    const auto robot = anyRobot(at, kMixed);
    const recursive::Model<T> model = robot.model();
    recursive::Workspace<T> ws(model);
    std::vector<T> tau = robot.zeros(), qdd = tau;
    recursive::inverseDynamics(model, robot.x, robot.qd, robot.qdd, ws, tau);
    at.equal("our code: tau", Robot<T>::column(tau), robot.forces(robot.qdd));
    recursive::forwardDynamics(model, robot.x, robot.qd, robot.tau, ws, qdd);
    at.equal("our code: qdd", Robot<T>::column(qdd), Robot<T>::column(robot.accelerations()));
  });
}

Trial ourConstraints() {
  return exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kTurn});
    const auto held = anyConstraint<1>(at, 1);
    const Swept<T> swept(robot, {held});
    const CarriedInward<T> inward = carriedInward(SixVectors<T>(robot), held);
    at.equal("our code: qdd", Robot<T>::column(swept.qdd),
             Robot<T>::column(denseConstrained<T>(robot, {held}).qdd));
    at.equal("our code: N", MatrixX<T>(-swept.N), inward.N_0);
    at.equal("our code: E_1", MatrixX<T>(swept.E[0]), inward.E[0]);
  });
}

Trial ourConsistentInverse() {
  return exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kTurn});
    const auto held = anyConstraint<1>(at, 1);
    const MatrixX<T> J = held.A.transpose() * robot.jacobian(1);
    const MatrixX<T> M_inverse_J = inverseDense<T>(robot.massMatrix()) * J.transpose();
    at.equal("our code: Jbar", sweptConsistentInverse(robot, held),
             MatrixX<T>(M_inverse_J * inverseDense<T>(MatrixX<T>(J * M_inverse_J))));
  });
}

Trial ourMassMatrix() {
  return exact([](Point& at) {
    const auto robot = anyRobot(at, kMixed);
    at.equal("our code: M", compositeMassMatrix<T>(robot.model(), robot.x), robot.massMatrix());
  });
}

Trial ourEnergies() {
  return exact([](Point& at) {
    const auto robot = anyRobot(at, kMixed);
    const auto [kinetic, potential] = energiesOf(robot, robot.qd);
    const recursive::Model<T> model = robot.model();
    recursive::Workspace<T> ws(model);
    at.equal("our code: T", recursive::kineticEnergy(model, robot.x, robot.qd, ws), kinetic);
    at.equal("our code: V", recursive::potentialEnergy(model, robot.x, ws), potential);
  });
}

Trial oursOf(const std::string& file) {
  const std::array<std::pair<const char*, Trial>, 9> files = {{
      {"spatial.hpp", both(ourTransformations(), ourBodies())},
      {"projection.hpp", ourProjections(Rotors::kAll)},
      {"model.hpp", ourChain()},
      {"newton_euler.hpp", ourAlgorithms()},
      {"articulated_body.hpp", ourAlgorithms()},
      {"constrained_dynamics.hpp", ourConstraints()},
      {"operational_space.hpp", ourConsistentInverse()},
      {"composite_body.hpp", ourMassMatrix()},
      {"energy.hpp", ourEnergies()},
  }};
  for (const auto& [name, trial] : files)
    if (file == std::string("recursive/") + name) return trial;
  return {};
}

}  // namespace dynwitness::audit
