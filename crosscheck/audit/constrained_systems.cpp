// SPDX-License-Identifier: GPL-3.0-or-later
// Section 10, which is a list of things to be written: constraints as equations, and local ones.
#include "crosscheck/audit/constraints.hpp"

namespace dynwitness::audit {
namespace {

/// A point of the last link held on a plane: phi = u' x(q) - h, with its first two rates.
template <typename T>
struct Plane {
  Vector3<T> u, r;
  T h;

  Jet<T> phi(const Robot<T>& robot, const std::vector<T>& qdd) const {
    const Vector3<Jet<T>> x = robot.paths(robot.qd, qdd).back().place(r);
    Jet<T> sum = constantJet<T>(-h);
    for (int i = 0; i < 3; ++i) sum += constantJet<T>(u(i)) * x(i);
    return sum;
  }
  /// dphi/dq
  VectorX<T> gradient(const Robot<T>& robot) const {
    VectorX<T> out(robot.n());
    for (int j = 0; j < robot.n(); ++j)
      out(j) = u.dot(rate<T, 3, 1>(robot.paths(robot.unit(j), robot.zeros()).back().place(r)));
    return out;
  }
  /// The same as A' a = wanted - velocity products, in the last link's axes.
  LinkConstraint<T> constraint(const Robot<T>& robot, const T& wanted) const {
    const Path<T> path = robot.paths(robot.qd, robot.zeros()).back();
    const Matrix3<T> R = path.axes();
    const Vector3<T> Ru = R.transpose() * u, w = path.omega();
    const Vector3<T> v_point = path.velocity().linear + w.cross(R * r);
    LinkConstraint<T> held;
    held.link = robot.n() - 1;
    held.A = Force<T>{Ru, r.cross(Ru)}.vector();
    held.b = VectorX<T>::Constant(1, wanted - u.dot(w.cross(v_point)));
    return held;
  }
};
Plane<T> anyPlane(Point& at) {
  const auto u = at.vector(), r = at.vector();
  return {u, r, at.number()};
}

/// qdd of M qdd + h = tau + (dphi/dq)' nu.
template <typename T>
std::vector<T> pushed(const Robot<T>& robot, const Plane<T>& plane, const T& nu) {
  Robot<T> other = robot;
  const VectorX<T> gradient = plane.gradient(robot);
  for (int i = 0; i < robot.n(); ++i) other.tau[i] += gradient(i) * nu;
  return other.accelerations();
}

/// qdd under A_1' a_1 + A_2' a_2 = b, densely. Two links share the forces nu.
template <typename T>
std::vector<T> tied(const Robot<T>& robot, const LinkConstraint<T>& one,
                    const LinkConstraint<T>& two) {
  const int n = robot.n(), m = static_cast<int>(one.A.cols());
  const MatrixX<T> J =
      robot.jacobian(one.link).transpose() * one.A + robot.jacobian(two.link).transpose() * two.A;
  const VectorX<T> x = solveAffine<T>(n + m, [&](const VectorX<T>& unknown) {
    const std::vector<T> qdd = Robot<T>::values(unknown.head(n));
    VectorX<T> residual(n + m);
    residual.head(n) = robot.forces(qdd) - Robot<T>::column(robot.tau) - J * unknown.tail(m);
    residual.tail(m) =
        constrainedAcceleration(robot, one, qdd) + constrainedAcceleration(robot, two, qdd) - one.b;
    return residual;
  });
  return Robot<T>::values(x.head(n));
}

Trials constraintLevels() {
  return Trials("constraint_levels").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
    const auto plane = anyPlane(at);
    const Jet<T> phi = plane.phi(robot, robot.qdd);
    const auto held = plane.constraint(robot, T(0));
    const auto path = robot.paths(robot.qd, robot.qdd).back();
    at.equal("rate", phi.value.derivative, T(held.A.col(0).dot(robot.velocityOf(path))));
    at.equal("second rate", phi.derivative.derivative,
             T(held.A.col(0).dot(robot.accelerationOf(path)) - held.b(0)));
  }));
}

