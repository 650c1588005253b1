// SPDX-License-Identifier: GPL-3.0-or-later
// Sections 11.2 to 13: floating and constrained bases, tasks as constraints, consistent inverses.
#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/constraints.hpp"

namespace dynwitness::audit {
namespace {

/// A robot whose base is a body of its own and moves.
Robot<T> floatingRobot(Point& at, const std::vector<JointKind>& kinds) {
  Robot<T> robot = anyRobot(at, kinds);
  robot.base_body = robot.body[0];
  for (Vector3<T>& place : robot.base_body.r) place = at.vector();
  robot.base_velocity = at.motion();
  return robot;
}

/// Everything at once: base, joints, constraint on a link (nu) and constraint on the base (kappa).
template <typename T>
struct Floating {
  Vector6<T> a_0;
  std::vector<T> qdd;
  VectorX<T> nu, kappa;
};
template <typename T>
Floating<T> denseFloating(const Robot<T>& robot, const LinkConstraint<T>& held,
                          const MatrixX<T>& A_0, const VectorX<T>& b_0) {
  const int n = robot.n(), m = static_cast<int>(held.A.cols()), k = static_cast<int>(A_0.cols());
  const MatrixX<T> to_base = SixVectors<T>(robot).fromBase(held.link).transpose() * held.A;
  const MatrixX<T> to_joints = robot.jacobian(held.link).transpose() * held.A;
  const VectorX<T> x = solveAffine<T>(6 + n + m + k, [&](const VectorX<T>& unknown) {
    const Motion<T> a_0 = {unknown.template segment<3>(0), unknown.template segment<3>(3)};
    const std::vector<T> qdd = Robot<T>::values(unknown.segment(6, n));
    const VectorX<T> nu = unknown.segment(6 + n, m), kappa = unknown.tail(k);
    VectorX<T> residual(6 + n + m + k);
    residual.head(6) = robot.baseForce(qdd, a_0).vector() - to_base * nu - A_0 * kappa;
    residual.segment(6, n) = robot.forces(robot.qd, qdd, robot.gravity, a_0) -
                             Robot<T>::column(robot.tau) - to_joints * nu;
    const auto path = robot.paths(robot.qd, qdd, a_0)[held.link];
    residual.segment(6 + n, m) = held.A.transpose() * robot.accelerationOf(path) - held.b;
    residual.tail(k) = A_0.transpose() * a_0.vector() - b_0;
    return residual;
  });
  return {x.head(6), Robot<T>::values(x.segment(6, n)), x.segment(6 + n, m), x.tail(k)};
}

/// Articulated inertia and bias force of the base, and what the inward sweep of a constraint gives.
template <typename T>
struct BaseProblem {
  BaseProblem(const Robot<T>& robot, const LinkConstraint<T>& held)
      : six(robot), inward(carriedInward(six, held)), M_A(massMatrix6(robot.base_body)) {
    const Vector6<T> v = robot.base_velocity.vector();
    F = -(SixVectors<T>::crossMatrix(v).transpose() * (M_A * v));
    const std::vector<Vector6<T>> p = six.biasForces();
    for (int i = 0; i < six.n(); ++i) {
      if (six.parent(i) >= 0) continue;
      M_A += six.X[i].transpose() * (six.P(i) * six.M_A[i]) * six.X[i];
      F += six.passedOn(i, p[i]);
    }
    g = -six.gravityAtBase();
    shifted_b = held.b - held.A.transpose() * (six.fromBase(held.link) * g);
  }
  SixVectors<T> six;
  CarriedInward<T> inward;
  Matrix6<T> M_A;
  Vector6<T> F, g;
  VectorX<T> shifted_b;
};

/// Whether the transpose of a matrix can be multiplied with a motion.
Trial transposeFits(const MatrixX<double>& A_0) {
  return decided("count", [=]() -> Decision {
    const Eigen::Index columns = A_0.transpose().cols(),
                       rows = Motion<double>::zero().vector().rows();
    return {columns == rows, "A_0' has " + std::to_string(columns) + " columns, Xdd_0 has " +
                                 std::to_string(rows) + " rows"};
  });
}

/// A double pendulum at rest whose shoulder is cut loose: its upper rod is a base that floats.
Rows looseShoulderRows() {
  const HeldElbow elbow(0);
  const OnTheBoard& arm = elbow.arm;
  const Vector6<double> g = -(arm.T_V(0) * arm.gravityAtBase()), E = elbow.E(0);
  const double e = elbow.E(1)(5), N = -e * e / arm.ws.D[1],  // the elbow's share, (57)
      beta = 0;                                              // at rest, without torques
  const auto M = arm.M_A(0).ldlt();
  const Vector6<double> yields = M.solve(E);
  const double shifted_b = elbow.held.b(0) - elbow.held.A.col(0).dot(arm.T_V(1) * g),
               nu = (shifted_b + yields.dot(arm.F(0)) - beta) / (N - E.dot(yields));
  const Vector6<double> printed = -M.solve(arm.F(0) + E * nu);
  return componentRows(kAccelerationNames, printed, Vector6<double>(printed + g));
}

Trials eq59() {
  return Trials("eq59")
      .printed(exact([](Point& at) {
        const auto robot = floatingRobot(at, {kTurn});
        const auto held = anyConstraint<1>(at, 0);
        const MatrixX<T> none(6, 0);
        const Floating<T> truth = denseFloating<T>(robot, held, none, VectorX<T>(0));
        const BaseProblem<T> base(robot, held);
        const Vector6<T> load = base.F - base.inward.E_0 * truth.nu;
        at.equal("M_A,0 Xdd_0", Vector6<T>(base.M_A * truth.a_0), Vector6<T>(-load));
      }))
      .condition(exact([](Point& at) {
        auto robot = floatingRobot(at, {kTurn});
        robot.gravity = Vector3<T>::Zero();
        const auto held = anyConstraint<1>(at, 0);
        const Floating<T> truth = denseFloating<T>(robot, held, MatrixX<T>(6, 0), VectorX<T>(0));
        const BaseProblem<T> base(robot, held);
        at.equal("M_A,0 Xdd_0", Vector6<T>(base.M_A * truth.a_0),
                 Vector6<T>(-(base.F - base.inward.E_0 * truth.nu)));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = floatingRobot(at, {kTurn, kSlide});
        const auto held = anyConstraint<1>(at, 1);
        const Floating<T> truth = denseFloating<T>(robot, held, MatrixX<T>(6, 0), VectorX<T>(0));
        const BaseProblem<T> base(robot, held);
        const MatrixX<T>& E = base.inward.E_0;
        const VectorX<T> nu = -truth.nu;
        at.equal("Xdd_0", Vector6<T>(base.M_A * (truth.a_0 - base.g)),
                 Vector6<T>(-(base.F + E * nu)));
        const VectorX<T> E_in = solveDense<T>(base.M_A, E.col(0));  // m = 1
        at.equal("nu", VectorX<T>(base.inward.N_0 * nu - E.transpose() * E_in * nu),
                 VectorX<T>(base.shifted_b + E_in.transpose() * base.F - base.inward.beta_0));
      }))
      .numbers(looseShoulderRows);
}

Trials eq60() {
  return Trials("eq60")
      .printed(transposeFits(MatrixX<double>::Zero(2, 6)))
      .corrected(transposeFits(MatrixX<double>::Zero(6, 2)))
      .numbers([] {
        const auto row = [](const char* which, const MatrixX<double>& A_0) {
          const Eigen::Index columns = A_0.transpose().cols();
          return std::vector<std::string>{
              which, std::to_string(A_0.cols()) + " x " + std::to_string(columns), "6 x 1",
              columns == 6 ? std::to_string(A_0.cols()) + " x 1" : "none: the sizes do not fit"};
        };
        return Rows{row("printed", MatrixX<double>::Zero(2, 6)),
                    row("so", MatrixX<double>::Zero(6, 2))};
      });
}

Trials baseOptimum() {
  return Trials("base_optimum").printed(exact([](Point& at) {
    const auto robot = floatingRobot(at, {kTurn, kTurn});
    const auto held = anyConstraint<1>(at, 1);
    const MatrixX<T> A_0 = at.template matrix<6, 2>();
    const VectorX<T> b_0 = at.template matrix<2, 1>();
    const Floating<T> truth = denseFloating<T>(robot, held, A_0, b_0);
    const BaseProblem<T> base(robot, held);
    MatrixX<T> K = MatrixX<T>::Constant(9, 9, T(0));  // a (6), nu (1), kappa (2)
    VectorX<T> rhs(9);
    K.block(0, 0, 6, 6) = base.M_A;
    K.block(0, 6, 6, 1) = base.inward.E_0;
    K.block(0, 7, 6, 2) = -A_0;
    K.block(6, 0, 1, 6) = base.inward.E_0.transpose();
    K.block(6, 6, 1, 1) = base.inward.N_0;
    K.block(7, 0, 2, 6) = A_0.transpose();
    rhs << -base.F, base.shifted_b - base.inward.beta_0, b_0 - A_0.transpose() * base.g;
    const VectorX<T> x = solveDense<T>(K, rhs);
    at.equal("Xdd_0", Vector6<T>(x.head(6) + base.g), truth.a_0);
    at.equal("kappa", VectorX<T>(x.tail(2)), truth.kappa);
  }));
}

void compareTaskTorques(Point& at, bool projected) {
  auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
  robot.tau = robot.zeros();
  robot.gravity = Vector3<T>::Zero();
  robot.qd = robot.zeros();
  const auto held = anyConstraint<3>(at, 2);
  const Constrained<T> truth = denseConstrained<T>(robot, {held});
  const VectorX<T> needed = robot.forces(truth.qdd);
  const SixVectors<T> six(robot);
  const auto inward = carriedInward(six, held);
  Vector6<T> F = held.A * truth.nu;  // on the link; the chapter's with the other sign
  for (int i = 2; i >= 0; --i) {
    const Vector6<T> felt = projected ? Vector6<T>(inward.E[i] * truth.nu) : F;
    at.equal("tau", T(six.Z[i].dot(felt)), needed(i));
    F = (six.X[i].transpose() * F).eval();
  }
}

/// Whether joint forces leave the task alone, and whether they move the robot.
void compareNullMotion(Point& at, const std::vector<JointKind>& kinds, bool moves) {
  auto robot = anyRobot(at, kinds);
  const auto held = anyConstraint<2>(at, static_cast<int>(kinds.size()) - 1);
  const Constrained<T> pushed = denseConstrained<T>(robot, {held});
  if (!moves) {
    at.equal("A' a", constrainedAcceleration(robot, held, pushed.qdd), held.b);
    return;
  }
  robot.tau = robot.zeros();
  const Constrained<T> left = denseConstrained<T>(robot, {held});
  at.equal("qdd", Robot<T>::column(pushed.qdd), Robot<T>::column(left.qdd));
}

/// J of a task and M, both by point masses.
template <typename T>
struct Task {
  MatrixX<T> J, M, M_inverse, Jbar;
};
template <typename T>
Task<T> taskOf(const Robot<T>& robot, const LinkConstraint<T>& held) {
  Task<T> task;
  task.J = held.A.transpose() * robot.jacobian(held.link);
  task.M = robot.massMatrix();
  task.M_inverse = inverseDense<T>(task.M);
  const MatrixX<T> mobility = task.J * task.M_inverse * task.J.transpose();
  task.Jbar = task.M_inverse * task.J.transpose() * inverseDense<T>(mobility);
  return task;
}
template <typename T>
MatrixX<T> one(Eigen::Index n) {
  return MatrixX<T>::Identity(n, n);
}

Trials taskTorques() {
  return Trials("task_torques")
      .printed(exact([](Point& at) { compareTaskTorques(at, true); }))
      .corrected(exact([](Point& at) { compareTaskTorques(at, false); }))
      .numbers([] {
        const HeldElbow held(0, 5);
        const double push = -held.nu();  // on the rod
        Rows rows;
        Vector6<double> A = held.held.A;
        for (std::size_t i = held.arm.n(); i-- > 0; A = (held.arm.T_F(i) * A).eval())
          rows.insert(rows.begin(),
                      {std::to_string(i + 1), onBoard(held.E(i)(5) * push), onBoard(A(5) * push)});
        return rows;
      });
}

Trials nullTorque() {
  return Trials("null_torque").printed(exact([](Point& at) {
    compareNullMotion(at, {kTurn, kSlide, kTurn}, false);
  }));
}

Trials nullMotion() {
  return Trials("null_motion")
      .printed(differs([](Point& at) {
        compareNullMotion(at, {kTurn, kTurn}, true);
      }))
      .condition(differs([](Point& at) {
        compareNullMotion(at, {kTurn, kSlide, kTurn}, true);
      }))
      .corrected(exact([](Point& at) {
        compareNullMotion(at, {kTurn, kTurn}, true);
      }));
}

Trials E0Rank() {
  return Trials("E0_rank")
      .printed(differs([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide}, Rotors::kNone);
        auto held = anyConstraint<6>(at, 1);
        held.A = Matrix6<T>::Identity();
        at.zero("det E_0", determinant<T>(carriedInward(SixVectors<T>(robot), held).E_0));
      }))
      .condition(differs([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide});
        auto held = anyConstraint<6>(at, 1);
        held.A = Matrix6<T>::Identity();
        at.zero("det E_0", determinant<T>(carriedInward(SixVectors<T>(robot), held).E_0));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        auto held = anyConstraint<6>(at, 2);
        held.A = Matrix6<T>::Identity();
        const SixVectors<T> six(robot);
        T product = T(1);
        for (int i = 0; i < 3; ++i) product *= robot.rotor[i] / six.D[i];
        at.equal("det E_0", determinant<T>(carriedInward(six, held).E_0), product);
      }));
}

