// SPDX-License-Identifier: GPL-3.0-or-later
// Section 7: what of inertia, acceleration and force passes through a joint. The truth is the
// linear system of Newton-Euler, joint and motor (solveJoint).
#include <fmt/format.h>

#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/counting.hpp"
#include "crosscheck/audit/ours.hpp"
#include "crosscheck/audit/robot.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::audit {
namespace {

/// Any distal inertia (symmetric: a link alone or with more links beyond it), any axis, any Xdd_1.
JointProblem<T> anyProblem(Point& at, bool with_motor = false) {
  JointProblem<T> problem;
  problem.M_2 = at.template symmetric<6>();
  problem.Z = at.vector6();
  problem.Xdd_1 = at.vector6();
  if (with_motor) {
    problem.gear = at.number();
    problem.rotor = at.number();
  }
  return problem;
}
template <typename T>
T rotorInertia(const JointProblem<T>& problem) {
  return problem.gear * problem.gear * problem.rotor;
}
/// Z' M_2 Z
template <typename T>
T axisInertia(const JointProblem<T>& problem) {
  return problem.Z.dot(problem.M_2 * problem.Z);
}

/// The axis of a revolute joint along z.
template <typename T>
Vector6<T> axisZ() {
  Vector6<T> Z = Vector6<T>::Zero();
  Z(5) = T(1);
  return Z;
}

// ---- numbers for the board ---------------------------------------------------------------------

/// (32): P M of the upper link of a double pendulum, entry by entry.
Rows projectedInertiaRows() {
  OnTheBoard arm("double_pendulum");
  const Matrix6<double> M = arm.M_A(0),
                        P_M = recursive::sweptProjection(arm.model, arm.x, arm.ws, 0).P_M.matrix();
  Rows rows;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) {
      const double printed = i < 5 && j < 5 ? M(i, j) : 0;
      if (onBoard(printed) == "0" && onBoard(P_M(i, j)) == "0") continue;
      rows.push_back({fmt::format("{}{}", i + 1, j + 1), onBoard(M(i, j)), onBoard(printed),
                      onBoard(P_M(i, j))});
    }
  return rows;
}
/// (33): the inertia that the motor of each joint of an arm turns.
Rows motorInertiaRows() {
  const OnTheBoard arm("puma_560");
  Rows rows;
  for (std::size_t i = 0; i < arm.model.links.size(); ++i) {
    const double d = arm.model.links[i].rotor, link = arm.M_A(i)(5, 5);
    rows.push_back({std::to_string(i + 1), onBoard(d), onBoard(link), onBoard(link - d),
                    onBoard(arm.ws.D[i])});
  }
  return rows;
}
/// (36): the last entry of P.
Rows rotorShareRows() {
  OnTheBoard arm("puma_560");
  Rows rows;
  for (std::size_t i = 0; i < arm.model.links.size(); ++i) {
    const int link = static_cast<int>(i);
    rows.push_back({std::to_string(i + 1), onBoard(arm.model.links[i].rotor),
                    onBoard(arm.M_A(i)(5, 5)), "0",
                    onBoard(recursive::sweptProjection(arm.model, arm.x, arm.ws, link).P(5, 5))});
  }
  return rows;
}

/// What P M costs, counted: of one joint, and of all joints of robots.
Rows freeProjectionRows() {
  const Operations cost = projectionCost(false);
  return {{"multiplications", "0", std::to_string(cost.multiplications)},
          {"additions and subtractions", "0", std::to_string(cost.additions)},
          {"divisions", "0", std::to_string(cost.divisions)}};
}
Rows rotorCostRows() {
  Rows rows;
  for (const char* name : {"double_pendulum", "puma_560"}) {
    const OnTheBoard arm(name);
    const bool with_rotors = arm.model.links[0].rotor != 0;
    long all = 0;
    for (const auto& link : arm.model.links) all += projectionCost(link.rotor != 0).total();
    rows.push_back({name, std::to_string(arm.n()), with_rotors ? "yes" : "no", std::to_string(all),
                    with_rotors ? "grows with N" : "0",
                    std::to_string(projectionCost(with_rotors).total())});
  }
  return rows;
}

