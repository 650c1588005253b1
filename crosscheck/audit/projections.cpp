// SPDX-License-Identifier: GPL-3.0-or-later
// Section 7: what of inertia, acceleration and force passes through a joint. The truth is the
// linear system of Newton-Euler, joint and motor (solveJoint).
#include <fmt/format.h>

#include "crosscheck/audit/counting.hpp"
#include "crosscheck/audit/truths.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::audit {
namespace {

using recursive::accelerationProjection;
using recursive::forceProjection;
using recursive::inertiaProjection;

/// Any distal inertia (symmetric: a link alone or with more links beyond it), any axis, any Xdd_1.
template <typename At>
JointProblem<ScalarOf<At>> anyProblem(At& at, bool with_motor = false) {
  JointProblem<ScalarOf<At>> problem;
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

// ---- inertia -----------------------------------------------------------------------------------

void addInertia(std::vector<Claim>* claims) {
  claims->push_back(Claim("eq20", "7.1", "Accelerations on both sides of a joint")
                        .printed("From standstill `Xdd_2 - Xdd_1 = Z qdd`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   const Path<T> one = anyPath(at, Start::kStandstill);
                                   const Matrix3<T> R = at.rotation();
                                   const Vector3<T> r = at.vector();
                                   const auto joint = anyJointMotion(at, Start::kStandstill);
                                   const Path<T> two = turned(one, R, r, at.angle(), joint);
                                   const Vector3<T> vd_1 = secondRate<T, 3, 1>(one.place(r));
                                   const Vector3<T> z = one.axes() * R.col(2);
                                   at.equal("linear", two.acceleration().linear, vd_1);
                                   at.equal("angular", two.acceleration().angular,
                                            one.alpha() + z * joint.qdd);
                                 }))
                        .why("Both accelerations are at the joint's point. In motion the bias "
                             "acceleration of (48) is added.")
                        .in("recursive/articulated_body.hpp"));