Trials E0Overconstrained() {
  return Trials("E0_overconstrained")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn});
        const auto held = anyConstraint<6>(at, 1);
        at.zero("det E_0", determinant<T>(carriedInward(SixVectors<T>(robot), held).E_0));
      }))
      .corrected(
          both(differs([](Point& at) {
                 const auto robot = anyRobot(at, {kTurn, kTurn});
                 const auto held = anyConstraint<6>(at, 1);
                 at.zero("det E_0", determinant<T>(carriedInward(SixVectors<T>(robot), held).E_0));
               }),
               exact([](Point& at) {
                 const auto robot = anyRobot(at, {kTurn, kTurn});
                 const auto held = anyConstraint<3>(at, 1);
                 at.zero("det N_0", determinant<T>(carriedInward(SixVectors<T>(robot), held).N_0));
               })));
}

Trials E0Weighted() {
  return Trials("E0_weighted").printed(exact([](Point& at) {
    auto robot = anyRobot(at, {kTurn, kSlide});
    const auto held = anyConstraint<2>(at, 1);
    const SixVectors<T> six(robot);
    MatrixX<T> H(2, 6);
    for (int k = 0; k < 6; ++k) {
      Motion<T> base = Motion<T>::zero();
      (k < 3 ? base.linear(k) : base.angular(k - 3)) = T(1);
      H.col(k) = robot.forces(robot.zeros(), robot.zeros(), Vector3<T>::Zero(), base);
    }
    const MatrixX<T> response =
        six.fromBase(1) - robot.jacobian(1) * inverseDense<T>(robot.massMatrix()) * H;
    at.equal("E_0'", MatrixX<T>(carriedInward(six, held).E_0.transpose()),
             MatrixX<T>(held.A.transpose() * response));
  }));
}

