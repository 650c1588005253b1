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
template <typename At>
Plane<ScalarOf<At>> anyPlane(At& at) {
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

}  // namespace

std::vector<Claim> constrainedSystems() {
  std::vector<Claim> claims;
  claims.push_back(
      Claim("constraint_levels", "10", "TODO: constraints on position, velocity and acceleration")
          .open()
          .printed("Our answer: one constraint at three levels, `phi(q) = 0`, `A' Xd = 0`, `A' Xdd "
                   "= b`: `d phi/dt = A' Xd` and `d2 phi/dt2 = A' Xdd - b` with b the velocity "
                   "products",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                     const auto plane = anyPlane(at);
                     const Jet<T> phi = plane.phi(robot, robot.qdd);
                     const auto held = plane.constraint(robot, T(0));
                     const auto path = robot.paths(robot.qd, robot.qdd).back();
                     at.equal("rate", phi.value.derivative,
                              T(held.A.col(0).dot(robot.velocityOf(path))));
                     at.equal("second rate", phi.derivative.derivative,
                              T(held.A.col(0).dot(robot.accelerationOf(path)) - held.b(0)));
                   }))
          .why("A hard constraint on positions can be obeyed through accelerations only if "
               "position and velocity obey it at the start, and only as long as integration errors "
               "are small.")
          .in("recursive/constrained_dynamics.hpp"));
  claims.push_back(
      Claim("dae_index", "10", "TODO: index of the differential-algebraic equations")
          .open()
          .printed("Our answer: `M qdd + h = tau + (dphi/dq)' nu`, `phi(q) = 0` has index 3: nu is "
                   "in neither phi nor its rate, `d2 phi/dt2` has it with the factor `(dphi/dq) "
                   "M^-1 (dphi/dq)'`, which is not 0; one differentiation more makes an ODE for nu",
                   both(exact([](auto& at) {
                          using T = ScalarOf<decltype(at)>;
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
                        differs([](auto& at) {
                          using T = ScalarOf<decltype(at)>;
                          const auto robot = anyRobot(at, {kTurn, kTurn});
                          const VectorX<T> J = anyPlane(at).gradient(robot);
                          at.zero("J M^-1 J'", T(J.dot(solveDense<T>(robot.massMatrix(), J))));
                        })))
          .why("The index counts differentiations until every unknown has an ODE. Solving for nu "
               "at the acceleration level leaves index 1 (algebraic in nu), which is what the "
               "sweeps of section 11 do.")
          .in("recursive/constrained_dynamics.hpp"));
  claims.push_back(
      Claim("baumgarte", "10", "TODO: Baumgarte stabilization")
          .open()
          .printed(
              "Our answer: with `b` lowered by `2 a d phi/dt + k^2 phi` the sweeps give "
              "`d2 phi/dt2 + 2 a d phi/dt + k^2 phi = 0`: an error decays like a damped oscillator",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                const auto plane = anyPlane(at);
                const T a = at.number(), k = at.number();
                const Jet<T> phi = plane.phi(robot, robot.zeros());
                const T wanted = -(T(2) * a * phi.value.derivative + k * k * phi.value.value);
                const Swept<T> swept(robot, {plane.constraint(robot, wanted)});
                at.equal("second rate", plane.phi(robot, swept.qdd).derivative.derivative, wanted);
              }))
          .why("With a = k = 0 an error grows like phi_0 + t phid_0. The gains are no physics: "
               "they pull the state back onto the constraint while the constraint forces do a "
               "little work.")
          .in("recursive/constrained_dynamics.hpp"));
  claims.push_back(
      Claim("soft_constraint", "10", "TODO: soft and hard constraints")
          .open()
          .printed(
              "Our answer: weight w on a missed `A' Xdd = b` in Gauss's sum gives the forces "
              "`nu = (N + 1/w)^-1 (b - A' Xdd_free)`, which `w -> infinity` makes the hard ones: "
              "`M (qdd - qdd_free) = w J' A (b - A' Xdd)`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
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
                at.equal("stationary", VectorX<T>(robot.massMatrix() * change),
                         VectorX<T>(J * (w * missed)));
                at.equal("missed", T(w * missed), nu);
              }))
          .why("A soft constraint is a compliance 1/w added to N, so it is never redundant: N + "
               "1/w is definite where N is only semidefinite.")
          .in("recursive/constrained_dynamics.hpp"));
  claims.push_back(
      Claim("local_constraint", "10", "TODO: what a local constraint is")
          .open()
          .printed("Our answer: m constraints between links whose common ancestor is link k are "
                   "solved there: `M_A,k + E N^-1 E'` and `F_k - E N^-1 (b - beta)` replace the "
                   "ancestor's inertia and bias force, and the sweeps inboard never see them",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
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
                     const T qdd_0 = (robot.tau[0] - Z.dot(F_k + M_k * six.c[0])) /
                                     (robot.rotor[0] + Z.dot(M_k * Z));
                     at.equal("qdd of the ancestor", qdd_0, tied(robot, one, two)[0]);
                   }))
          .why(
              "Only the ratio of m to n makes a constraint local in the chapter; the place does it "
              "better. An m x m system at the common ancestor, and the rest of the robot stays "
              "O(n).")
          .in("crosscheck/audit/constrained_systems.cpp"));
  return claims;
}

}  // namespace dynwitness::audit
