// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 4 and 8: recursions from link to link. Motions are held against differentiated
// positions, inertias and forces against all links' equations solved at once.
#include <fmt/format.h>

#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/costs.hpp"
#include "crosscheck/audit/ours.hpp"
#include "crosscheck/audit/robot.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::audit {
namespace {

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

TwoLinks<T> anyTwoLinks(Point& at, Joint kind) {
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
void printedAcceleration(Point& at, Joint kind) {
  const TwoLinks<T> links = anyTwoLinks(at, kind);
  const Vector3<T> w = links.w();
  const Vector6<T> A = joined<T>(w.cross(w.cross(links.r())), w.cross(links.z()) * links.joint.qd);
  at.equal("Xdd_i+1", links.next.acceleration().vector(),
           shiftOfVelocity<T>(links.r()) * links.i.acceleration().vector() +
               axis<T>(kind, links.z()) * links.joint.qdd + A);
}

Trials positionRecursion() {
  return Trials("position_recursion").printed(exact([](Point& at) {
    // a revolute joint and a slide: our transforms, and 4 x 4 matrices multiplied
    recursive::LinkModel<T> link;
    std::vector<recursive::JointPosition<T>> x(2);
    Transform<T> X = Transform<T>::identity();
    MatrixX<T> H = MatrixX<T>::Identity(4, 4);
    for (int i = 0; i < 2; ++i) {
      const scene::CosSin<T> angle = at.angle();
      x[i] = {at.number(), angle.c, angle.s};
      link.dof = link.slot = i;
      link.kind = i == 0 ? recursive::JointKind::kRevolute : recursive::JointKind::kPrismatic;
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
  }));
}

Trials eq42() {
  return Trials("eq42")
      .printed(exact([](Point& at) {
        const auto links = anyTwoLinks(at, Joint::kRevolute);
        at.equal("v", links.next.velocity().linear,
                 Vector3<T>(links.i.velocity().linear + links.w().cross(links.r())));
      }))
      .ours(ourChain());
}

Trials eq43() {
  return Trials("eq43")
      .printed(exact([](Point& at) {
        const auto links = anyTwoLinks(at, Joint::kRevolute);
        at.equal("w", links.next.omega(), Vector3<T>(links.w() + links.z() * links.joint.qd));
      }))
      .ours(ourChain());
}

Trials eq44() {
  return Trials("eq44")
      .printed(exact([](Point& at) {
        const auto links = anyTwoLinks(at, Joint::kRevolute);
        at.equal("Xd", links.next.velocity().vector(),
                 shiftOfVelocity<T>(links.r()) * links.i.velocity().vector() +
                     axis<T>(Joint::kRevolute, links.z()) * links.joint.qd);
      }))
      .ours(ourChain());
}

Trials prismaticVelocity() {
  return Trials("prismatic_velocity").printed(exact([](Point& at) {
    const auto links = anyTwoLinks(at, Joint::kPrismatic);
    at.equal("Xd", links.next.velocity().vector(),
             shiftOfVelocity<T>(links.r()) * links.i.velocity().vector() +
                 axis<T>(Joint::kPrismatic, links.z()) * links.joint.qd);
  }));
}

void outwardMatrix(Point& at, bool world_axes) {
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
  if (!world_axes) T_V << R, -(R * skew<T>(r)), Matrix3<T>::Zero(), R;
  at.equal("Xd", seen(R_next, x_next), T_V * seen(R_i, x_i));
}

Trials eq45() {
  // in one set of axes, as printed; in the links' own, as the sentence about it says
  return Trials("eq45")
      .printed(both(exact([](Point& at) { outwardMatrix(at, true); }),
                    exact([](Point& at) { outwardMatrix(at, false); })))
      .ours(ourTransformations());
}

Trials eq46() {
  return Trials("eq46").printed(exact([](Point& at) {
    const auto links = anyTwoLinks(at, Joint::kRevolute);
    const Vector3<T> r = links.r(), w = links.w();
    at.equal(
        "vd", links.next.acceleration().linear,
        Vector3<T>(links.i.acceleration().linear + links.i.alpha().cross(r) + w.cross(w.cross(r))));
  }));
}

Trials eq47() {
  return Trials("eq47")
      .printed(exact([](Point& at) {
        const auto links = anyTwoLinks(at, Joint::kRevolute);
        at.equal("wd", links.next.alpha(),
                 Vector3<T>(links.i.alpha() + links.z() * links.joint.qdd +
                            links.w().cross(links.z()) * links.joint.qd));
      }))
      .ours(ourChain());
}

Trials eq48() {
  return Trials("eq48").printed(
      exact([](Point& at) { printedAcceleration(at, Joint::kRevolute); }));
}

Trials prismaticAcceleration() {
  return Trials("prismatic_acceleration")
      .printed(exact([](Point& at) { printedAcceleration(at, Joint::kPrismatic); }))
      .corrected(exact([](Point& at) {
        const auto links = anyTwoLinks(at, Joint::kPrismatic);
        const Vector3<T> w = links.w(), none = Vector3<T>::Zero();
        const T two_qd = links.joint.qd + links.joint.qd;
        const Vector6<T> A =
            joined<T>(w.cross(w.cross(links.r())) + w.cross(links.z()) * two_qd, none);
        at.equal("Xdd", links.next.acceleration().vector(),
                 shiftOfVelocity<T>(links.r()) * links.i.acceleration().vector() +
                     axis<T>(Joint::kPrismatic, links.z()) * links.joint.qdd + A);
      }));
}

Trials spatialRecursion() {
  return Trials("spatial_recursion")
      .printed(exact([](Point& at) {
        const auto links = anyTwoLinks(at, Joint::kRevolute);
        const auto spatial = [](const Path<T>& path) {
          const Motion<T> v = path.velocity(), a = path.acceleration();
          return joined<T>(a.linear - v.angular.cross(v.linear), a.angular);
        };
        const Vector3<T> w = links.w();
        at.equal("a", spatial(links.next),
                 shiftOfVelocity<T>(links.r()) * spatial(links.i) +
                     axis<T>(Joint::kRevolute, links.z()) * links.joint.qdd +
                     joined<T>(w.cross(w.cross(links.r())), w.cross(links.z()) * links.joint.qd));
      }))
      .corrected(exact([](Point& at) {
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
      }));
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

Child<T> anyChild(Point& at, Loads loads) {
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

void articulated(Point& at, int children) {
  const Matrix6<T> M = at.template symmetric<6>();
  const Vector6<T> Xdd = at.vector6(), none = Vector6<T>::Zero();
  std::vector<Child<T>> all;
  Matrix6<T> M_A = M;
  for (int k = 0; k < children; ++k) {
    all.push_back(anyChild(at, Loads::kNone));
    const Child<T>& child = all.back();
    M_A += child.T_F() * projectedInertia<T>(child.M, child.Z, child.d) * child.T_F().transpose();
  }
  at.equal("force on link i", neededForce<T>(M, none, none, all, Xdd), M_A * Xdd);
}

Trials eq49() {
  return Trials("eq49").printed(exact([](Point& at) { articulated(at, 1); })).ours(ourChain());
}

Trials branches() {
  return Trials("branches").printed(exact([](Point& at) { articulated(at, 2); }));
}

// (50) is read with F as (52) uses it: tau_i = Z' (F_i + M_Ai Xdd), so F is the force that link i
// needs beyond M_A Xdd.
template <typename Recursion>
void inward(Point& at, const Recursion& recursion) {
  const Matrix6<T> M = at.template symmetric<6>();
  const Vector6<T> none = Vector6<T>::Zero();
  const Vector6<T> F_b = at.vector6(), F_e = at.vector6();
  const Child<T> child = anyChild(at, Loads::kAll);
  // the child's own F: what it needs when its frame does not accelerate
  const Vector6<T> F_next = child.F_b - child.F_e;
  const Vector6<T> needed = neededForce<T>(M, F_b, F_e, {child}, none);
  recursion(at, child, F_next, F_b, F_e, needed);
}

const auto printedForce = [](Point& at, const auto& child, const auto& F_next, const auto& F_b,
                             const auto& F_e, const auto& needed) {
  const Vector6<T> passed = projectionOf<T>(child.M, child.Z, child.d) * F_next -
                            child.M * child.Z * (child.tau / child.D());
  at.equal("F_i", needed, child.T_F() * passed + F_b + F_e);
};

Trials eq50() {
  return Trials("eq50")
      .printed(exact([](Point& at) { inward(at, printedForce); }))
      .corrected(exact([](Point& at) {
        inward(at, [](Point& at, const auto& child, const auto& F_next, const auto& F_b,
                      const auto& F_e, const auto& needed) {
          const Vector6<T> passed =
              projectionOf<T>(child.M, child.Z, child.d) * Vector6<T>(F_next + child.M * child.A) +
              child.M * child.Z * (child.tau / child.D());
          at.equal("F_i", needed, child.T_F() * passed + F_b - F_e);
        });
        // the sweep of forward dynamics: link 1 of two that move, with a load on link 2
        const Robot<T> robot = anyRobot(at, {kTurn, kTurn});
        const SixVectors<T> six(robot);
        recursive::Model<T> model = robot.model();
        const Force<T> load = at.force();
        model.links[1].load = load;
        recursive::Workspace<T> ws(model);
        std::vector<T> qdd = robot.zeros();
        recursive::forwardDynamics(model, robot.x, robot.qd, robot.tau, ws, qdd);
        at.equal("our code: F_1", ws.f[0].vector(),
                 Vector6<T>(six.b[0] + six.passedOn(1, six.b[1] - load.vector())));
      }))
      .numbers([] {
        OnTheBoard arm("double_pendulum", 1);
        arm.tau[1] = 1;
        arm.move();
        const Force<double> F_b = biasForce(arm.model.links[0].M, arm.ws.v[0]);
        const Vector6<double> passed = arm.P(1) * arm.F(1) -
                                       arm.M_A(1) * OnTheBoard::Z() * (arm.tau[1] / arm.ws.D[1]),
                              printed = arm.T_F(1) * passed + F_b.vector();
        return componentRows(kForceNames, printed, arm.F(0));
      });
}

Trials forceSigns() {
  return Trials("force_signs")
      .printed(exact([](Point& at) {
        inward(at, [](Point& at, auto child, const auto&, const auto& F_b, const auto& F_e,
                      const auto&) {
          const Vector6<T> none = Vector6<T>::Zero();
          child.A = none;
          const Matrix6<T> any = Matrix6<T>::Zero();  // Xdd = 0: no own inertia needed
          const Vector6<T> needed = neededForce<T>(any, F_b, F_e, {child}, none);
          const Vector6<T> F_next = child.F_e - child.F_b;
          const Vector6<T> passed = projectionOf<T>(child.M, child.Z, child.d) * F_next -
                                    child.M * child.Z * (child.tau / child.D());
          at.equal("F_i", Vector6<T>(-needed), child.T_F() * passed + F_b + F_e);
        });
      }))
      .corrected(exact([](Point& at) {
        inward(at, [](Point& at, auto child, const auto&, const auto& F_b, const auto& F_e,
                      const auto&) {
          const Vector6<T> none = Vector6<T>::Zero();
          child.A = none;
          const Matrix6<T> any = Matrix6<T>::Zero();
          const Vector6<T> needed = neededForce<T>(any, F_b, F_e, {child}, none);
          const Vector6<T> F_next = child.F_e - child.F_b;
          const Vector6<T> passed = projectionOf<T>(child.M, child.Z, child.d) * F_next -
                                    child.M * child.Z * (child.tau / child.D());
          at.equal("F_i", Vector6<T>(-needed), child.T_F() * passed - F_b + F_e);
        });
      }));
}

Trials torqueReaction() {
  return Trials("torque_reaction").printed(exact([](Point& at) {
    JointProblem<T> problem;
    problem.M_2 = at.template symmetric<6>();
    problem.Z = at.vector6();
    problem.gear = T(1);
    problem.rotor = at.number();
    problem.tau = at.number();
    const Vector6<T> M_Z = problem.M_2 * problem.Z;
    at.equal("on link i", -solveJoint(problem).transmitted,
             -(M_Z * (problem.tau / (problem.rotor + problem.Z.dot(M_Z)))));
  }));
}

Trials superposition() {
  return Trials("superposition").printed(exact([](Point& at) {
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
  }));
}

// ---- trees and their cost ----------------------------------------------------------------------

/// Operations of one inverse and one forward dynamics of a chain of n revolute links.
Operations sweepCost(int n) {
  const recursive::Model<Counted> model = chainOfTurns(n);
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

Trials rootChoice() {
  return Trials("root_choice").printed(exact([](Point& at) {
    // two free bodies on one joint, all in one frame; forces on both, a joint torque
    const Matrix6<T> M_1 = at.template symmetric<6>(), M_2 = at.template symmetric<6>();
    const Vector6<T> Z = at.vector6(), F_1 = at.vector6(), F_2 = at.vector6();
    const T tau = at.number();
    const auto fromRoot = [&](const Matrix6<T>& M_r, const Matrix6<T>& M_o, const Vector6<T>& F_r,
                              const Vector6<T>& F_o, const Vector6<T>& axis) {
      const Matrix6<T> M_A = M_r + projectedInertia<T>(M_o, axis, T(0));
      const Vector6<T> M_Z = M_o * axis;
      const Vector6<T> F =
          F_r + projectionOf<T>(M_o, axis, T(0)) * F_o - M_Z * (tau / axis.dot(M_Z));
      return Vector6<T>(solveDense<T>(M_A, F));
    };
    const Vector6<T> Xdd_1 = fromRoot(M_1, M_2, F_1, F_2, Z);
    // from root 2 the joint is the other way round
    const Vector6<T> Xdd_2 = fromRoot(M_2, M_1, F_2, F_1, Vector6<T>(-Z));
    const Vector6<T> M_Z = M_2 * Z;
    const T qdd = (tau + Z.dot(F_2 - M_2 * Xdd_1)) / Z.dot(M_Z);
    at.equal("Xdd_2", Xdd_2, Xdd_1 + Z * qdd);
  }));
}

Trials sharedSubtree() {
  return Trials("shared_subtree")
      .printed(exact([](Point& at) {
        const Matrix6<T> M_3 = at.template symmetric<6>();
        const Vector6<T> Xdd_1 = at.vector6();
        const Matrix6<T> P_M = projectedInertia<T>(M_3, at.vector6(), T(0)) +
                               projectedInertia<T>(M_3, at.vector6(), T(0));
        // two joints with different axes between the same links leave no motion: Z_a qdd_a = Z_b
        // qdd_b only for 0
        at.equal("force that passes", M_3 * Xdd_1, P_M * Xdd_1);
      }))
      .corrected(exact([](Point& at) {
        // Between links 1 and 3 the motion x is along both axes, x = Z_a a = Z_b b, and the joints
        // together do no work on it. Two axes: [Z_a, -Z_b] (a, b) = 0, any two rows.
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
                 projectedInertia<T>(M_3, Z_a, T(0)) * Xdd_1);
      }));
}

Trials storedResults() {
  return Trials("stored_results").printed(decided("count of operations", [] {
    const long a = sweepCost(20).total() - sweepCost(10).total();
    const long b = sweepCost(30).total() - sweepCost(20).total();
    const bool quadratic = transformationsWithoutStore(30) == 30 * 31 / 2;
    return Decision{a == b && quadratic,
                    fmt::format("ten links more cost {} operations from 10 and {} from 20; "
                                "without a store 30 links take {} transformations",
                                a, b, transformationsWithoutStore(30))};
  }));
}

Trials linearTime() {
  return Trials("linear_time").printed(decided("count of operations", [] {
    const Operations ten = sweepCost(10), twenty = sweepCost(20), forty = sweepCost(40);
    const long step = (twenty.total() - ten.total()) / 10;
    return Decision{
        forty.total() - twenty.total() == 20 * step,
        fmt::format("{} operations a link in both together, from 10 links to 40", step)};
  }));
}

}  // namespace

std::vector<Trials> recursions() {
  return {positionRecursion(),
          eq42(),
          eq43(),
          eq44(),
          prismaticVelocity(),
          eq45(),
          eq46(),
          eq47(),
          eq48(),
          prismaticAcceleration(),
          spatialRecursion(),
          eq49(),
          branches(),
          eq50(),
          forceSigns(),
          torqueReaction(),
          superposition(),
          rootChoice(),
          sharedSubtree(),
          storedResults(),
          linearTime()};
}

}  // namespace dynwitness::audit