Trials postureControl() {
  return Trials("posture_control").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
    const Task<T> task = taskOf(robot, anyConstraint<1>(at, 2));
    const VectorX<T> wanted = at.template matrix<1, 1>();  // b - Jd qd
    const VectorX<T> posture = at.template matrix<3, 1>(), any = at.template matrix<3, 1>();
    const MatrixX<T> keep = one<T>(3) - task.Jbar * task.J;
    const VectorX<T> qdd = task.Jbar * wanted + keep * posture;
    const VectorX<T> x = task.Jbar * wanted + keep * any;
    const auto norm = [&](const VectorX<T>& y) { return T(y.dot(VectorX<T>(task.M * y))); };
    at.equal("J qdd", VectorX<T>(task.J * qdd), wanted);
    at.equal("J x", VectorX<T>(task.J * x), wanted);
    at.equal("Pythagoras", norm(x - posture), T(norm(qdd - posture) + norm(x - qdd)));
  }));
}

Trials branchMerge() {
  return Trials("branch_merge").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kTurn, kSlide}, Rotors::kAll, {-1, 0, 0});
    const auto left = anyConstraint<1>(at, 1), right = anyConstraint<1>(at, 2);
    const Swept<T> swept(robot, {left, right});
    MatrixX<T> J(2, 3);
    J << left.A.transpose() * robot.jacobian(1), right.A.transpose() * robot.jacobian(2);
    at.equal("N", swept.N, MatrixX<T>(J * inverseDense<T>(robot.massMatrix()) * J.transpose()));
    at.equal("tau", VectorX<T>(robot.forces(swept.qdd) - Robot<T>::column(robot.tau)),
             VectorX<T>(J.transpose() * swept.nu));
    at.equal("left", constrainedAcceleration(robot, left, swept.qdd), left.b);
    at.equal("right", constrainedAcceleration(robot, right, swept.qdd), right.b);
  }));
}