// ---- inertia -----------------------------------------------------------------------------------

Trials eq20() {
  return Trials("eq20").printed(exact([](Point& at) {
    const Path<T> one = anyPath(at, Start::kStandstill);
    const Matrix3<T> R = at.rotation();
    const Vector3<T> r = at.vector();
    const auto joint = anyJointMotion(at, Start::kStandstill);
    const Path<T> two = turned(one, R, r, at.angle(), joint);
    const Vector3<T> vd_1 = secondRate<T, 3, 1>(one.place(r));
    const Vector3<T> z = one.axes() * R.col(2);
    at.equal("linear", two.acceleration().linear, vd_1);
    at.equal("angular", two.acceleration().angular, one.alpha() + z * joint.qdd);
  }));
}

Trials eq21() {
  return Trials("eq21").printed(exact([](Point& at) {
    // a bearing pushes on the shaft at points of its axis, in
    // any direction
    const Vector3<T> p = at.vector(), z = at.vector();
    Force<T> F = Force<T>::zero();
    for (int k = 0; k < 3; ++k) {
      const Vector3<T> place = p + z * at.number(), f = at.vector();
      F = F + Force<T>{f, place.cross(f)};
    }
    // unit rotation about the axis through p, seen from the
    // origin
    const Motion<T> Z{p.cross(z), z};
    at.zero("Z' F", dot(Z, F));
  }));
}

Trials eq22() {
  return Trials("eq22").printed(exact([](Point& at) {
    const auto problem = anyProblem(at);
    at.equal("both sides", -problem.Z.dot(problem.M_2 * problem.Xdd_1),
             axisInertia(problem) * solveJoint(problem).qdd);
  }));
}

Trials eq23() {
  return Trials("eq23")
      .printed(exact([](Point& at) {
        const auto problem = anyProblem(at);
        at.equal("qdd", solveJoint(problem).qdd,
                 -(problem.Z.dot(problem.M_2 * problem.Xdd_1)) / axisInertia(problem));
      }))
      .ours(ourProjections(Rotors::kNone));
}

Trials eq24() {
  return Trials("eq24")
      .printed(exact([](Point& at) {
        const auto problem = anyProblem(at);
        const Matrix6<T> M_1 = at.template symmetric<6>();
        const Vector6<T> M_Z = problem.M_2 * problem.Z;
        const Matrix6<T> loss = M_Z * M_Z.transpose() / axisInertia(problem);
        at.equal("F_1", M_1 * problem.Xdd_1 + solveJoint(problem).transmitted,
                 M_1 * problem.Xdd_1 + (problem.M_2 - loss) * problem.Xdd_1);
      }))
      .ours(ourProjections(Rotors::kNone));
}

Trials eq25() {
  return Trials("eq25").printed(exact([](Point& at) {
    auto problem = anyProblem(at);
    const T s = at.number();
    const Vector6<T> x = problem.Xdd_1, y = at.vector6();
    const Vector6<T> F_x = solveJoint(problem).transmitted;
    problem.Xdd_1 = y;
    const Vector6<T> F_y = solveJoint(problem).transmitted;
    problem.Xdd_1 = x + y * s;
    at.equal("linear", solveJoint(problem).transmitted, F_x + F_y * s);
  }));
}

Trials eq26() {
  return Trials("eq26")
      .printed(exact([](Point& at) {
        const auto problem = anyProblem(at);
        const Matrix6<T> M_1 = at.template symmetric<6>();
        const Vector6<T> M_Z = problem.M_2 * problem.Z;
        const Matrix6<T> P =
            Matrix6<T>::Identity() - Matrix6<T>(M_Z * problem.Z.transpose()) / axisInertia(problem);
        const Matrix6<T> M_A1 = M_1 + P * problem.M_2;
        at.equal("F_1", M_1 * problem.Xdd_1 + solveJoint(problem).transmitted,
                 M_A1 * problem.Xdd_1);
      }))
      .ours(ourProjections(Rotors::kNone));
}

