// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 4 and 8: recursions from link to link. Motions are held against differentiated
// positions, inertias and forces against all links' equations solved at once.
#include <fmt/format.h>

#include "crosscheck/audit/counting.hpp"
#include "crosscheck/audit/truths.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::audit {
namespace {

using recursive::forceProjection;
using recursive::inertiaProjection;

// ---- motions -----------------------------------------------------------------------------------

enum class Joint { kRevolute, kPrismatic };

/// Two links in motion, the second on a joint of the first. World axes.
template <typename T>
struct TwoLinks {
  Path<T> i, next;
  JointMotion<T> joint;

  Vector3<T> r() const { return next.origin() - i.origin(); }  ///< r_i,i+1
  Vector3<T> z() const { return next.axes().col(2); }
  Vector3<T> w() const { return i.omega(); }
};

template <typename At>
TwoLinks<ScalarOf<At>> anyTwoLinks(At& at, Joint kind) {
  using T = ScalarOf<At>;
  const Path<T> i = anyPath(at);
  const Matrix3<T> R = at.rotation();
  const Vector3<T> r = at.vector();
  const JointMotion<T> joint = anyJointMotion(at);
  if (kind == Joint::kPrismatic) return {i, slid(i, R, r, joint), joint};
  return {i, turned(i, R, r, at.angle(), joint), joint};
}

/// [1, -hat(r); 0, 1]
template <typename T>
Matrix6<T> shiftOfVelocity(const Vector3<T>& r) {
  Matrix6<T> m = Matrix6<T>::Identity();
  m.template block<3, 3>(0, 3) = -skew<T>(r);
  return m;
}

template <typename T>
Vector6<T> joined(const Vector3<T>& linear, const Vector3<T>& angular) {
  return Motion<T>{linear, angular}.vector();
}
template <typename T>
Vector6<T> axis(Joint kind, const Vector3<T>& z) {
  const Vector3<T> none = Vector3<T>::Zero();
  return kind == Joint::kRevolute ? joined<T>(none, z) : joined<T>(z, none);
}

/// (48) as printed, for either kind of joint.
template <typename At>
void printedAcceleration(At& at, Joint kind) {
  using T = ScalarOf<At>;
  const TwoLinks<T> links = anyTwoLinks(at, kind);
  const Vector3<T> w = links.w();
  const Vector6<T> A = joined<T>(w.cross(w.cross(links.r())), w.cross(links.z()) * links.joint.qd);
  at.equal("Xdd_i+1", links.next.acceleration().vector(),
           shiftOfVelocity<T>(links.r()) * links.i.acceleration().vector() +
               axis<T>(kind, links.z()) * links.joint.qdd + A);
}

void addMotions(std::vector<Claim>* claims) {
  claims->push_back(
      Claim("position_recursion", "8.1", "Outward: positions")
          .printed(
              "The place of the end effector is a product of homogeneous matrices, one a joint: "
              "`H_1 H_2 ... = [R, p; 0, 1]`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                // a revolute joint and a slide: our transforms, and 4 x 4 matrices multiplied
                recursive::LinkModel<T> link;
                std::vector<recursive::JointPosition<T>> x(2);
                Transform<T> X = Transform<T>::identity();
                MatrixX<T> H = MatrixX<T>::Identity(4, 4);
                for (int i = 0; i < 2; ++i) {
                  const scene::CosSin<T> angle = at.angle();
                  x[i] = {at.number(), angle.c, angle.s};
                  link.dof = link.slot = i;
                  link.kind =
                      i == 0 ? recursive::JointKind::kRevolute : recursive::JointKind::kPrismatic;
                  link.X_tree = at.transform();
                  X = recursive::AnyJoints::transform(link, x) * X;
                  MatrixX<T> placed = MatrixX<T>::Identity(4, 4), moved = placed;
                  placed.block(0, 0, 3, 3) = link.X_tree.R.transpose();
                  placed.block(0, 3, 3, 1) = link.X_tree.p;
                  if (i == 0) {
                    moved(0, 0) = moved(1, 1) = angle.c;
                    moved(1, 0) = angle.s;
                    moved(0, 1) = -angle.s;
                  } else {
                    moved(2, 3) = x[i].q;
                  }
                  H = MatrixX<T>(MatrixX<T>(H * placed) * moved);
                }
                at.equal("R", MatrixX<T>(H.block(0, 0, 3, 3)), MatrixX<T>(X.R.transpose()));
                at.equal("p", MatrixX<T>(H.block(0, 3, 3, 1)), MatrixX<T>(X.p));
              }))
          .why("Each link's frame is placed in that of the link before; products compose.")
          .in("recursive/model.hpp"));
  claims->push_back(
      Claim("eq42", "8.2", "Outward: linear velocity")
          .printed("`v_i+1 = v_i + w_i x r_i,i+1`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto links = anyTwoLinks(at, Joint::kRevolute);
                     at.equal("v", links.next.velocity().linear,
                              Vector3<T>(links.i.velocity().linear + links.w().cross(links.r())));
                   }))
          .why(
              "A revolute joint's origin is a point of both links. On a slide `qd z` is added, see "
              "prismatic_velocity.")
          .in("recursive/newton_euler.hpp"));
  claims->push_back(Claim("eq43", "8.2", "Outward: angular velocity")
                        .printed("`w_i+1 = w_i + qd z_i+1`", exact([](auto& at) {
                                   using T = ScalarOf<decltype(at)>;
                                   const auto links = anyTwoLinks(at, Joint::kRevolute);
                                   at.equal("w", links.next.omega(),
                                            Vector3<T>(links.w() + links.z() * links.joint.qd));
                                 }))
                        .why("Angular velocities add.")
                        .in("recursive/newton_euler.hpp"));
  claims->push_back(
      Claim("eq44", "8.2", "Outward velocity recursion")
          .printed("`Xd_i+1 = T_V_i+1,i Xd_i + qd Z` with `Z = (0, z)`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto links = anyTwoLinks(at, Joint::kRevolute);
                     at.equal("Xd", links.next.velocity().vector(),
                              shiftOfVelocity<T>(links.r()) * links.i.velocity().vector() +
                                  axis<T>(Joint::kRevolute, links.z()) * links.joint.qd);
                   }))
          .why("(42) and (43) in one.")
          .in("recursive/newton_euler.hpp"));
  claims->push_back(
      Claim("prismatic_velocity", "8.2", "(44) on a slide")
          .printed("With `Z = (z, 0)`, (44) holds for prismatic joints", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto links = anyTwoLinks(at, Joint::kPrismatic);
                     at.equal("Xd", links.next.velocity().vector(),
                              shiftOfVelocity<T>(links.r()) * links.i.velocity().vector() +
                                  axis<T>(Joint::kPrismatic, links.z()) * links.joint.qd);
                   }))
          .why(
              "Section 5.1 admits prismatic joints. `Z` is all that knows the kind of joint, up to "
              "here; (42) and (43) do not.")
          .in("recursive/newton_euler.hpp"));

  const auto outwardMatrix = [](auto& at, bool world_axes, bool turned_blocks) {
    using T = ScalarOf<decltype(at)>;
    // one rigid link, its velocity at both frames' origins
    const Path<T> path = anyPath(at);
    const Matrix3<T> R_i = world_axes ? Matrix3<T>(Matrix3<T>::Identity()) : at.rotation();
    const Matrix3<T> R_next = world_axes ? R_i : at.rotation();
    const Vector3<Jet<T>> x_i = path.place(at.vector()), x_next = path.place(at.vector());
    const Vector3<T> r = R_i.transpose() * (now<T, 3, 1>(x_next) - now<T, 3, 1>(x_i));
    const auto seen = [&](const Matrix3<T>& R, const Vector3<Jet<T>>& x) {
      return joined<T>(R.transpose() * rate<T, 3, 1>(x), R.transpose() * path.omega());
    };
    const Matrix3<T> R = R_next.transpose() * R_i;
    Matrix6<T> T_V = shiftOfVelocity<T>(r);
    if (turned_blocks) T_V << R, -(R * skew<T>(r)), Matrix3<T>::Zero(), R;
    at.equal("Xd", seen(R_next, x_next), T_V * seen(R_i, x_i));
    if (turned_blocks) at.equal("our code", T_V, Transform<T>{R, r}.motionMatrix());
  };
  claims->push_back(
      Claim("eq45", "8.2", "The outward matrix")
          .printed("`T_V_i+1,i = [1, -hat(r_i,i+1); 0, 1]` from proximal frame to proximal frame",
                   exact([outwardMatrix](auto& at) { outwardMatrix(at, false, false); }))
          .condition("All coordinates are in one set of axes, the world's for example",
                     exact([outwardMatrix](auto& at) { outwardMatrix(at, true, false); }))
          .corrected(
              "`T_V_i+1,i = [R, -R hat(r_i,i+1); 0, R]`, `R` from the axes of i to those of i+1",
              exact([outwardMatrix](auto& at) { outwardMatrix(at, false, true); }))
          .why("It is the inverse of the first form of (11). The third step of section 8 asks for "
               "coordinates in each link's own frame, which needs the inverse of the second form, "
               "(12).")
          .in("recursive/spatial.hpp"));

  claims->push_back(
      Claim("eq46", "8.3", "Outward: linear acceleration")
          .printed("`vd_i+1 = vd_i + wd_i x r + w_i x (w_i x r)`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto links = anyTwoLinks(at, Joint::kRevolute);
                     const Vector3<T> r = links.r(), w = links.w();
                     at.equal("vd", links.next.acceleration().linear,
                              Vector3<T>(links.i.acceleration().linear + links.i.alpha().cross(r) +
                                         w.cross(w.cross(r))));
                   }))
          .why("The joint's origin is a point of link i. This `vd` is the acceleration of a "
               "point of the body: (14) forbids it the last term, and (15) asks for it.")
          .in("crosscheck/audit/recursions.cpp"));
  claims->push_back(
      Claim("eq47", "8.3", "Outward: angular acceleration")
          .printed("`wd_i+1 = wd_i + qdd z + w_i x qd z`", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto links = anyTwoLinks(at, Joint::kRevolute);
                     at.equal("wd", links.next.alpha(),
                              Vector3<T>(links.i.alpha() + links.z() * links.joint.qdd +
                                         links.w().cross(links.z()) * links.joint.qd));
                   }))
          .why("The axis is fixed in link i (and in link i+1: `w_i+1 x qd z` is the same).")
          .in("recursive/newton_euler.hpp"));
  claims->push_back(
      Claim("eq48", "8.3", "Outward acceleration recursion")
          .printed(
              "`Xdd_i+1 = T_V_i+1,i Xdd_i + qdd Z + A` with `A = (w_i x (w_i x r), w_i x qd z)`",
              exact([](auto& at) { printedAcceleration(at, Joint::kRevolute); }))
          .why("So it is for revolute joints and `Xdd = (vd, wd)` of the links' points. For slides "
               "see prismatic_acceleration, for spatial acceleration spatial_recursion.")
          .in("crosscheck/audit/recursions.cpp"));
  claims->push_back(
      Claim("prismatic_acceleration", "8.3", "(48) on a slide")
          .printed("With `Z = (z, 0)`, (48) with its `A` holds for prismatic joints",
                   exact([](auto& at) { printedAcceleration(at, Joint::kPrismatic); }))
          .corrected("On a slide `A = (w_i x (w_i x r) + 2 qd w_i x z, 0)`", exact([](auto& at) {
                       using T = ScalarOf<decltype(at)>;
                       const auto links = anyTwoLinks(at, Joint::kPrismatic);
                       const Vector3<T> w = links.w(), none = Vector3<T>::Zero();
                       const T two_qd = links.joint.qd + links.joint.qd;
                       const Vector6<T> A = joined<T>(
                           w.cross(w.cross(links.r())) + w.cross(links.z()) * two_qd, none);
                       at.equal("Xdd", links.next.acceleration().vector(),
                                shiftOfVelocity<T>(links.r()) * links.i.acceleration().vector() +
                                    axis<T>(Joint::kPrismatic, links.z()) * links.joint.qdd + A);
                     }))
          .why("The Coriolis acceleration `2 w x v_rel`: once because the slide turns, once "
               "because the place on it changes. A slide has no bias in `wd`.")
          .in("recursive/newton_euler.hpp"));
  claims->push_back(
      Claim("spatial_recursion", "8.3", "(48) with the acceleration that (14) transforms")
          .printed("With spatial acceleration the bias of (48) is the same `A`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const auto links = anyTwoLinks(at, Joint::kRevolute);
                     const auto spatial = [](const Path<T>& path) {
                       const Motion<T> v = path.velocity(), a = path.acceleration();
                       return joined<T>(a.linear - v.angular.cross(v.linear), a.angular);
                     };
                     const Vector3<T> w = links.w();
                     at.equal("a", spatial(links.next),
                              shiftOfVelocity<T>(links.r()) * spatial(links.i) +
                                  axis<T>(Joint::kRevolute, links.z()) * links.joint.qdd +
                                  joined<T>(w.cross(w.cross(links.r())),
                                            w.cross(links.z()) * links.joint.qd));
                   }))
          .corrected(
              "With spatial acceleration `a`, `A = Xd_i+1 x Z qd` for every kind of joint",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                for (const Joint kind : {Joint::kRevolute, Joint::kPrismatic}) {
                  const auto links = anyTwoLinks(at, kind);
                  const auto spatial = [](const Path<T>& path) {
                    const Motion<T> v = path.velocity(), a = path.acceleration();
                    return joined<T>(a.linear - v.angular.cross(v.linear), a.angular);
                  };
                  const Vector6<T> Z = axis<T>(kind, links.z());
                  const Motion<T> v_J{Z.template head<3>() * links.joint.qd,
                                      Z.template tail<3>() * links.joint.qd};
                  at.equal(kind == Joint::kRevolute ? "revolute" : "prismatic", spatial(links.next),
                           shiftOfVelocity<T>(links.r()) * spatial(links.i) + Z * links.joint.qdd +
                               cross(links.next.velocity(), v_J).vector());
                }
              }))
          .why("Spatial acceleration is the derivative of a vector field, not of a point's "
               "velocity; the centripetal term moves into the definition. Our sweeps use it.")
          .in("recursive/newton_euler.hpp"));
}

