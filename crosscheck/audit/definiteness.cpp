// SPDX-License-Identifier: GPL-3.0-or-later
// The chapter's question whether N_0 is always definite; in numbers: arms, poses and constraints.
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "crosscheck/audit/constraints.hpp"
#include "recursive/build_model.hpp"
#include "recursive/constrained_dynamics.hpp"
#include "scene/scene.hpp"

namespace dynwitness::audit {
namespace {

using Held = recursive::LinkConstraint<double>;

/// -N_0 for wrenches on links of a mechanism at a pose.
recursive::MatrixX<double> matrixN(const scene::Mechanism& mechanism, const std::vector<double>& q,
                                   const std::vector<Held>& held) {
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  recursive::Workspace<double> ws(model);
  std::vector<scene::JointPosition<double>> x;
  for (const double angle : q) x.push_back(scene::jointPosition(angle));
  const std::vector<double> zero(model.dof(), 0.0);
  std::vector<double> qdd = zero;
  recursive::forwardDynamics(model, x, zero, zero, ws, qdd);
  int m = 0;
  for (const Held& one : held) m += static_cast<int>(one.A.cols());
  recursive::ConstraintWorkspace<double> cws(model, m);
  recursive::propagateConstraints(model, held, ws, cws);
  return cws.N;
}

/// Forces and moments on a link's frame: the first `count` of (fx, fy, fz, mx, my, mz), at the
/// point `at`.
Held along(int link, int count, double at = 0) {
  Held held;
  held.link = link;
  held.A = Eigen::Matrix<double, 6, 6>::Identity().leftCols(count);
  for (int k = 1; k < std::min(count, 3); ++k)
    held.A(k == 1 ? 5 : 4, k) = k == 1 ? at : -at;  // at e_x x e_k
  held.b = Eigen::VectorXd::Zero(count);
  held.compliance = Eigen::VectorXd::Zero(count);
  return held;
}

/// Two rods without mass, a point mass of 1 kg at the end of each, 1 m long, in the xy plane.
scene::Scene twoPointMasses() {
  std::string text = "[[link]]\nname = \"ground\"\n";
  for (const char* name : {"upper", "fore"})
    text += fmt::format(
        "[[link]]\nname = \"{}\"\nparent = \"{}\"\nmass = 1\ncom = [1, 0, 0]\njoint = {{ kind = "
        "\"revolute\"{} }}\n",
        name, name[0] == 'u' ? "ground" : "upper", name[0] == 'u' ? "" : ", xyz = [1, 0, 0]");
  return scene::readSceneToml(text, "two point masses");
}

}  // namespace

Rows definitenessRows() {
  Rows rows;
  const auto add = [&](const std::string& pose, const std::string& what,
                       const scene::Mechanism& mechanism, const std::vector<double>& q,
                       const std::vector<Held>& held) {
    const recursive::MatrixX<double> N = matrixN(mechanism, q, held);
    const Eigen::VectorXd lambda =
        Eigen::SelfAdjointEigenSolver<recursive::MatrixX<double>>(N).eigenvalues();
    recursive::SemidefiniteSolver<double> solver(static_cast<int>(N.rows()));
    solver.factorize(N);
    const bool definite = solver.rank() == N.rows();
    rows.push_back({pose, what, std::to_string(N.rows()), std::to_string(solver.rank()),
                    definite ? fmt::format("{:.2e}", lambda(0))
                             : fmt::format("0 (rounding {:.0e})", std::abs(lambda(0))),
                    fmt::format("{:.3g}", lambda(lambda.size() - 1)),
                    definite ? "definite" : "semidefinite"});
  };
  const scene::Mechanism arm = twoPointMasses().mechanism;
  for (const double q : {1.0, 0.1, 0.01, 0.001, 0.0})
    add(fmt::format("two rods, q = {}", q), "tip in x and y", arm, {0.3, q}, {along(1, 2, 1)});
  const scene::Mechanism puma = scene::findScene("puma_560").mechanism;
  const double pi = std::acos(-1.0);
  add("PUMA 560, nominal pose", "hand in all 6", puma, {0, pi / 4, pi, 0, pi / 4, 0},
      {along(5, 6)});
  add("PUMA 560, wrist straight (q5 = 0)", "hand in all 6", puma, {0, pi / 4, pi, 0, 0, 0},
      {along(5, 6)});
  Held soft = along(5, 6);
  soft.compliance.setConstant(0.01);
  add("PUMA 560, wrist straight", "hand in all 6, compliance 0.01", puma, {0, pi / 4, pi, 0, 0, 0},
      {soft});
  add("PUMA 560, nominal pose", "hand in x, and once more", puma, {0, pi / 4, pi, 0, pi / 4, 0},
      {along(5, 1), along(5, 1)});
  add("PUMA 560, nominal pose", "hand in 6 and forearm in 1: more than 6 joints", puma,
      {0, pi / 4, pi, 0, pi / 4, 0}, {along(5, 6), along(3, 1)});
  add("Franka Panda, ready pose", "hand in all 6: a joint to spare",
      scene::findScene("franka_panda").mechanism, {0, -pi / 4, 0, -3 * pi / 4, 0, pi / 2, pi / 4},
      {along(6, 6)});
  return rows;
}

Trials definiteness() {
  return Trials("N_definite")
      .printed(differs([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn, kTurn});
        auto held = anyConstraint<2>(at, 2);
        held.A.col(1) = held.A.col(0) * at.number();
        at.zero("det N_0", determinant<T>(carriedInward(SixVectors<T>(robot), held).N_0));
      }))
      .condition(certified([](RealPoint& at) {
        const Robot<Ball> robot = realRobot(at, 3);
        const LinkConstraint<Ball> held = realConstraint(at, 2, 2);
        const auto inward = carriedInward(SixVectors<Ball>(robot), held);
        VectorX<Ball> y(2);
        y << at.number(-1, 1), at.number(-1, 1);
        at.positive("-y' N_0 y", -y.dot(VectorX<Ball>(inward.N_0.lazyProduct(y))));
      }))
      .corrected(both(exact([](Point& at) {
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
                        at.equal("sum of squares", T(-y.dot(VectorX<T>(inward.N_0 * y))), squares);
                      }),
                      exact([](Point& at) {  // a stretched planar arm, held along itself
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
      .numbers(definitenessRows);
}

}  // namespace dynwitness::audit