Trials eq27() {
  return Trials("eq27")
      .printed(exact([](Point& at) {
        const auto problem = anyProblem(at);
        at.equal("force", solveJoint(problem).transmitted,
                 projectionOf<T>(problem.M_2, problem.Z, T(0)) *
                     Vector6<T>(problem.M_2 * problem.Xdd_1));
      }))
      .ours(ourProjections(Rotors::kNone));
}

Trials eq28() {
  return Trials("eq28").printed(exact([](Point& at) {
    const Matrix6<T> P = projectionOf<T>(at.template symmetric<6>(), at.vector6(), T(0));
    at.equal("P P", P * P, P);
  }));
}

Trials projectionSkew() {
  return Trials("projection_skew")
      .printed(both(differs([](Point& at) {
                      const Matrix6<T> P =
                          projectionOf<T>(at.template symmetric<6>(), at.vector6(), T(0));
                      at.equal("P' and P", P.transpose(), P);
                    }),
                    exact([](Point& at) {
                      // M (P' M^-1) M = M P' and M (M^-1 P) M = P M
                      const Matrix6<T> M = at.template symmetric<6>();
                      const Matrix6<T> P = projectionOf<T>(M, at.vector6(), T(0));
                      at.equal("M P' and P M", M * P.transpose(), P * M);
                    })));
}

Trials eq29() {
  return Trials("eq29")
      .printed(exact([](Point& at) {
        const auto problem = anyProblem(at);
        const Matrix6<T> M_1 = at.template symmetric<6>();
        const Matrix6<T> M_A1 = M_1 + projectedInertia<T>(problem.M_2, problem.Z, T(0));
        at.equal("F_1", M_1 * problem.Xdd_1 + solveJoint(problem).transmitted,
                 M_A1 * problem.Xdd_1);
      }))
      .ours(ourProjections(Rotors::kNone));
}

Trials eq30() {
  return Trials("eq30").printed(exact([](Point& at) {
    const Matrix6<T> M = at.template symmetric<6>();
    const Vector6<T> Z = at.vector6();
    const Matrix6<T> P = projectionOf<T>(M, Z, T(0));
    at.equal("P M", P * M, P * M * P.transpose());
    at.equal("symmetric", P * M, (P * M).transpose());
  }));
}

Trials heavier() {
  return Trials("heavier").printed(both(
      exact([](Point& at) {
        const Vector6<T> Z = at.vector6();
        at.zero("P M Z", Vector6<T>(projectedInertia<T>(at.template symmetric<6>(), Z, T(0)) * Z));
      }),
      certified([](RealPoint& at) {
        const RigidInertia<Ball> body = RigidInertia<Ball>::aboutCenterOfMass(
            at.number(1, 2), at.vector(), Symmetric3<Ball>::diagonal(at.number(1, 2)));
        const Matrix6<Ball> M = massMatrix6<Ball>(body.mass, body.h, body.I.matrix());
        Vector6<Ball> x;
        for (int i = 0; i < 6; ++i) x(i) = at.number(-1, 1);
        const Matrix6<Ball> P_M = projectedInertia<Ball>(M, axisZ<Ball>(), Ball(0));
        at.positive("x' P_2 M_2 x", x.dot(P_M * x));
      })));
}

Trials eq31() {
  return Trials("eq31")
      .printed(exact([](Point& at) {
        const Matrix6<T> M = at.template symmetric<6>();
        Matrix6<T> P = Matrix6<T>::Identity();
        for (int i = 0; i < 6; ++i) P(i, 5) = i < 5 ? -M(i, 5) / M(5, 5) : T(0);
        at.equal("P", P, projectionOf<T>(M, axisZ<T>(), T(0)));
      }))
      .ours(ourProjections(Rotors::kNone));
}