// ---- inertia and force -------------------------------------------------------------------------

/// Link i and links on joints of it, each in its own frame. The links beyond may stand for
/// subtrees: their inertias are any symmetric matrices.
template <typename T>
struct Child {
  Transform<T> X;  ///< coordinates in link i to coordinates in the child
  Matrix6<T> M;
  Vector6<T> Z, A, F_b, F_e;  ///< axis, bias acceleration, bias force, external force
  T d, tau;

  Matrix6<T> T_F() const { return X.inverse().forceMatrix(); }  ///< T_F_i,i+1
  Matrix6<T> T_V() const { return X.motionMatrix(); }           ///< T_V_i+1,i
  T D() const { return d + Z.dot(M * Z); }
};

enum class Loads { kNone, kAll };

template <typename At>
Child<ScalarOf<At>> anyChild(At& at, Loads loads) {
  using T = ScalarOf<At>;
  const Vector6<T> none = Vector6<T>::Zero();
  Child<T> child{at.transform(), at.template symmetric<6>(),
                 at.vector6(),   none,
                 none,           none,
                 at.number(),    T(0)};
  if (loads == Loads::kAll) {
    child.A = at.vector6();
    child.F_b = at.vector6();
    child.F_e = at.vector6();
    child.tau = at.number();
  }
  return child;
}

