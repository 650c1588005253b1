// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 11 to 13: constrained robots by sweeps, their base, tasks as constraints.
#include "crosscheck/audit/constraints.hpp"

namespace dynwitness::audit {
namespace {

std::vector<Claim> underConstrained() {
  std::vector<Claim> claims;

  claims.push_back(
      Claim("eq53", "11.1", "Acceleration constraint of a link")
          .printed("`A_N' Xdd_N = b_N`; a point r of the link held on a plane with normal u has "
                   "`A = (R' u, r x R' u)` and `b = -u' (w x (w x R r))`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto path = anyPath(at);
                     const Vector3<T> u = at.vector(), r = at.vector();
                     const Vector3<T> xdd = secondRate<T, 3, 1>(path.place(r));
                     const Matrix3<T> R = path.axes();
                     const Vector3<T> Ru = R.transpose() * u;
                     const Vector6<T> A = Force<T>{Ru, r.cross(Ru)}.vector();
                     const Motion<T> a = path.acceleration();
                     const Vector6<T> Xdd =
                         Motion<T>{R.transpose() * a.linear, R.transpose() * a.angular}.vector();
                     const T b = -u.dot(path.omega().cross(path.omega().cross(R * r)));
                     at.equal("u' xdd", T(A.dot(Xdd) - b), T(u.dot(xdd)));
                   }))
          .why("The second derivative of a contact is linear in the acceleration; what depends on "
               "the velocity goes to the right. The column of A is the unit force that the plane "
               "would exert.")
          .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(
      Claim("b_curvature", "11.1", "What the right-hand side of a constraint is")
          .printed(
              "`b` is the square of the motion's geodesic curvature (times speed squared squared)",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                // a particle that moves freely on a sphere: n unit normal, v tangent, radius rho
                const Matrix3<T> R = at.rotation();
                const Vector3<T> n = R.col(0), v = R.col(1) * at.number();
                const T rho = at.number(), b = -v.dot(v) / rho;
                const Vector3<T> xdd = n * b;  // the normal force alone acts
                const Vector3<T> tangential = xdd - n * n.dot(xdd);
                at.equal("b", b, T(tangential.dot(tangential)));
              }))
          .corrected("the motion along a great circle has geodesic curvature 0 and `b = n' xdd = "
                     "-v' v / rho`, the normal curvature of the constraint times `v' v`",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       // the great circle as a function of time, x = rho R (cos, sin, 0)
                       const Matrix3<T> R = at.rotation();
                       const T rho = at.number(), w = at.number();
                       const scene::CosSin<T> p = at.angle();
                       const T w2 = w * w;
                       const Jet<T> c = jet<T>(p.c, -p.s * w, -p.c * w2),
                                    s = jet<T>(p.s, p.c * w, -p.s * w2);
                       Vector3<Jet<T>> x;
                       for (int i = 0; i < 3; ++i)
                         x(i) =
                             constantJet<T>(rho * R(i, 0)) * c + constantJet<T>(rho * R(i, 1)) * s;
                       const Vector3<T> n = now<T, 3, 1>(x) / rho, v = rate<T, 3, 1>(x);
                       const Vector3<T> xdd = secondRate<T, 3, 1>(x);
                       at.equal("b", T(n.dot(xdd)), T(-v.dot(v) / rho));
                       at.zero("tangential acceleration", Vector3<T>(xdd - n * n.dot(xdd)));
                     }))
          .why(
              "b may be negative, so it is no square. It is the acceleration that the "
              "constraint's own curvature forces on the motion; the geodesic curvature is what the "
              "motion bends within the constraint, and for a free motion that is zero.")
          .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(
      Claim("eq54", "11.1", "Constraint force as directions times magnitudes")
          .printed("`A_N = E_N nu`, with `E_N` the directions that (53) calls `A_N`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Vector6<T> A = at.vector6();  // m = 1, the only case of fitting shapes
                     const T nu = at.number();
                     at.equal("A", A, Vector6<T>(A * nu));
                   }))
          .corrected(
              "`F_c = E_N nu` with `E_N = A_N`: the force on the environment that makes "
              "`tau = M qdd + h + J' F_c`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                const auto held = anyConstraint<2>(at, 2);
                const Swept<T> swept(robot, {held});
                const VectorX<T> F_c = held.A * VectorX<T>(-swept.nu);
                at.equal("tau", Robot<T>::column(robot.tau),
                         VectorX<T>(robot.forces(swept.qdd) + robot.jacobian(2).transpose() * F_c));
                at.equal("A' a", constrainedAcceleration(robot, held, swept.qdd), held.b);
              }))
          .why(
              "A is 6 x m in (53) and E nu has one column, so the printed equation fits only for "
              "m = 1 and nu = 1. What is meant is a name for the force; an ideal constraint pushes "
              "along the same directions in which it prescribes the acceleration.")
          .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(
      Claim("eq55", "11.1", "Unit constraint forces carried inward")
          .printed("`E_i = P_(i+1) E_(i+1)`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, {kTurn, kTurn});
                     const auto held = anyConstraint<1>(at, 1);
                     const SixVectors<T> six(robot);
                     at.equal("E_0", MatrixX<T>(six.P(0) * six.P(1) * held.A),
                              responseToBase(robot, held));
                   }))
          .corrected(
              "`E_i = T_F P_(i+1) E_(i+1)`: `E_0' Xdd_0` is what an acceleration of the base "
              "causes along the constraints, all joints being free",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const auto robot = anyRobot(at, {kTurn, kSlide});
                const auto held = anyConstraint<2>(at, 1);
                at.equal("E_0", carriedInward(SixVectors<T>(robot), held).E_0,
                         responseToBase(robot, held));
              }))
          .why("P_(i+1) E_(i+1) is expressed at joint i+1; link i feels it at its own reference "
               "point. Equations (49) and (50) have the transformation.")
          .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(
      Claim("eq56", "11.1", "Constraint acceleration that the known forces cause")
          .printed("`beta_i = beta_(i+1) + E_(i+1) alpha_(i+1)`, `alpha = Xdd_(i+1) + Z D^-1 "
                   "(tau - Z' (F + M_A Xdd_(i+1)))` (six constraints, so that the shapes fit)",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     auto robot = anyRobot(at, {kTurn, kTurn});
                     robot.gravity = Vector3<T>::Zero();
                     const auto held = anyConstraint<6>(at, 1);
                     const std::vector<T> qdd = robot.accelerations();
                     const SixVectors<T> six(robot);
                     std::vector<Vector6<T>> a;  // the accelerations, were they known
                     for (const auto& path : robot.paths(robot.qd, qdd))
                       a.push_back(robot.accelerationOf(path));
                     at.equal("beta_0", carriedInward<T>(six, held, a, false).beta_0,
                              constrainedAcceleration(robot, held, qdd));
                   }))
          .corrected(
              "`beta_i = beta_(i+1) + E_(i+1)' alpha_(i+1)`, `alpha = A_(i+1) + Z D^-1 (tau - Z' "
              "(F + M_A A_(i+1)))` with the bias acceleration `A_(i+1)`; `beta_N = 0`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                robot.gravity = Vector3<T>::Zero();
                const auto held = anyConstraint<2>(at, 2);
                at.equal("beta_0", carriedInward(SixVectors<T>(robot), held).beta_0,
                         constrainedAcceleration(robot, held, robot.accelerations()));
              }))
          .why(
              "E is 6 x m, so only its transpose makes m numbers of an acceleration. And while the "
              "sweep runs inward no acceleration is known yet: what each joint adds without its "
              "proximal link accelerating is its bias acceleration. Then beta_N = 0 is the right "
              "start.")
          .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(Claim("eq57", "11.1", "Constraint acceleration of unit constraint forces")
                       .printed("`N_i = N_(i+1) - E_(i+1)' Z D^-1 Z' E_(i+1)`, `N_N = 0` (the E of "
                                "the corrected (55)): `N_0 = -A' J M^-1 J' A`",
                                exact([](auto& at) {
                                  using T = ScalarOf<decltype(at)>;
                                  const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                                  const auto held = anyConstraint<2>(at, 2);
                                  const MatrixX<T> J = held.A.transpose() * robot.jacobian(2);
                                  at.equal("N_0", carriedInward(SixVectors<T>(robot), held).N_0,
                                           MatrixX<T>(-(J * inverseDense<T>(robot.massMatrix()) *
                                                        J.transpose())));
                                }))
                       .why("nu is the load that the link puts on its environment, so the force on "
                            "the link is -E nu and its acceleration the negative of what E would "
                            "cause. N_0 is the inverse of the task's inertia, formed without M.")
                       .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(
      Claim("balance", "11.1", "Constraint forces from the balance at the base")
          .printed("`N_0 nu = b_N - E_0' Xdd_0 - beta_0` with `Xdd_0` the gravity, for a "
                   "constraint on the acceleration that one sees",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, {kTurn, kTurn, kTurn});
                     const auto held = anyConstraint<1>(at, 2);
                     const SixVectors<T> six(robot);
                     const CarriedInward<T> inward = carriedInward(six, held);
                     const Vector6<T> Xdd_0 = -six.gravityAtBase();
                     at.equal("N_0 nu",
                              VectorX<T>(inward.N_0 * -denseConstrained(robot, {held}).nu),
                              VectorX<T>(held.b - inward.E_0.transpose() * Xdd_0 - inward.beta_0));
                   }))
          .condition("without gravity", exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       auto robot = anyRobot(at, {kTurn, kTurn, kTurn});
                       robot.gravity = Vector3<T>::Zero();
                       const auto held = anyConstraint<1>(at, 2);
                       const CarriedInward<T> inward = carriedInward(SixVectors<T>(robot), held);
                       at.equal("N_0 nu",
                                VectorX<T>(inward.N_0 * -denseConstrained(robot, {held}).nu),
                                VectorX<T>(held.b - inward.beta_0));
                     }))
          .corrected("`N_0 nu = (b_N - A_N' g_N) - E_0' Xdd_0 - beta_0` with `Xdd_0 = -g` and "
                     "`g_N` gravity in the axes of link N",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                       const auto held = anyConstraint<2>(at, 2);
                       const SixVectors<T> six(robot);
                       const CarriedInward<T> inward = carriedInward(six, held);
                       const Vector6<T> Xdd_0 = six.gravityAtBase();
                       const Vector6<T> g_N = six.fromBase(2) * -Xdd_0;
                       at.equal("N_0 nu",
                                VectorX<T>(inward.N_0 * -denseConstrained(robot, {held}).nu),
                                VectorX<T>(held.b - held.A.transpose() * g_N -
                                           inward.E_0.transpose() * Xdd_0 - inward.beta_0));
                     }))
          .why("With gravity as an acceleration of the base, every acceleration in the sweeps is "
               "the true one minus g. The constraint must be shifted alike, or b = 0 would let the "
               "constrained link fall freely.")
          .in("recursive/constrained_dynamics.hpp"));
  return claims;
}

