// SPDX-License-Identifier: GPL-3.0-or-later
// The chapter's question whether N_0 is always definite, in numbers: arms, poses and constraints.
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "crosscheck/audit/audit.hpp"
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

}  // namespace dynwitness::audit