  claims->push_back(Claim("eq21", "7.1", "What a free joint cannot transmit")
                        .printed("`Z' F_2 = 0`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   // a bearing pushes on the shaft at points of its axis, in any
                                   // direction
                                   const Vector3<T> p = at.vector(), z = at.vector();
                                   Force<T> F = Force<T>::zero();
                                   for (int k = 0; k < 3; ++k) {
                                     const Vector3<T> place = p + z * at.number(), f = at.vector();
                                     F = F + Force<T>{f, place.cross(f)};
                                   }
                                   // unit rotation about the axis through p, seen from the origin
                                   const Motion<T> Z{p.cross(z), z};
                                   at.zero("Z' F", dot(Z, F));
                                 }))
                        .why("Forces through points of the axis have no moment about it. In "
                             "general: an ideal joint does no work on the motion that it leaves "
                             "free.")
                        .in("recursive/articulated_body.hpp"));

  claims->push_back(Claim("eq22", "7.1", "Equation for the joint's acceleration")
                        .printed("`-Z' M_2 Xdd_1 = Z' M_2 Z qdd`", exact([](auto& at) {
                                   const auto problem = anyProblem(at);
                                   at.equal("both sides",
                                            -problem.Z.dot(problem.M_2 * problem.Xdd_1),
                                            axisInertia(problem) * solveJoint(problem).qdd);
                                 }))
                        .why("(20) in `F_2 = M_2 Xdd_2`, and (21).")
                        .in("recursive/articulated_body.hpp"));
  claims->push_back(Claim("eq23", "7.1", "The joint's acceleration")
                        .printed("`qdd = -(Z' M_2 Z)^-1 Z' M_2 Xdd_1`", exact([](auto& at) {
                                   const auto problem = anyProblem(at);
                                   at.equal("qdd", solveJoint(problem).qdd,
                                            -(problem.Z.dot(problem.M_2 * problem.Xdd_1)) /
                                                axisInertia(problem));
                                 }))
                        .why("`Z' M_2 Z` is positive, as kinetic energy is.")
                        .in("recursive/articulated_body.hpp"));
  claims->push_back(
      Claim("eq24", "7.1", "Force that the proximal link needs")
          .printed("`F_1 = M_1 Xdd_1 + (M_2 - M_2 Z (Z' M_2 Z)^-1 Z' M_2) Xdd_1`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto problem = anyProblem(at);
                     const Matrix6<T> M_1 = at.template symmetric<6>();
                     const Vector6<T> M_Z = problem.M_2 * problem.Z;
                     const Matrix6<T> loss = M_Z * M_Z.transpose() / axisInertia(problem);
                     at.equal("F_1", M_1 * problem.Xdd_1 + solveJoint(problem).transmitted,
                              M_1 * problem.Xdd_1 + (problem.M_2 - loss) * problem.Xdd_1);
                   }))
          .why("What link 2 needs when its joint gives way as (23) says.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("eq25", "7.1", "Articulated inertia")
          .printed("`F_1 = M_A1 Xdd_1`: force is linear in the acceleration", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     auto problem = anyProblem(at);
                     const T s = at.number();
                     const Vector6<T> x = problem.Xdd_1, y = at.vector6();
                     const Vector6<T> F_x = solveJoint(problem).transmitted;
                     problem.Xdd_1 = y;
                     const Vector6<T> F_y = solveJoint(problem).transmitted;
                     problem.Xdd_1 = x + y * s;
                     at.equal("linear", solveJoint(problem).transmitted, F_x + F_y * s);
                   }))
          .why("From standstill and without loads; in motion a bias force is added.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(
      Claim("eq26", "7.1", "Articulated inertia, written out")
          .printed("`M_A1 = M_1 + (1 - M_2 Z (Z' M_2 Z)^-1 Z') M_2`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto problem = anyProblem(at);
                     const Matrix6<T> M_1 = at.template symmetric<6>();
                     const Vector6<T> M_Z = problem.M_2 * problem.Z;
                     const Matrix6<T> P =
                         Matrix6<T>::Identity() -
                         Matrix6<T>(M_Z * problem.Z.transpose()) / axisInertia(problem);
                     const Matrix6<T> M_A1 = M_1 + P * problem.M_2;
                     at.equal("F_1", M_1 * problem.Xdd_1 + solveJoint(problem).transmitted,
                              M_A1 * problem.Xdd_1);
                   }))
          .why("The bracket has to close before the last `M_2` (extracted text loses it): "
               "otherwise a mass would be subtracted from a number without unit.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("eq27", "7.1", "The projection")
          .printed("`P_2 = 1 - M_2 Z (Z' M_2 Z)^-1 Z'` takes `M_2 Xdd_1` to the force that "
                   "passes the joint",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto problem = anyProblem(at);
                     at.equal("force", solveJoint(problem).transmitted,
                              forceProjection<T>(problem.M_2, problem.Z, T(0)) *
                                  Vector6<T>(problem.M_2 * problem.Xdd_1));
                   }))
          .why("It removes from a force what the free joint gives way to. (The text after "
               "(30) refers to (27) for the articulated inertia, which is (26).)")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("eq28", "7.1", "It is a projection")
          .printed("`P_2 P_2 = P_2`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Matrix6<T> P =
                         forceProjection<T>(at.template symmetric<6>(), at.vector6(), T(0));
                     at.equal("P P", P * P, P);
                   }))
          .why("`Z' M Z (Z' M Z)^-1 = 1`: what has passed a free joint passes it again. With "
               "a rotor it does not, see rotor_projection.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("projection_skew", "7.1", "Skewed by the mass distribution")
          .printed("`P_2` is not orthogonal, `P_2' != P_2`; it is so in the metric of the mass, "
                   "`P_2' M_2^-1 = M_2^-1 P_2`",
                   both(differs([](auto& at) {
                          using T = ScalarOf<decltype(at)>;
                          const Matrix6<T> P =
                              forceProjection<T>(at.template symmetric<6>(), at.vector6(), T(0));
                          at.equal("P' and P", P.transpose(), P);
                        }),
                        exact([](auto& at) {
                          using T = ScalarOf<decltype(at)>;
                          // M (P' M^-1) M = M P' and M (M^-1 P) M = P M
                          const Matrix6<T> M = at.template symmetric<6>();
                          const Matrix6<T> P = forceProjection<T>(M, at.vector6(), T(0));
                          at.equal("M P' and P M", M * P.transpose(), P * M);
                        })))
          .why("Forces of different kinds (N and N m) have no angle between them until a mass "
               "gives them one.")
          .in("recursive/projection.hpp"));
  claims->push_back(Claim("eq29", "7.1", "Own inertia and projected part")
                        .printed("`M_A1 = M_1 + P_2 M_2`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   const auto problem = anyProblem(at);
                                   const Matrix6<T> M_1 = at.template symmetric<6>();
                                   const Matrix6<T> M_A1 =
                                       M_1 + inertiaProjection<T>(problem.M_2, problem.Z, T(0));
                                   at.equal("F_1",
                                            M_1 * problem.Xdd_1 + solveJoint(problem).transmitted,
                                            M_A1 * problem.Xdd_1);
                                 }))
                        .why("In a chain `M_2` is the articulated inertia of link 2, as in (49).")
                        .in("recursive/projection.hpp"));
  claims->push_back(Claim("eq30", "7.1", "The projected inertia is symmetric")
                        .printed("`P_2 M_2 = P_2 M_2 P_2'`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   const Matrix6<T> M = at.template symmetric<6>();
                                   const Vector6<T> Z = at.vector6();
                                   const Matrix6<T> P = forceProjection<T>(M, Z, T(0));
                                   at.equal("P M", P * M, P * M * P.transpose());
                                   at.equal("symmetric", P * M, (P * M).transpose());
                                 }))
                        .why("`P M = M P'` and `P P = P`. With a rotor `P M` is still symmetric "
                             "and this equation is wrong, see rotor_projection.")
                        .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("heavier", "7.1", "The joint makes link 1 heavier")
          .printed(
              "`x' M_A1 x >= x' M_1 x` for all accelerations `x`, equal for `x` along `Z`: turning "
              "about the joint's own axis, link 1 does not feel link 2",
              both(exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Vector6<T> Z = at.vector6();
                     at.zero(
                         "P M Z",
                         Vector6<T>(inertiaProjection<T>(at.template symmetric<6>(), Z, T(0)) * Z));
                   }),
                   certified([](RealPoint& at) {
                     const RigidInertia<Ball> body = RigidInertia<Ball>::aboutCenterOfMass(
                         at.number(1, 2), at.vector(), Symmetric3<Ball>::diagonal(at.number(1, 2)));
                     const Matrix6<Ball> M = massMatrix6<Ball>(body.mass, body.h, body.I.matrix());
                     Vector6<Ball> x;
                     for (int i = 0; i < 6; ++i) x(i) = at.number(-1, 1);
                     const Matrix6<Ball> P_M = inertiaProjection<Ball>(M, axisZ<Ball>(), Ball(0));
                     at.positive("x' P_2 M_2 x", x.dot(P_M * x));
                   })))
          .why("`P_2 M_2` has rank five for a joint with one degree of freedom: positive "
               "semidefinite, not definite. Heavier, then, in five directions of six.")
          .in("recursive/projection.hpp"));

  claims->push_back(
      Claim("eq31", "7.1", "P in joint coordinates")
          .printed(
              "With `Z = (0, 0, 0, 0, 0, 1)`: `P_2` is the unit matrix but for its last column, "
              "`-m_i6/m_66` and last 0",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const Matrix6<T> M = at.template symmetric<6>();
                Matrix6<T> P = Matrix6<T>::Identity();
                for (int i = 0; i < 6; ++i) P(i, 5) = i < 5 ? -M(i, 5) / M(5, 5) : T(0);
                at.equal("P", P, forceProjection<T>(M, axisZ<T>(), T(0)));
              }))
          .why("`M_2 Z` is the last column of `M_2`, and `Z'` picks the last component.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("eq32", "7.1", "Projected inertia in joint coordinates")
          .printed("`(P_2 M_2)_ij = m_ij` for `i, j <= 5`, last row and column 0",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Matrix6<T> M = at.template symmetric<6>();
                     Matrix6<T> printed = M;
                     printed.row(5).setConstant(T(0));
                     printed.col(5).setConstant(T(0));
                     at.equal("P M", inertiaProjection<T>(M, axisZ<T>(), T(0)), printed);
                   }))
          .corrected("`(P_2 M_2)_ij = m_ij - m_i6 m_6j/m_66`: the last row and column become 0 by "
                     "themselves",
                     exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto problem = [&] {
                         auto p = anyProblem(at);
                         p.Z = axisZ<T>();
                         return p;
                       }();
                       const Matrix6<T>& M = problem.M_2;
                       Matrix6<T> P_M;
                       for (int i = 0; i < 6; ++i)
                         for (int j = 0; j < 6; ++j)
                           P_M(i, j) = M(i, j) - M(i, 5) * M(5, j) / M(5, 5);
                       at.zero("last row", Vector6<T>(P_M.row(5)));
                       at.zero("last column", Vector6<T>(P_M.col(5)));
                       at.equal("force that passes", solveJoint(problem).transmitted,
                                P_M * problem.Xdd_1);
                       recursive::ArticulatedInertia<T> A;
                       A.A = Symmetric3<T>::fromUpper(M.template block<3, 3>(0, 0));
                       A.B = M.template block<3, 3>(0, 3);
                       A.C = Symmetric3<T>::fromUpper(M.template block<3, 3>(3, 3));
                       const Force<T> U{A.B.col(2), A.C.column(2)};
                       at.equal("our code", A.minusOuter(U, T(1) / U.moment.z()).matrix(), P_M);
                     }))
          .why("(31) times `M_2` subtracts from row `i` the multiple `m_i6/m_66` of the last row. "
               "The printed matrix is right only where `m_i6 = 0`: an axis through the centre of "
               "mass along a principal axis.")
          .in("recursive/spatial.hpp"));
  claims->push_back(
      Claim("free_projection", "7.1", "Cost of projecting the inertia")
          .printed(
              "Finding `P_2 M_2` takes no computation at all",
              decided("count of operations",
                      [] {
                        const Operations cost = projectionCost(false);
                        return Decision{cost.total() == 0, "a correct one takes " + cost.text()};
                      }))
          .corrected(
              "It takes 15 multiplications and 15 subtractions for the symmetric 5 x 5 part, 5 "
              "multiplications for the column and 1 division",
              both(decided("count of operations",
                           [] {
                             const Operations cost = projectionCost(false);
                             return Decision{cost.multiplications == 20 && cost.additions == 15 &&
                                                 cost.divisions == 1,
                                             cost.text()};
                           }),
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Matrix6<T> M = at.template symmetric<6>();
                     Matrix6<T> P_M = projectThroughZ<T>(M, T(0), false);
                     at.equal("what was counted", P_M, inertiaProjection<T>(M, axisZ<T>(), T(0)));
                   })))
          .why("(32) looks free because it forgets the products.")
          .in("crosscheck/audit/counting.hpp"));
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