std::vector<Claim> definiteness() {
  std::vector<Claim> claims;
  claims.push_back(
      Claim("N_definite", "11.1", "Question: is N_0 always strictly definite?")
          .open()
          .printed(
              "`N_0` is negative definite by construction: `det N_0 /= 0`, even where a column of "
              "`A_N` is a combination of the others",
              differs([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const auto robot = anyRobot(at, {kTurn, kTurn, kTurn});
                auto held = anyConstraint<2>(at, 2);
                held.A.col(1) = held.A.col(0) * at.number();
                at.zero("det N_0", determinant<T>(carriedInward(SixVectors<T>(robot), held).N_0));
              }))
          .condition("the rows of `A_N' J` are linearly independent: certified, `-y' N_0 y > 0`",
                     certified([](RealPoint& at) {
                       const Robot<Ball> robot = realRobot(at, 3);
                       const LinkConstraint<Ball> held = realConstraint(at, 2, 2);
                       const auto inward = carriedInward(SixVectors<Ball>(robot), held);
                       VectorX<Ball> y(2);
                       y << at.number(-1, 1), at.number(-1, 1);
                       at.positive("-y' N_0 y", -y.dot(VectorX<Ball>(inward.N_0.lazyProduct(y))));
                     }))
          .corrected("`-y' N_0 y = sum of D_i^-1 (Z_i' E_i y)^2 = (J' A y)' M^-1 (J' A y)`: "
                     "semidefinite, and 0 exactly for forces with `J' A y = 0`, which redundant "
                     "constraints and singular poses have",
                     both(exact([](auto& at) {
                            using T = ScalarOf<decltype(at)>;
                            const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                            const auto held = anyConstraint<2>(at, 2);
                            VectorX<T> y(2);
                            y << at.number(), at.number();
                            const VectorX<T> f = robot.jacobian(2).transpose() * held.A * y;
                            const auto inward = carriedInward(SixVectors<T>(robot), held);
                            at.equal("quadratic form", T(-y.dot(VectorX<T>(inward.N_0 * y))),
                                     T(f.dot(solveDense<T>(robot.massMatrix(), f))));
                            T squares = T(0);
                            for (const auto& [e, D] : inward.at_joints)
                              squares += e.dot(y) * e.dot(y) / D;
                            at.equal("sum of squares", T(-y.dot(VectorX<T>(inward.N_0 * y))),
                                     squares);
                          }),
                          exact([](auto& at) {  // a stretched planar arm, held along itself
                            using T = ScalarOf<decltype(at)>;
                            auto robot = anyRobot(at, {kTurn, kTurn});
                            const T length = at.number();
                            for (int i = 0; i < 2; ++i) {
                              robot.R[i] = Matrix3<T>::Identity();
                              robot.r[i] = Vector3<T>(i == 0 ? T(0) : length, T(0), T(0));
                              robot.x[i] = {T(0), T(1), T(0)};
                            }
                            LinkConstraint<T> held;
                            held.link = 1;
                            held.A = Vector6<T>::Unit(0);  // through the origin, along the arm
                            held.b = VectorX<T>::Constant(1, T(0));
                            at.zero("N_0", carriedInward(SixVectors<T>(robot), held).N_0);
                          })))
          .why(
              "No: nothing in the construction makes the unit forces independent. A force that the "
              "structure carries without any joint noticing (along a stretched arm, or a "
              "combination of doubled constraints) accelerates nothing; then nu is not unique, "
              "though qdd still is.")
          .numbers(definitenessNumbers)
          .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(
      Claim("redundant_qdd", "11.1", "The motion under redundant constraints")
          .open()
          .printed("with the same constraint twice `N_0` is singular, yet every solution nu of the "
                   "balance gives the same `qdd`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto robot = anyRobot(at, {kTurn, kTurn});
                     const auto once = anyConstraint<1>(at, 1);
                     const Swept<T> swept(robot, {once});
                     // the same total, shared in any way
                     const T share = at.number();
                     const VectorX<T> force =
                         robot.jacobian(1).transpose() *
                         (once.A * (swept.nu(0) * share) + once.A * (swept.nu(0) * (T(1) - share)));
                     at.equal("tau",
                              VectorX<T>(robot.forces(swept.qdd) - Robot<T>::column(robot.tau)),
                              force);
                     at.equal("A' a", constrainedAcceleration(robot, once, swept.qdd), once.b);
                   }))
          .why("The sum that the two share is determined, their shares are not: rigid bodies "
               "cannot say how four legs of a table share a load.")
          .in("recursive/constrained_dynamics.hpp"));

  claims.push_back(
      Claim("eq58", "11.1", "Joint acceleration under constraints")
          .printed("`qdd_i = D_i^-1 (tau_i - Z_i' (F_i + M_A,i (Xdd_i - Xdd_(i-1)) + E_i nu))`",
                   exact([](auto& at) {
                     const auto robot = anyRobot(at, {kTurn, kTurn});
                     compareOutward(at, robot, anyConstraint<1>(at, 1), Printed::kYes);
                   }))
          .corrected("`qdd_i = D_i^-1 (tau_i - Z_i' (F_i + M_A,i (T_V Xdd_(i-1) + A_i) + E_i nu))`",
                     exact([](auto& at) {
                       const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                       compareOutward(at, robot, anyConstraint<1>(at, 2), Printed::kNo);
                     }))
          .why("Xdd_i contains the unknown qdd_i, so the printed right-hand side cannot be "
               "evaluated; with the values that it should have, it is not qdd_i either: the link's "
               "share of Xdd_(i-1) is subtracted where (52) adds it. What the constraint adds is "
               "the joint force Z_i' E_i nu, not the six-vector E_i nu.")
          .in("recursive/constrained_dynamics.hpp"));
  return claims;
}

}  // namespace

std::vector<Claim> constraints() {
  std::vector<Claim> claims = underConstrained();
  for (auto group : {definiteness, bases, tasks})
    for (Claim& claim : group()) claims.push_back(std::move(claim));
  return claims;
}

}  // namespace dynwitness::audit