Trials consistentInverse() {
  return Trials("consistent_inverse").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
    const auto held = anyConstraint<2>(at, 2);
    const Task<T> task = taskOf(robot, held);
    const MatrixX<T> Jbar = sweptConsistentInverse(robot, held);
    at.equal("by sweeps", Jbar, task.Jbar);
    at.equal("J Jbar", MatrixX<T>(task.J * Jbar), one<T>(2));
    at.zero(
        "J M^-1 (1 - J' Jbar')",
        MatrixX<T>(task.J * task.M_inverse * (one<T>(3) - task.J.transpose() * Jbar.transpose())));
  }));
}

Trials plainPseudoInverse() {
  return Trials("plain_pseudo_inverse")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        const Task<T> task = taskOf(robot, anyConstraint<1>(at, 2));
        const MatrixX<T> plus =
            task.J.transpose() * inverseDense<T>(MatrixX<T>(task.J * task.J.transpose()));
        at.zero("J M^-1 (1 - J' (J+)')",
                MatrixX<T>(task.J * task.M_inverse *
                           (one<T>(3) - task.J.transpose() * plus.transpose())));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        const Task<T> task = taskOf(robot, anyConstraint<1>(at, 2));
        // every right inverse is Jbar + (1 - Jbar J) Y; what it leaves is that of Y alone
        const MatrixX<T> Y = at.template matrix<3, 1>();
        const MatrixX<T> rest = (one<T>(3) - task.Jbar * task.J) * Y;
        const MatrixX<T> B = task.Jbar + rest;
        const MatrixX<T> mobility = task.J * task.M_inverse * task.J.transpose();
        at.equal("J B", MatrixX<T>(task.J * B), one<T>(1));
        at.equal(
            "what B lets through",
            MatrixX<T>(task.J * task.M_inverse * (one<T>(3) - task.J.transpose() * B.transpose())),
            MatrixX<T>(-mobility * rest.transpose()));
      }));
}