Trials eq32() {
  return Trials("eq32")
      .printed(exact([](Point& at) {
        const Matrix6<T> M = at.template symmetric<6>();
        Matrix6<T> printed = M;
        printed.row(5).setConstant(T(0));
        printed.col(5).setConstant(T(0));
        at.equal("P M", projectedInertia<T>(M, axisZ<T>(), T(0)), printed);
      }))
      .corrected(exact([](Point& at) {
        const auto problem = [&] {
          auto p = anyProblem(at);
          p.Z = axisZ<T>();
          return p;
        }();
        const Matrix6<T>& M = problem.M_2;
        Matrix6<T> P_M;
        for (int i = 0; i < 6; ++i)
          for (int j = 0; j < 6; ++j) P_M(i, j) = M(i, j) - M(i, 5) * M(5, j) / M(5, 5);
        at.zero("last row", Vector6<T>(P_M.row(5)));
        at.zero("last column", Vector6<T>(P_M.col(5)));
        at.equal("force that passes", solveJoint(problem).transmitted, P_M * problem.Xdd_1);
        recursive::ArticulatedInertia<T> A;
        A.A = Symmetric3<T>::fromUpper(M.template block<3, 3>(0, 0));
        A.B = M.template block<3, 3>(0, 3);
        A.C = Symmetric3<T>::fromUpper(M.template block<3, 3>(3, 3));
        const Force<T> U{A.B.col(2), A.C.column(2)};
        at.equal("our code", A.minusOuter(U, T(1) / U.moment.z()).matrix(), P_M);
      }))
      .ours(ourProjections(Rotors::kNone))
      .numbers(projectedInertiaRows);
}

Trials freeProjection() {
  return Trials("free_projection")
      .printed(decided("count of operations",
                       [] {
                         const Operations cost = projectionCost(false);
                         return Decision{cost.total() == 0, "a correct one takes " + cost.text()};
                       }))
      .corrected(both(decided("count of operations",
                              [] {
                                const Operations cost = projectionCost(false);
                                return Decision{cost.multiplications == 20 &&
                                                    cost.additions == 15 && cost.divisions == 1,
                                                cost.text()};
                              }),
                      exact([](Point& at) {
                        const Matrix6<T> M = at.template symmetric<6>();
                        Matrix6<T> P_M = projectThroughZ<T>(M, T(0), false);
                        at.equal("what was counted", P_M, projectedInertia<T>(M, axisZ<T>(), T(0)));
                      })))
      .numbers(freeProjectionRows);
}

// ---- several degrees of freedom, rotors --------------------------------------------------------

/// The force through a joint with the axes Z (6 x N) that is free: Newton-Euler and Z' f = 0 as one
/// linear system in Xdd_2, f and qdd.
template <typename T>
Vector6<T> transmittedThrough(const Matrix6<T>& M, const MatrixX<T>& Z, const Vector6<T>& Xdd_1) {
  const auto n = Z.cols();
  MatrixX<T> A = MatrixX<T>::Constant(12 + n, 12 + n, T(0));
  VectorX<T> b = VectorX<T>::Constant(12 + n, T(0));
  A.block(0, 0, 6, 6) = M;
  for (int i = 0; i < 6; ++i) {
    A(i, 6 + i) = T(-1);
    A(6 + i, i) = T(1);
    for (Eigen::Index k = 0; k < n; ++k) {
      A(6 + i, 12 + k) = -Z(i, k);
      A(12 + k, 6 + i) = Z(i, k);
    }
    b(6 + i) = Xdd_1(i);
  }
  return solveDense<T>(A, b).template segment<6>(6);
}

Trials multiDof() {
  return Trials("multi_dof").printed(exact([](Point& at) {
    const Matrix6<T> M = at.template symmetric<6>();
    const MatrixX<T> Z = at.template matrix<6, 2>();
    const Vector6<T> Xdd_1 = at.vector6();
    const MatrixX<T> D = Z.transpose() * M * Z;
    const VectorX<T> rhs = Z.transpose() * M * Xdd_1;
    const Vector6<T> passed = M * Xdd_1 - M * Z * solveDense<T>(D, rhs);
    at.equal("force", transmittedThrough<T>(M, Z, Xdd_1), passed);
  }));
}