void addJointKinds(std::vector<Claim>* claims) {
  claims->push_back(
      Claim("multi_dof", "7.1.1", "Joints with several degrees of freedom")
          .printed("With `Z` of size 6 x N: `P_2 = 1 - M_2 Z (Z' M_2 Z)^-1 Z'`, a matrix inverse",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Matrix6<T> M = at.template symmetric<6>();
                     const MatrixX<T> Z = at.template matrix<6, 2>();
                     const Vector6<T> Xdd_1 = at.vector6();
                     const MatrixX<T> D = Z.transpose() * M * Z;
                     const VectorX<T> rhs = Z.transpose() * M * Xdd_1;
                     const Vector6<T> passed = M * Xdd_1 - M * Z * solveDense<T>(D, rhs);
                     at.equal("force", transmittedThrough<T>(M, Z, Xdd_1), passed);
                   }))
          .why("`Z' M_2 Z` is N x N and positive definite, so it has an inverse.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("spherical_joint", "7.1.1", "TODO: P M for a spherical joint")
          .open()
          .printed(
              "For a spherical joint, `Z = [0; 1]`, the general formula gives `P_2 M_2` "
              "explicitly: `[A - B C^-1 B', 0; 0, 0]` for `M_2 = [A, B; B', C]`; for one rigid "
              "link `m 1 + m^2 hat(r_c) I^-1 hat(r_c)` in the corner",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
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
                at.equal("one rigid link", transmittedThrough<T>(massMatrix6(body), Z, Xdd_1),
                         passed);
                const Matrix6<T> M = at.template symmetric<6>();
                Matrix3<T> schur = M.template block<3, 3>(0, 0);
                for (int k = 0; k < 3; ++k)
                  schur.col(k) -=
                      M.template block<3, 3>(0, 3) *
                      Vector3<T>(solveDense<T>(MatrixX<T>(M.template block<3, 3>(3, 3)),
                                               VectorX<T>(M.template block<3, 1>(3, k))));
                passed.template head<3>() = schur * Vector3<T>(Xdd_1.template head<3>());
                at.equal("any inertia", transmittedThrough<T>(M, Z, Xdd_1), passed);
              }))
          .why("Only a force passes, no moment. What is left of a rigid link is its effective mass "
               "at the joint: the mass alone when the joint is at its centre of mass, `r_c = 0`.")
          .in("crosscheck/audit/projections.cpp"));

  claims->push_back(
      Claim("gear_ratio", "7.1.2", "A motor behind a gear")
          .printed("The joint feels the shaft's inertia times the square of the gear ratio, "
                   "`d = n^2 J`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     // power that the shaft takes, through the derivative of its kinetic energy
                     const T n = at.number(), J = at.number(), qd = at.number(), qdd = at.number();
                     const Dual<T> speed = Dual<T>(n) * Dual<T>(qd, qdd);
                     const Dual<T> energy = Dual<T>(J) * speed * speed / Dual<T>(T(2));
                     at.equal("power", energy.derivative, n * n * J * qdd * qd);
                   }))
          .why("The gear multiplies the shaft's speed by `n` and its torque by `n` again.")
          .in("recursive/newton_euler.hpp"));

  const auto rotorForce = [](auto& at, int sign) {
    using T = ScalarOf<decltype(at)>;
    // what qdd follows from (33) with (21) and (20), against the system with the motor's shaft
    auto problem = anyProblem(at, true);
    problem.Z = axisZ<T>();
    const auto truth = solveJoint(problem);
    const T d = rotorInertia(problem) * T(sign);
    const Vector6<T> F_2 = problem.M_2 * truth.Xdd_2 + problem.Z * (d * truth.qdd);
    at.zero("Z' F_2", problem.Z.dot(F_2));
  };
  claims->push_back(
      Claim("eq33", "7.1.2", "Force that also accelerates the motor's shaft")
          .printed("`F_2 = M_2 Xdd_2 - d qdd Z` in `Z' F_2 = 0`",
                   exact([rotorForce](auto& at) { rotorForce(at, -1); }))
          .corrected("`F_2 = M_2 Xdd_2 + d qdd Z` in `Z' F_2 = 0`: the force on link 2 itself "
                     "is `M_2 Xdd_2`, with `Z' M_2 Xdd_2 = -d qdd`",
                     exact([rotorForce](auto& at) { rotorForce(at, 1); }))
          .why("With the printed sign `d` is subtracted from `Z' M_2 Z`: the rotor would make "
               "the joint lighter. (34), (35) and (52) have it right.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(
      Claim("eq34", "7.1.2", "Articulated inertia with a rotor")
          .printed("`M_A1 = M_1 + M_2 - M_2 Z (d + Z' M_2 Z)^-1 Z' M_2`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto problem = anyProblem(at, true);
                     const T d = rotorInertia(problem);
                     const Vector6<T> M_Z = problem.M_2 * problem.Z;
                     const Matrix6<T> loss = M_Z * M_Z.transpose() / (d + axisInertia(problem));
                     at.equal("force that passes", solveJoint(problem).transmitted,
                              (problem.M_2 - loss) * problem.Xdd_1);
                   }))
          .why("The rotor holds the joint back, so more of link 2 is felt. As everywhere in the "
               "chapter, the shaft's gyroscopic moment on link 1 is neglected.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("eq35", "7.1.2", "The projection with a rotor")
          .printed("`P_2 = 1 - M_2 Z (d + Z' M_2 Z)^-1 Z'`, so that `M_A1 = M_1 + P_2 M_2`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto problem = anyProblem(at, true);
                     at.equal("force that passes", solveJoint(problem).transmitted,
                              inertiaProjection<T>(problem.M_2, problem.Z, rotorInertia(problem)) *
                                  problem.Xdd_1);
                   }))
          .why("Right as a factor of `M_2`. It is no projection any more: see rotor_projection.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("rotor_projection", "7.1.2", "Whether P with a rotor is a projection")
          .printed("The `P_2` of (35) is a projection operator: (28) `P_2 P_2 = P_2` and (30) "
                   "`P_2 M_2 = P_2 M_2 P_2'`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Matrix6<T> M = at.template symmetric<6>();
                     const Matrix6<T> P = forceProjection<T>(M, at.vector6(), at.number());
                     at.equal("(28)", P * P, P);
                     at.equal("(30)", P * M, P * M * P.transpose());
                   }))
          .condition("`d = 0`: no rotor", exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const Matrix6<T> M = at.template symmetric<6>();
                       const Matrix6<T> P = forceProjection<T>(M, at.vector6(), T(0));
                       at.equal("(28)", P * P, P);
                       at.equal("(30)", P * M, P * M * P.transpose());
                     }))
          .corrected(
              "`(P_2 - 1)(P_2 - d/D) = 0` with `D = d + Z' M_2 Z`: where a projection has the "
              "eigenvalue 0, `P_2` has `d/D`; and `P_2 M_2 = P_2 M_2 P_2' + d M_2 Z Z' M_2/D^2`, "
              "which is symmetric",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const Matrix6<T> M = at.template symmetric<6>(), one = Matrix6<T>::Identity();
                const Vector6<T> Z = at.vector6(), M_Z = M * Z;
                const T d = at.number(), D = d + Z.dot(M_Z);
                const Matrix6<T> P = forceProjection<T>(M, Z, d);
                at.zero("(P - 1)(P - d/D)", Matrix6<T>((P - one) * (P - one * (d / D))));
                at.equal("P M", P * M,
                         P * M * P.transpose() + M_Z * M_Z.transpose() * (d / (D * D)));
                at.equal("symmetric", P * M, (P * M).transpose());
              }))
          .why("A rotor gives way only in part: of a moment about the axis the share `d/D` passes, "
               "and of that again the share `d/D` through the same joint.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("eq36", "7.1.2", "P with a rotor in joint coordinates")
          .printed(
              "`P_2` is the unit matrix but for its last column, `-m_i6/(d + m_66)` and last 0",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const Matrix6<T> M = at.template symmetric<6>();
                const T d = at.number();
                Matrix6<T> P = Matrix6<T>::Identity();
                for (int i = 0; i < 6; ++i) P(i, 5) = i < 5 ? -M(i, 5) / (d + M(5, 5)) : T(0);
                at.equal("P", P, forceProjection<T>(M, axisZ<T>(), d));
              }))
          .corrected("The last entry is `1 - m_66/(d + m_66) = d/(d + m_66)`", exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const Matrix6<T> M = at.template symmetric<6>();
                       const T d = at.number();
                       Matrix6<T> P = Matrix6<T>::Identity();
                       for (int i = 0; i < 6; ++i) P(i, 5) = (i < 5 ? -M(i, 5) : d) / (d + M(5, 5));
                       at.equal("P", P, forceProjection<T>(M, axisZ<T>(), d));
                     }))
          .why("A moment about the axis is not lost when there is a rotor: the share that the "
               "rotor holds passes to link 1.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("rotor_cost", "7.1.2", "What a rotor costs")
          .printed("`P_2 M_2` costs O(N) with a rotor and O(0) without",
                   decided("count of operations",
                           [] {
                             const Operations without = projectionCost(false),
                                              with = projectionCost(true);
                             return Decision{without.total() == 0 && with.total() > 0,
                                             fmt::format("without a rotor {}; with one {}",
                                                         without.text(), with.text())};
                           }))
          .corrected(
              "Both cost the same few operations a joint, whatever the number of links; the rotor "
              "adds the last row and column, 7 multiplications, and one addition",
              decided("count of operations",
                      [] {
                        const Operations without = projectionCost(false),
                                         with = projectionCost(true);
                        return Decision{with.multiplications - without.multiplications == 7 &&
                                            with.additions - without.additions == 1 &&
                                            with.divisions == without.divisions,
                                        fmt::format("without a rotor {}; with one {}",
                                                    without.text(), with.text())};
                      }))
          .why("What grows with N is the number of joints, with a rotor or without.")
          .in("crosscheck/audit/counting.hpp"));
  claims->push_back(
      Claim("rotor_explicit", "7.1.2", "TODO: P M with a rotor")
          .open()
          .printed(
              "In joint coordinates `(P_2 M_2)_ij = m_ij - m_i6 m_6j/(d + m_66)`; the last row and "
              "column are `m_6j d/(d + m_66)`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                auto problem = anyProblem(at, true);
                problem.Z = axisZ<T>();
                const Matrix6<T>& M = problem.M_2;
                const T d = rotorInertia(problem), D = d + M(5, 5);
                Matrix6<T> P_M;
                for (int i = 0; i < 6; ++i)
                  for (int j = 0; j < 6; ++j)
                    P_M(i, j) =
                        i == 5 || j == 5 ? M(i, j) * d / D : M(i, j) - M(i, 5) * M(5, j) / D;
                at.equal("force that passes", solveJoint(problem).transmitted, P_M * problem.Xdd_1);
                at.equal("what was counted", projectThroughZ<T>(M, d, true), P_M);
              }))
          .why("With `d` large the joint is locked and all of `M_2` is felt; with `d = 0` it is "
               "(32), corrected.")
          .in("recursive/projection.hpp"));
}