/// The force that link i must be given for the acceleration Xdd: its own, and the joints' forces of
/// its children, each from its linear system.
template <typename T>
Vector6<T> neededForce(const Matrix6<T>& M, const Vector6<T>& F_b, const Vector6<T>& F_e,
                       const std::vector<Child<T>>& children, const Vector6<T>& Xdd) {
  Vector6<T> force = M * Xdd + F_b - F_e;
  for (const Child<T>& child : children) {
    JointProblem<T> problem;
    problem.M_2 = child.M;
    problem.Z = child.Z;
    problem.gear = T(1);
    problem.rotor = child.d;
    problem.Xdd_1 = child.T_V() * Xdd;
    problem.bias_acceleration = child.A;
    problem.bias_force = child.F_b;
    problem.applied = child.F_e;
    problem.tau = child.tau;
    force += child.T_F() * solveJoint(problem).transmitted;
  }
  return force;
}

void addInertiaAndForce(std::vector<Claim>* claims) {
  const auto articulated = [](auto& at, int children) {
    using T = ScalarOf<decltype(at)>;
    const Matrix6<T> M = at.template symmetric<6>();
    const Vector6<T> Xdd = at.vector6(), none = Vector6<T>::Zero();
    std::vector<Child<T>> all;
    Matrix6<T> M_A = M;
    for (int k = 0; k < children; ++k) {
      all.push_back(anyChild(at, Loads::kNone));
      const Child<T>& child = all.back();
      M_A +=
          child.T_F() * inertiaProjection<T>(child.M, child.Z, child.d) * child.T_F().transpose();
    }
    at.equal("force on link i", neededForce<T>(M, none, none, all, Xdd), M_A * Xdd);
  };
  claims->push_back(
      Claim("eq49", "8.4", "Inward recursion of the articulated inertia")
          .printed("`M_Ai = M_i + T_F_i,i+1 P_i+1 M_Ai+1 T_F_i,i+1'`",
                   exact([articulated](auto& at) { articulated(at, 1); }))
          .why("`T_F' = T_V_i+1,i` carries the acceleration outward, `P M_A` makes a force of it, "
               "`T_F` carries that back. The last link of a branch starts it with its own `M_i`.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(Claim("branches", "8.4", "Branches of a tree")
                        .printed("Where the tree branches, (49) contains the sum over the "
                                 "branches, which do not couple",
                                 exact([articulated](auto& at) { articulated(at, 2); }))
                        .why("For a given motion of link i each branch moves for itself.")
                        .in("recursive/articulated_body.hpp"));

  // (50) is read with F as (52) uses it: tau_i = Z' (F_i + M_Ai Xdd), so F is the force that link i
  // needs beyond M_A Xdd.
  const auto inward = [](auto& at, auto recursion) {
    using T = ScalarOf<decltype(at)>;
    const Matrix6<T> M = at.template symmetric<6>();
    const Vector6<T> none = Vector6<T>::Zero();
    const Vector6<T> F_b = at.vector6(), F_e = at.vector6();
    const Child<T> child = anyChild(at, Loads::kAll);
    // the child's own F: what it needs when its frame does not accelerate
    const Vector6<T> F_next = child.F_b - child.F_e;
    const Vector6<T> needed = neededForce<T>(M, F_b, F_e, {child}, none);
    recursion(at, child, F_next, F_b, F_e, needed);
  };
  const auto printedForce = [](auto& at, const auto& child, const auto& F_next, const auto& F_b,
                               const auto& F_e, const auto& needed) {
    using T = ScalarOf<decltype(at)>;
    const Vector6<T> passed = forceProjection<T>(child.M, child.Z, child.d) * F_next -
                              child.M * child.Z * (child.tau / child.D());
    at.equal("F_i", needed, child.T_F() * passed + F_b + F_e);
  };
  claims->push_back(
      Claim("eq50", "8.5", "Inward recursion of force")
          .printed("`F_i = T_F (P_i+1 F_i+1 - M_A Z (d + Z' M_A Z)^-1 tau) + F_b + F_e`, used in "
                   "(52) as `tau_i = Z' (F_i + M_A Xdd)`",
                   exact([inward, printedForce](auto& at) { inward(at, printedForce); }))
          .corrected(
              "`F_i = T_F (P_i+1 (F_i+1 + M_A A) + M_A Z (d + Z' M_A Z)^-1 tau) + F_b - F_e`, with "
              "the bias acceleration `A` of joint i+1",
              exact([inward](auto& at) {
                inward(at, [](auto& at, const auto& child, const auto& F_next, const auto& F_b,
                              const auto& F_e, const auto& needed) {
                  using T = ScalarOf<decltype(at)>;
                  const Vector6<T> passed = forceProjection<T>(child.M, child.Z, child.d) *
                                                Vector6<T>(F_next + child.M * child.A) +
                                            child.M * child.Z * (child.tau / child.D());
                  at.equal("F_i", needed, child.T_F() * passed + F_b - F_e);
                });
              }))
          .why("A force that link i needs and a force that acts on it have opposite signs: `F_b` "
               "is of the first kind, `F_e` of the second. The term `P M_A A`, the force that the "
               "joint's velocity products need, is missing. Without torques, external forces and "
               "`A` it would be right. No reading of `F` makes all signs right: see force_signs.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(
      Claim("force_signs", "8.5", "(50) with F as the force that acts")
          .printed(
              "Read with the other sign, `F` the force available at link i, (50) is right while "
              "`A = 0`",
              exact([inward](auto& at) {
                inward(at, [](auto& at, auto child, const auto&, const auto& F_b, const auto& F_e,
                              const auto&) {
                  using T = ScalarOf<decltype(at)>;
                  const Vector6<T> none = Vector6<T>::Zero();
                  child.A = none;
                  const Matrix6<T> any = Matrix6<T>::Zero();  // Xdd = 0: no own inertia needed
                  const Vector6<T> needed = neededForce<T>(any, F_b, F_e, {child}, none);
                  const Vector6<T> F_next = child.F_e - child.F_b;
                  const Vector6<T> passed = forceProjection<T>(child.M, child.Z, child.d) * F_next -
                                            child.M * child.Z * (child.tau / child.D());
                  at.equal("F_i", Vector6<T>(-needed), child.T_F() * passed + F_b + F_e);
                });
              }))
          .corrected("`F_i = T_F (P_i+1 F_i+1 - M_A Z (d + Z' M_A Z)^-1 tau) - F_b + F_e` for `A = "
                     "0`: then `F_b` has the wrong sign, and (52) too",
                     exact([inward](auto& at) {
                       inward(at, [](auto& at, auto child, const auto&, const auto& F_b,
                                     const auto& F_e, const auto&) {
                         using T = ScalarOf<decltype(at)>;
                         const Vector6<T> none = Vector6<T>::Zero();
                         child.A = none;
                         const Matrix6<T> any = Matrix6<T>::Zero();
                         const Vector6<T> needed = neededForce<T>(any, F_b, F_e, {child}, none);
                         const Vector6<T> F_next = child.F_e - child.F_b;
                         const Vector6<T> passed =
                             forceProjection<T>(child.M, child.Z, child.d) * F_next -
                             child.M * child.Z * (child.tau / child.D());
                         at.equal("F_i", Vector6<T>(-needed), child.T_F() * passed - F_b + F_e);
                       });
                     }))
          .why("The text gives the minus of the joint torque as its reaction on link i: that is "
               "this reading. It contradicts the plus of the bias force.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(
      Claim("torque_reaction", "8.5", "What link i feels of a joint torque")
          .printed("A torque `tau` at joint i+1 exerts `-M_A Z (d + Z' M_A Z)^-1 tau` on a link i "
                   "at rest",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     JointProblem<T> problem;
                     problem.M_2 = at.template symmetric<6>();
                     problem.Z = at.vector6();
                     problem.gear = T(1);
                     problem.rotor = at.number();
                     problem.tau = at.number();
                     const Vector6<T> M_Z = problem.M_2 * problem.Z;
                     at.equal("on link i", -solveJoint(problem).transmitted,
                              -(M_Z * (problem.tau / (problem.rotor + problem.Z.dot(M_Z)))));
                   }))
          .why(
              "Not `-Z tau` alone: link i+1 is accelerated along `Z`, and that needs forces in all "
              "directions.")
          .in("recursive/articulated_body.hpp"));
  claims->push_back(
      Claim("superposition", "8.5", "Loads superpose")
          .printed(
              "Joint torques, external forces and gravity can be computed apart and added; without "
              "torques the motion is that under gravity",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                // the whole linear system, link i fixed: each load alone, and all together
                JointProblem<T> problem;
                problem.M_2 = at.template symmetric<6>();
                problem.Z = at.vector6();
                const Vector6<T> gravity = at.vector6(), external = at.vector6();
                const T tau = at.number();
                problem.Xdd_1 = -gravity;
                T sum = solveJoint(problem).qdd;
                problem.Xdd_1.setConstant(T(0));
                problem.applied = external;
                sum += solveJoint(problem).qdd;
                problem.applied.setConstant(T(0));
                problem.tau = tau;
                sum += solveJoint(problem).qdd;
                problem.applied = external;
                problem.Xdd_1 = -gravity;
                at.equal("qdd", solveJoint(problem).qdd, sum);
              }))
          .why("For given positions and velocities the equations are linear in forces and "
               "accelerations.")
          .in("recursive/articulated_body.hpp"));
}