Trials sphericalJoint() {
  return Trials("spherical_joint").printed(exact([](Point& at) {
    MatrixX<T> Z = MatrixX<T>::Constant(6, 3, T(0));
    for (int i = 0; i < 3; ++i) Z(3 + i, i) = T(1);
    const auto body = anyBody(at);
    const Matrix3<T> h = skew<T>(body.firstMoment());
    const Matrix3<T> I = body.inertiaAbout(Vector3<T>::Zero());
    Matrix3<T> corner = Matrix3<T>::Identity() * body.mass();
    for (int k = 0; k < 3; ++k)
      corner.col(k) += h * Vector3<T>(solveDense<T>(I, VectorX<T>(h.col(k))));
    const Vector6<T> Xdd_1 = at.vector6();
    Vector6<T> passed = Vector6<T>::Zero();
    passed.template head<3>() = corner * Vector3<T>(Xdd_1.template head<3>());
    at.equal("one rigid link", transmittedThrough<T>(massMatrix6(body), Z, Xdd_1), passed);
    const Matrix6<T> M = at.template symmetric<6>();
    Matrix3<T> schur = M.template block<3, 3>(0, 0);
    for (int k = 0; k < 3; ++k)
      schur.col(k) -= M.template block<3, 3>(0, 3) *
                      Vector3<T>(solveDense<T>(MatrixX<T>(M.template block<3, 3>(3, 3)),
                                               VectorX<T>(M.template block<3, 1>(3, k))));
    passed.template head<3>() = schur * Vector3<T>(Xdd_1.template head<3>());
    at.equal("any inertia", transmittedThrough<T>(M, Z, Xdd_1), passed);
  }));
}

Trials gearRatio() {
  return Trials("gear_ratio").printed(exact([](Point& at) {
    // power that the shaft takes, through the derivative of its kinetic energy
    const T n = at.number(), J = at.number(), qd = at.number(), qdd = at.number();
    const Dual<T> speed = Dual<T>(n) * Dual<T>(qd, qdd);
    const Dual<T> energy = Dual<T>(J) * speed * speed / Dual<T>(T(2));
    at.equal("power", energy.derivative, n * n * J * qdd * qd);
  }));
}

void rotorForce(Point& at, int sign) {
  // what qdd follows from (33) with (21) and (20), against the system with the motor's shaft
  auto problem = anyProblem(at, true);
  problem.Z = axisZ<T>();
  const auto truth = solveJoint(problem);
  const T d = rotorInertia(problem) * T(sign);
  const Vector6<T> F_2 = problem.M_2 * truth.Xdd_2 + problem.Z * (d * truth.qdd);
  at.zero("Z' F_2", problem.Z.dot(F_2));
}

Trials eq33() {
  return Trials("eq33")
      .printed(exact([](Point& at) { rotorForce(at, -1); }))
      .corrected(exact([](Point& at) { rotorForce(at, 1); }))
      .ours(ourProjections(Rotors::kAll))
      .numbers(motorInertiaRows);
}

Trials eq34() {
  return Trials("eq34")
      .printed(exact([](Point& at) {
        const auto problem = anyProblem(at, true);
        const T d = rotorInertia(problem);
        const Vector6<T> M_Z = problem.M_2 * problem.Z;
        const Matrix6<T> loss = M_Z * M_Z.transpose() / (d + axisInertia(problem));
        at.equal("force that passes", solveJoint(problem).transmitted,
                 (problem.M_2 - loss) * problem.Xdd_1);
      }))
      .ours(ourProjections(Rotors::kAll));
}

Trials eq35() {
  return Trials("eq35")
      .printed(exact([](Point& at) {
        const auto problem = anyProblem(at, true);
        at.equal(
            "force that passes", solveJoint(problem).transmitted,
            projectedInertia<T>(problem.M_2, problem.Z, rotorInertia(problem)) * problem.Xdd_1);
      }))
      .ours(ourProjections(Rotors::kAll));
}