// ---- acceleration and force --------------------------------------------------------------------

void addOutAndIn(std::vector<Claim>* claims) {
  claims->push_back(
      Claim("eq37", "7.2", "Acceleration of the distal link")
          .printed("`Xdd_2 = Xdd_1 + Z qdd`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Path<T> one = anyPath(at, Start::kStandstill);
                     const auto joint = anyJointMotion(at, Start::kStandstill);
                     const Path<T> two =
                         slid(one, Matrix3<T>(at.rotation()), Vector3<T>(at.vector()), joint);
                     // a slide this time: the point of link 1 that the joint is at now
                     const Vector3<T> z = two.axes().col(2);
                     const Vector3<T> vd_1 =
                         one.acceleration().linear + one.alpha().cross(two.origin() - one.origin());
                     at.equal("linear", two.acceleration().linear, vd_1 + z * joint.qdd);
                     at.equal("angular", two.alpha(), one.alpha());
                   }))
          .why("(20), from standstill. It needs no particular kind of joint.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(
      Claim("eq38", "7.2", "The same without qdd")
          .printed("`Xdd_2 = (1 - Z (Z' M_2 Z)^-1 Z' M_2) Xdd_1`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto problem = anyProblem(at, true);
                     const T qdd =
                         problem.Z.dot(problem.M_2 * problem.Xdd_1) / axisInertia(problem);
                     at.equal("Xdd_2", solveJoint(problem).Xdd_2, problem.Xdd_1 - problem.Z * qdd);
                   }))
          .condition(
              "`d = 0`: no rotor (and no motor torque)", exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                const auto problem = anyProblem(at);
                const T qdd = problem.Z.dot(problem.M_2 * problem.Xdd_1) / axisInertia(problem);
                at.equal("Xdd_2", solveJoint(problem).Xdd_2, problem.Xdd_1 - problem.Z * qdd);
              }))
          .corrected("`Xdd_2 = (1 - Z (d + Z' M_2 Z)^-1 Z' M_2) Xdd_1`", exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto problem = anyProblem(at, true);
                       const T D = rotorInertia(problem) + axisInertia(problem);
                       const T qdd = problem.Z.dot(problem.M_2 * problem.Xdd_1) / D;
                       at.equal("Xdd_2", solveJoint(problem).Xdd_2,
                                problem.Xdd_1 - problem.Z * qdd);
                     }))
          .why("It stands after the section on rotors and goes back to (23), which has none; (39) "
               "with the `P_2` of (35) is right in both cases.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(Claim("eq39", "7.2", "The outward projection")
                        .printed("`Xdd_2 = P_2' Xdd_1`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   const auto problem = anyProblem(at, true);
                                   at.equal("Xdd_2", solveJoint(problem).Xdd_2,
                                            accelerationProjection<T>(problem.M_2, problem.Z,
                                                                      rotorInertia(problem)) *
                                                problem.Xdd_1);
                                 }))
                        .why("Acceleration passes by the transpose of what force passes by, as "
                             "power demands; here with a rotor, `P_2` from (35).")
                        .in("recursive/projection.hpp"));

  claims->push_back(Claim("force_steps", "7.3", "How a force is lost in a joint")
                        .printed("`tau = Z' F_2`, `qdd = (Z' M_2 Z)^-1 tau`, `A = Z qdd`, and `M_2 "
                                 "A` of `F_2` is lost",
                                 exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   auto problem = anyProblem(at);
                                   problem.Xdd_1 = Vector6<T>::Zero();
                                   problem.applied = at.vector6();
                                   const auto truth = solveJoint(problem);
                                   const T qdd =
                                       problem.Z.dot(problem.applied) / axisInertia(problem);
                                   at.equal("A", truth.Xdd_2, problem.Z * qdd);
                                   at.equal("lost", problem.applied + truth.transmitted,
                                            problem.M_2 * problem.Z * qdd);
                                 }))
                        .why("Link 1 is held fast, so link 2 can only move along `Z`.")
                        .in("recursive/projection.hpp"));
  claims->push_back(Claim("eq40", "7.3", "Force that passes the joint")
                        .printed("`F_1 = F_2 - M_2 Z (Z' M_2 Z)^-1 Z' F_2`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   auto problem = anyProblem(at);
                                   problem.Xdd_1 = Vector6<T>::Zero();
                                   problem.applied = at.vector6();
                                   // link 1 is pushed by the opposite of what it exerts on link 2
                                   const Vector6<T> lost =
                                       problem.M_2 * problem.Z *
                                       (problem.Z.dot(problem.applied) / axisInertia(problem));
                                   at.equal("F_1", -solveJoint(problem).transmitted,
                                            problem.applied - lost);
                                 }))
                        .why("What is not used up by accelerating link 2. No rotor here: with one, "
                             "`d + Z' M_2 Z`, which (41) says when `P_2` is that of (35).")
                        .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("eq41", "7.3", "The inward projection of force")
          .printed("`F_1 = P_2 F_2`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     auto problem = anyProblem(at, true);
                     problem.Xdd_1 = Vector6<T>::Zero();
                     problem.applied = at.vector6();
                     at.equal("F_1", -solveJoint(problem).transmitted,
                              forceProjection<T>(problem.M_2, problem.Z, rotorInertia(problem)) *
                                  problem.applied);
                   }))
          .why("The same operator that projects inertia; here with a rotor.")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("naive_force", "7.3", "Why not just the component about the axis")
          .printed("`F_2 - Z Z' F_2` is not the force that passes", differs([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     auto problem = anyProblem(at);
                     problem.Z = axisZ<T>();
                     problem.Xdd_1 = Vector6<T>::Zero();
                     problem.applied = at.vector6();
                     at.equal("F_1", -solveJoint(problem).transmitted,
                              problem.applied - problem.Z * problem.Z.dot(problem.applied));
                   }))
          .why("Turning about the axis makes inertial forces in other directions, through the last "
               "column of `M_2`.")
          .in("recursive/projection.hpp"));
}

}  // namespace

std::vector<Claim> projections() {
  std::vector<Claim> claims;
  addInertia(&claims);
  addJointKinds(&claims);
  addOutAndIn(&claims);
  return claims;
}

}  // namespace dynwitness::audit