Trials leastKineticEnergy() {
  return Trials("least_kinetic_energy")
      .printed(both(exact([](Point& at) {
                      const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
                      const Task<T> task = taskOf(robot, anyConstraint<1>(at, 2));
                      const VectorX<T> qd = task.Jbar * at.template matrix<1, 1>();
                      const VectorX<T> other =
                          (one<T>(3) - task.Jbar * task.J) * at.template matrix<3, 1>();
                      const auto energy = [&](const VectorX<T>& y) {
                        return T(y.dot(VectorX<T>(task.M * y)) / T(2));
                      };
                      at.equal("T", energy(qd + other), T(energy(qd) + energy(other)));
                    }),
                    certified([](RealPoint& at) {
                      const Robot<Ball> robot = realRobot(at, 2);
                      Ball twice_T(0);
                      for (int i = 0; i < 2; ++i)
                        twice_T += robot.rotor[i] * robot.qd[i] * robot.qd[i];
                      const auto paths = robot.paths(robot.qd, robot.zeros());
                      for (int i = 0; i < 2; ++i)
                        for (std::size_t k = 0; k < robot.body[i].m.size(); ++k) {
                          const Vector3<Ball> v =
                              rate<Ball, 3, 1>(paths[i].place(robot.body[i].r[k]));
                          twice_T += robot.body[i].m[k] * v.dot(v);
                        }
                      at.positive("T", twice_T);
                    })));
}

}  // namespace

std::vector<Trials> tasks() {
  return {eq59(),
          eq60(),
          baseOptimum(),
          taskTorques(),
          nullTorque(),
          nullMotion(),
          E0Rank(),
          E0Overconstrained(),
          E0Weighted(),
          postureControl(),
          branchMerge(),
          consistentInverse(),
          plainPseudoInverse(),
          leastKineticEnergy()};
}

}  // namespace dynwitness::audit