Trials rotorProjection() {
  return Trials("rotor_projection")
      .printed(exact([](Point& at) {
        const Matrix6<T> M = at.template symmetric<6>();
        const Matrix6<T> P = projectionOf<T>(M, at.vector6(), at.number());
        at.equal("(28)", P * P, P);
        at.equal("(30)", P * M, P * M * P.transpose());
      }))
      .condition(exact([](Point& at) {
        const Matrix6<T> M = at.template symmetric<6>();
        const Matrix6<T> P = projectionOf<T>(M, at.vector6(), T(0));
        at.equal("(28)", P * P, P);
        at.equal("(30)", P * M, P * M * P.transpose());
      }))
      .corrected(exact([](Point& at) {
        const Matrix6<T> M = at.template symmetric<6>(), one = Matrix6<T>::Identity();
        const Vector6<T> Z = at.vector6(), M_Z = M * Z;
        const T d = at.number(), D = d + Z.dot(M_Z);
        const Matrix6<T> P = projectionOf<T>(M, Z, d);
        at.zero("(P - 1)(P - d/D)", Matrix6<T>((P - one) * (P - one * (d / D))));
        at.equal("P M", P * M, P * M * P.transpose() + M_Z * M_Z.transpose() * (d / (D * D)));
        at.equal("symmetric", P * M, (P * M).transpose());
      }));
}

Trials eq36() {
  return Trials("eq36")
      .printed(exact([](Point& at) {
        const Matrix6<T> M = at.template symmetric<6>();
        const T d = at.number();
        Matrix6<T> P = Matrix6<T>::Identity();
        for (int i = 0; i < 6; ++i) P(i, 5) = i < 5 ? -M(i, 5) / (d + M(5, 5)) : T(0);
        at.equal("P", P, projectionOf<T>(M, axisZ<T>(), d));
      }))
      .corrected(exact([](Point& at) {
        const Matrix6<T> M = at.template symmetric<6>();
        const T d = at.number();
        Matrix6<T> P = Matrix6<T>::Identity();
        for (int i = 0; i < 6; ++i) P(i, 5) = (i < 5 ? -M(i, 5) : d) / (d + M(5, 5));
        at.equal("P", P, projectionOf<T>(M, axisZ<T>(), d));
      }))
      .ours(ourProjections(Rotors::kAll))
      .numbers(rotorShareRows);
}

Trials rotorCost() {
  return Trials("rotor_cost")
      .printed(decided("count of operations",
                       [] {
                         const Operations without = projectionCost(false),
                                          with = projectionCost(true);
                         return Decision{without.total() == 0 && with.total() > 0,
                                         fmt::format("without a rotor {}; with one {}",
                                                     without.text(), with.text())};
                       }))
      .corrected(decided(
          "count of operations",
          [] {
            const Operations without = projectionCost(false), with = projectionCost(true);
            return Decision{
                with.multiplications - without.multiplications == 7 &&
                    with.additions - without.additions == 1 && with.divisions == without.divisions,
                fmt::format("without a rotor {}; with one {}", without.text(), with.text())};
          }))
      .numbers(rotorCostRows);
}

Trials rotorExplicit() {
  return Trials("rotor_explicit").printed(exact([](Point& at) {
    auto problem = anyProblem(at, true);
    problem.Z = axisZ<T>();
    const Matrix6<T>& M = problem.M_2;
    const T d = rotorInertia(problem), D = d + M(5, 5);
    Matrix6<T> P_M;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        P_M(i, j) = i == 5 || j == 5 ? M(i, j) * d / D : M(i, j) - M(i, 5) * M(5, j) / D;
    at.equal("force that passes", solveJoint(problem).transmitted, P_M * problem.Xdd_1);
    at.equal("what was counted", projectThroughZ<T>(M, d, true), P_M);
  }));
}

// ---- acceleration and force --------------------------------------------------------------------