// ---- trees and their cost ----------------------------------------------------------------------

/// Operations of one inverse and one forward dynamics of a chain of n revolute links.
Operations sweepCost(int n) {
  recursive::Model<Counted> model;
  model.positions = n;
  for (int i = 0; i < n; ++i) {
    recursive::LinkModel<Counted> link;
    link.parent = i - 1;
    link.dof = link.slot = i;
    link.kind = recursive::JointKind::kRevolute;
    model.links.push_back(link);
    model.link_of_dof.push_back(i);
  }
  recursive::Workspace<Counted> workspace(model);
  const std::vector<recursive::JointPosition<Counted>> x(static_cast<std::size_t>(n));
  std::vector<Counted> qd(static_cast<std::size_t>(n)), qdd = qd, tau = qd;
  Counted::operations() = {};
  recursive::inverseDynamics(model, x, qd, qdd, workspace, tau);
  recursive::forwardDynamics(model, x, qd, tau, workspace, qdd);
  return Counted::operations();
}

/// Transformations of a velocity that all links of a chain take when nothing is stored: link i goes
/// back to the base.
long transformationsWithoutStore(int n) {
  long count = 0;
  for (int i = 0; i < n; ++i)
    for (int k = i; k >= 0; --k) ++count;
  return count;
}

void addTrees(std::vector<Claim>* claims) {
  claims->push_back(
      Claim("root_choice", "4", "Any link can be the root")
          .printed("Another root gives the same motion", exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     // two free bodies on one joint, all in one frame; forces on both, a joint
                     // torque
                     const Matrix6<T> M_1 = at.template symmetric<6>(),
                                      M_2 = at.template symmetric<6>();
                     const Vector6<T> Z = at.vector6(), F_1 = at.vector6(), F_2 = at.vector6();
                     const T tau = at.number();
                     const auto fromRoot = [&](const Matrix6<T>& M_r, const Matrix6<T>& M_o,
                                               const Vector6<T>& F_r, const Vector6<T>& F_o,
                                               const Vector6<T>& axis) {
                       const Matrix6<T> M_A = M_r + inertiaProjection<T>(M_o, axis, T(0));
                       const Vector6<T> M_Z = M_o * axis;
                       const Vector6<T> F = F_r + forceProjection<T>(M_o, axis, T(0)) * F_o -
                                            M_Z * (tau / axis.dot(M_Z));
                       return Vector6<T>(solveDense<T>(M_A, F));
                     };
                     const Vector6<T> Xdd_1 = fromRoot(M_1, M_2, F_1, F_2, Z);
                     // from root 2 the joint is the other way round
                     const Vector6<T> Xdd_2 = fromRoot(M_2, M_1, F_2, F_1, Vector6<T>(-Z));
                     const Vector6<T> M_Z = M_2 * Z;
                     const T qdd = (tau + Z.dot(F_2 - M_2 * Xdd_1)) / Z.dot(M_Z);
                     at.equal("Xdd_2", Xdd_2, Xdd_1 + Z * qdd);
                   }))
          .why("The joint's axis and torque change their sign together, and Newton's laws know no "
               "root. (A rotor is an exception: `d` belongs to the link that carries the motor.)")
          .in("recursive/projection.hpp"));
  claims->push_back(
      Claim("shared_subtree", "4", "TODO: branches that join again (DAG)")
          .open()
          .printed("A link that two branches share is treated almost as in a tree: its inertia is "
                   "projected inward through each of its joints, `M_A1 = M_1 + P_a M_3 + P_b M_3`",
                   exact([](auto& at) {
                     using T = ScalarOf<decltype(at)>;
                     const Matrix6<T> M_3 = at.template symmetric<6>();
                     const Vector6<T> Xdd_1 = at.vector6();
                     const Matrix6<T> P_M = inertiaProjection<T>(M_3, at.vector6(), T(0)) +
                                            inertiaProjection<T>(M_3, at.vector6(), T(0));
                     // two joints with different axes between the same links leave no motion:
                     // Z_a qdd_a = Z_b qdd_b only for 0
                     at.equal("force that passes", M_3 * Xdd_1, P_M * Xdd_1);
                   }))
          .corrected(
              "Branches that join again make a loop, whose closure is a constraint: with two axes "
              "`Z_a`, `Z_b` between links 1 and 3 nothing moves, `M_A1 = M_1 + M_3`; with one axis "
              "twice it is one joint, `M_1 + P M_3`",
              exact([](auto& at) {
                using T = ScalarOf<decltype(at)>;
                // Between links 1 and 3 the motion x is along both axes, x = Z_a a = Z_b b, and the
                // joints together do no work on it. Two axes: [Z_a, -Z_b] (a, b) = 0, any two rows.
                const Matrix6<T> M_3 = at.template symmetric<6>();
                const Vector6<T> Xdd_1 = at.vector6(), Z_a = at.vector6(), Z_b = at.vector6();
                MatrixX<T> both_axes(2, 2);
                both_axes << Z_a(0), -Z_b(0), Z_a(1), -Z_b(1);
                const VectorX<T> rates =
                    solveDense<T>(both_axes, VectorX<T>(VectorX<T>::Constant(2, T(0))));
                at.equal("two axes", M_3 * Xdd_1, M_3 * Vector6<T>(Xdd_1 + Z_a * rates(0)));
                JointProblem<T> problem;
                problem.M_2 = M_3;
                problem.Z = Z_a;
                problem.Xdd_1 = Xdd_1;
                at.equal("one axis twice", solveJoint(problem).transmitted,
                         inertiaProjection<T>(M_3, Z_a, T(0)) * Xdd_1);
              }))
          .why("Projecting through both joints counts the shared link twice. Section 10 would have "
               "to treat the loop.")
          .in("crosscheck/audit/recursions.cpp"));
  claims->push_back(
      Claim("stored_results", "4", "TODO: dynamic programming, storing intermediate results")
          .open()
          .printed(
              "Storing each link's result for the next makes the sweeps linear in the number of "
              "links; without the store, each link goes back to the base, n (n + 1)/2 "
              "transformations",
              decided("count of operations",
                      [] {
                        const long a = sweepCost(20).total() - sweepCost(10).total();
                        const long b = sweepCost(30).total() - sweepCost(20).total();
                        const bool quadratic = transformationsWithoutStore(30) == 30 * 31 / 2;
                        return Decision{
                            a == b && quadratic,
                            fmt::format("ten links more cost {} operations from 10 and {} from 20; "
                                        "without a store 30 links take {} transformations",
                                        a, b, transformationsWithoutStore(30))};
                      }))
          .why("A sweep is dynamic programming on the tree: `ws.v`, `ws.M_A` and `ws.f` are its "
               "table.")
          .in("recursive/model.hpp"));
  claims->push_back(
      Claim("linear_time", "8", "Linear time")
          .printed("Inverse and forward dynamics cost time proportional to the number of links",
                   decided("count of operations",
                           [] {
                             const Operations ten = sweepCost(10), twenty = sweepCost(20),
                                              forty = sweepCost(40);
                             const long step = (twenty.total() - ten.total()) / 10;
                             return Decision{
                                 forty.total() - twenty.total() == 20 * step,
                                 fmt::format(
                                     "{} operations a link in both together, from 10 links to 40",
                                     step)};
                           }))
          .why("Every link is visited a fixed number of times.")
          .in("recursive/articulated_body.hpp"));
}

}  // namespace

std::vector<Claim> recursions() {
  std::vector<Claim> claims;
  addTrees(&claims);
  addMotions(&claims);
  addInertiaAndForce(&claims);
  return claims;
}

}  // namespace dynwitness::audit