Trials daeIndex() {
  return Trials("dae_index")
      .printed(both(exact([](Point& at) {
                      const auto robot = anyRobot(at, {kTurn, kTurn});
                      const auto plane = anyPlane(at);
                      const T nu = at.number();
                      const Jet<T> with = plane.phi(robot, pushed(robot, plane, nu)),
                                   without = plane.phi(robot, pushed(robot, plane, T(0)));
                      const VectorX<T> J = plane.gradient(robot);
                      at.equal("phi", with.value.value, without.value.value);
                      at.equal("rate", with.value.derivative, without.value.derivative);
                      at.equal("second rate",
                               T(with.derivative.derivative - without.derivative.derivative),
                               T(nu * J.dot(solveDense<T>(robot.massMatrix(), J))));
                    }),
                    differs([](Point& at) {
                      const auto robot = anyRobot(at, {kTurn, kTurn});
                      const VectorX<T> J = anyPlane(at).gradient(robot);
                      at.zero("J M^-1 J'", T(J.dot(solveDense<T>(robot.massMatrix(), J))));
                    })));
}

Trials baumgarte() {
  return Trials("baumgarte").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
    const auto plane = anyPlane(at);
    const T a = at.number(), k = at.number();
    const Jet<T> phi = plane.phi(robot, robot.zeros());
    const T wanted = -(T(2) * a * phi.value.derivative + k * k * phi.value.value);
    const Swept<T> swept(robot, {plane.constraint(robot, wanted)});
    at.equal("second rate", plane.phi(robot, swept.qdd).derivative.derivative, wanted);
  }));
}

Trials softConstraint() {
  return Trials("soft_constraint").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
    const auto held = anyConstraint<1>(at, 2);
    const T w = at.number();
    const Swept<T> hard(robot, {held});
    const std::vector<T> free = robot.accelerations();
    const T missing = (held.b - constrainedAcceleration(robot, held, free))(0);
    const T nu = missing / (hard.N(0, 0) + T(1) / w);
    const VectorX<T> J = robot.jacobian(2).transpose() * held.A;
    Robot<T> other = robot;
    for (int i = 0; i < 3; ++i) other.tau[i] += J(i) * nu;
    const std::vector<T> qdd = other.accelerations();
    const T missed = (held.b - constrainedAcceleration(robot, held, qdd))(0);
    const VectorX<T> change = Robot<T>::column(qdd) - Robot<T>::column(free);
    at.equal("stationary", VectorX<T>(robot.massMatrix() * change), VectorX<T>(J * (w * missed)));
    at.equal("missed", T(w * missed), nu);
  }));
}

Trials localConstraint() {
  return Trials("local_constraint").printed(exact([](Point& at) {
    auto robot = anyRobot(at, {kTurn, kTurn, kSlide}, Rotors::kAll, {-1, 0, 0});
    robot.gravity = Vector3<T>::Zero();
    // A_1' a_1 + A_2' a_2 = b: accelerations of two tips tied together
    const auto one = anyConstraint<2>(at, 1), two = anyConstraint<2>(at, 2);
    const SixVectors<T> six(robot);
    const auto from_one = carriedInward(six, one, six.c, true, 0),
               from_two = carriedInward(six, two, six.c, true, 0);
    const MatrixX<T> E = from_one.E[0] + from_two.E[0];
    const MatrixX<T> N = -(from_one.N_0 + from_two.N_0);
    const VectorX<T> left = one.b - from_one.beta_0 - from_two.beta_0;
    const MatrixX<T> E_N = E * inverseDense<T>(N);
    const Matrix6<T> M_k = six.M_A[0] + E_N * E.transpose();
    const Vector6<T> F_k = six.biasForces()[0] - E_N * left;
    const Vector6<T> Z = six.Z[0];
    const T qdd_0 =
        (robot.tau[0] - Z.dot(F_k + M_k * six.c[0])) / (robot.rotor[0] + Z.dot(M_k * Z));
    at.equal("qdd of the ancestor", qdd_0, tied(robot, one, two)[0]);
  }));
}

}  // namespace

std::vector<Trials> constrainedSystems() {
  return {constraintLevels(), daeIndex(), baumgarte(), softConstraint(), localConstraint()};
}

}  // namespace dynwitness::audit