Trials eq37() {
  return Trials("eq37").printed(exact([](Point& at) {
    const Path<T> one = anyPath(at, Start::kStandstill);
    const auto joint = anyJointMotion(at, Start::kStandstill);
    const Path<T> two = slid(one, Matrix3<T>(at.rotation()), Vector3<T>(at.vector()), joint);
    // a slide this time: the point of link 1 that the joint is at now
    const Vector3<T> z = two.axes().col(2);
    const Vector3<T> vd_1 =
        one.acceleration().linear + one.alpha().cross(two.origin() - one.origin());
    at.equal("linear", two.acceleration().linear, vd_1 + z * joint.qdd);
    at.equal("angular", two.alpha(), one.alpha());
  }));
}

Trials eq38() {
  return Trials("eq38").printed(exact([](Point& at) {
    const auto problem = anyProblem(at);
    const T qdd = problem.Z.dot(problem.M_2 * problem.Xdd_1) / axisInertia(problem);
    at.equal("Xdd_2", solveJoint(problem).Xdd_2, problem.Xdd_1 - problem.Z * qdd);
  }));
}

Trials eq39() {
  return Trials("eq39").printed(exact([](Point& at) {
    const auto problem = anyProblem(at, true);
    const Matrix6<T> P = projectionOf<T>(problem.M_2, problem.Z, rotorInertia(problem));
    at.equal("Xdd_2", solveJoint(problem).Xdd_2, P.transpose() * problem.Xdd_1);
  }));
}

Trials forceSteps() {
  return Trials("force_steps").printed(exact([](Point& at) {
    auto problem = anyProblem(at);
    problem.Xdd_1 = Vector6<T>::Zero();
    problem.applied = at.vector6();
    const auto truth = solveJoint(problem);
    const T qdd = problem.Z.dot(problem.applied) / axisInertia(problem);
    at.equal("A", truth.Xdd_2, problem.Z * qdd);
    at.equal("lost", problem.applied + truth.transmitted, problem.M_2 * problem.Z * qdd);
  }));
}

Trials eq40() {
  return Trials("eq40").printed(exact([](Point& at) {
    auto problem = anyProblem(at);
    problem.Xdd_1 = Vector6<T>::Zero();
    problem.applied = at.vector6();
    // link 1 is pushed by the opposite of what it exerts on link 2
    const Vector6<T> lost =
        problem.M_2 * problem.Z * (problem.Z.dot(problem.applied) / axisInertia(problem));
    at.equal("F_1", -solveJoint(problem).transmitted, problem.applied - lost);
  }));
}

Trials eq41() {
  return Trials("eq41").printed(exact([](Point& at) {
    auto problem = anyProblem(at, true);
    problem.Xdd_1 = Vector6<T>::Zero();
    problem.applied = at.vector6();
    at.equal("F_1", -solveJoint(problem).transmitted,
             projectionOf<T>(problem.M_2, problem.Z, rotorInertia(problem)) * problem.applied);
  }));
}

Trials naiveForce() {
  return Trials("naive_force").printed(differs([](Point& at) {
    auto problem = anyProblem(at);
    problem.Z = axisZ<T>();
    problem.Xdd_1 = Vector6<T>::Zero();
    problem.applied = at.vector6();
    at.equal("F_1", -solveJoint(problem).transmitted,
             problem.applied - problem.Z * problem.Z.dot(problem.applied));
  }));
}

}  // namespace

std::vector<Trials> projections() {
  return {eq20(),
          eq21(),
          eq22(),
          eq23(),
          eq24(),
          eq25(),
          eq26(),
          eq27(),
          eq28(),
          projectionSkew(),
          eq29(),
          eq30(),
          heavier(),
          eq31(),
          eq32(),
          freeProjection(),
          multiDof(),
          sphericalJoint(),
          gearRatio(),
          eq33(),
          eq34(),
          eq35(),
          rotorProjection(),
          eq36(),
          rotorCost(),
          rotorExplicit(),
          eq37(),
          eq38(),
          eq39(),
          forceSteps(),
          eq40(),
          eq41(),
          naiveForce()};
}

}  // namespace dynwitness::audit
