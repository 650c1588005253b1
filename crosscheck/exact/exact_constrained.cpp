// SPDX-License-Identifier: GPL-3.0-or-later
// Constrained and hybrid dynamics by sweeps against one dense system of Lagrange's equations.
#include <algorithm>
#include <memory>

#include "crosscheck/exact/inquiry.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "recursive/least_constraint.hpp"
#include "recursive/operational_space.hpp"
#include "symbolic/closures.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {
namespace {

template <typename T>
using VectorOf = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// Lagrange's equations with rows of constraints, as a program.
struct DenseProgram {
  DenseProgram(const scene::Mechanism& mechanism, Parameters parameters) {
    symbolic::Options options;
    options.fold_parameters = parameters == Parameters::kAsWritten;
    symbolic::Equations e = symbolic::derive(mechanism, options);
    const symbolic::ClosureEquations closures = symbolic::closureEquations(mechanism, options, e);
    std::vector<scene::Attachment> points;
    for (const scene::AccelerationConstraint& held : mechanism.acceleration_constraints)
      points.push_back({held.link, held.at, {}});
    const symbolic::ClosureEquations frames =
        symbolic::frameEquations(mechanism, options, points, e);
    n = e.dof();
    std::vector<symbolic::Node> outputs = symbolic::massCoriolisGravity(e);
    const auto add = [&outputs](const std::vector<symbolic::Node>& more) {
      outputs.insert(outputs.end(), more.begin(), more.end());
    };
    add(e.Q);
    for (const symbolic::ClosureEquations* rows : {&closures, &frames}) {
      add(rows->phi);
      for (const auto& row : rows->J) add(row);
      add(rows->gamma);
    }
    closure_rows = static_cast<int>(closures.phi.size());
    program = symbolic::compile(e.graph, outputs);
  }
  symbolic::Program program;
  int n = 0, closure_rows = 0;
};

/// What the program says at a state: M qdd + bias = tau + J' nu,  J qdd + C nu = b.
template <typename T>
struct DenseEquations {
  MatrixOf<T> M, J;
  VectorOf<T> bias, b, C;
};

/// Reads numbers off one after the other.
template <typename T>
MatrixOf<T> take(const T*& from, Eigen::Index rows, Eigen::Index columns) {
  MatrixOf<T> m(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < columns; ++j) m(i, j) = *from++;
  return m;
}

/// The rows of closures first, then those of acceleration constraints.
template <typename Numbers, typename T = typename Numbers::Scalar>
DenseEquations<T> denseEquations(const DenseProgram& dense, const scene::Mechanism& mechanism,
                                 const Numbers& number, const scene::State<T>& state) {
  const std::vector<T> values = symbolic::ProgramRun<T>(dense.program, number)(state);
  const T* from = values.data();
  const int n = dense.n, m = dense.closure_rows;
  const auto& held = mechanism.acceleration_constraints;
  const int k = static_cast<int>(held.size());
  DenseEquations<T> out;
  out.M = take(from, n, n);
  const VectorOf<T> c = take(from, n, 1), g = take(from, n, 1), Q = take(from, n, 1);
  out.bias = c + g - Q;
  out.J = MatrixOf<T>::Constant(m + k, n, T(0));
  out.b = out.C = VectorOf<T>::Constant(m + k, T(0));
  take(from, m, 1);  // phi
  out.J.topRows(m) = take(from, m, n);
  out.b.head(m) = take(from, m, 1) * T(-1);
  const MatrixOf<T> place = take(from, 12 * k, 1), J = take(from, 12 * k, n),
                    gamma = take(from, 12 * k, 1);
  using V3 = Eigen::Matrix<T, 3, 1>;
  const auto numbers = [&number](const scene::Vector& v) {
    return V3(number(v[0]), number(v[1]), number(v[2]));
  };
  for (int i = 0; i < k; ++i) {
    V3 u = numbers(held[i].direction), d = numbers(held[i].rotation);
    const auto axis = [&](int a) {
      return V3(place.col(0).template segment<3>(12 * i + 3 + 3 * a));
    };
    if (held[i].axes == scene::AccelerationConstraint::Axes::kLink) {
      u = (axis(0) * u(0) + axis(1) * u(1) + axis(2) * u(2)).eval();
      d = (axis(0) * d(0) + axis(1) * d(1) + axis(2) * d(2)).eval();
    }
    // u . x'' + d . w',  w' = sum of e_a x e_a'' / 2
    const auto seen = [&](const auto& column) {
      T sum = u.dot(V3(column.template segment<3>(12 * i)));
      for (int a = 0; a < 3; ++a)
        sum += d.dot(axis(a).cross(V3(column.template segment<3>(12 * i + 3 + 3 * a)))) / T(2);
      return sum;
    };
    for (int j = 0; j < n; ++j) out.J(m + i, j) = seen(J.col(j));
    out.b(m + i) = number(held[i].value) - seen(gamma.col(0));
    out.C(m + i) = number(held[i].compliance);
  }
  return out;
}

template <typename T>
struct DenseSolution {
  VectorOf<T> qdd, nu, tau;
};

/// One symmetric system in all unknowns, [M J'; J -C] (qdd, -nu) = (tau - bias, b), driven joints'
/// columns on the right; then the forces of the driven joints from their rows.
template <typename T>
DenseSolution<T> solveDense(const DenseEquations<T>& e, const std::vector<char>& driven,
                            const std::vector<T>& tau, const std::vector<T>& qdd) {
  const int n = static_cast<int>(e.M.rows()), m = static_cast<int>(e.J.rows());
  std::vector<int> free;
  DenseSolution<T> out{VectorOf<T>::Constant(n, T(0)), VectorOf<T>(m), VectorOf<T>(n)};
  for (int i = 0; i < n; ++i) {
    if (driven[i])
      out.qdd(i) = qdd[i];
    else
      free.push_back(i);
  }
  const int f = static_cast<int>(free.size());
  const VectorOf<T> inertial = e.M * out.qdd + e.bias, given = e.J * out.qdd;
  MatrixOf<T> K = MatrixOf<T>::Constant(f + m, f + m, T(0));
  VectorOf<T> x(f + m);
  for (int i = 0; i < f; ++i) {
    for (int j = 0; j < f; ++j) K(i, j) = e.M(free[i], free[j]);
    for (int k = 0; k < m; ++k) K(f + k, i) = K(i, f + k) = e.J(k, free[i]);
    x(i) = tau[free[i]] - inertial(free[i]);
  }
  for (int k = 0; k < m; ++k) {
    K(f + k, f + k) = -e.C(k);
    x(f + k) = e.b(k) - given(k);
  }
  recursive::factorize(K);
  recursive::solve(K, x);
  for (int i = 0; i < f; ++i) out.qdd(free[i]) = x(i);
  for (int k = 0; k < m; ++k) out.nu(k) = -x(f + k);
  const VectorOf<T> all = e.M * out.qdd + e.bias - e.J.transpose() * out.nu;
  for (int i = 0; i < n; ++i) out.tau(i) = driven[i] ? all(i) : tau[i];
  return out;
}

CheckResult question(const char* law, const char* quantity, const char* statement) {
  CheckResult result;
  result.law = law;
  result.quantity = quantity;
  result.statement = statement;
  result.left = "lagrange";
  result.right = "sweeps";
  return result;
}

/// Fills in what both sides say, or why one cannot.
template <typename Ask>
SidesOfAll answered(std::size_t count, const Ask& ask) {
  SidesOfAll all(count);
  try {
    ask(all);
  } catch (const DivisionByZero& error) {
    for (TwoSides<PrimeField>& failed : all) failed.failure = error.what();
  }
  return all;
}

/// Loops by local elimination.
Inquiry loops(const scene::Mechanism& mechanism, std::shared_ptr<const DenseProgram> dense) {
  Inquiry inquiry;
  inquiry.checks = {
      question("closed loops", "qdd",
               "qdd of closed loops, each eliminated where it closes = one dense system"),
      question("closed loops", "lambda",
               "multipliers of closed loops by the sweeps = one dense system")};
  inquiry.ask = [dense, &mechanism](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state) {
    using T = PrimeField;
    return answered(2, [&](SidesOfAll& all) {
      const auto model = recursive::buildModel(mechanism, number);
      recursive::Workspace<T> ws(model);
      auto closures = recursive::buildConstraints(mechanism, number, model);
      recursive::constraintEquations(model, state.x, state.qd, ws, closures);
      const auto swept =
          recursive::closedForwardDynamics(model, state.x, state.qd, state.tau, closures, ws);
      DenseEquations<T> e = denseEquations(*dense, mechanism, number, state);
      e.J.conservativeResize(dense->closure_rows, Eigen::NoChange);
      e.b.conservativeResize(dense->closure_rows);
      e.C.conservativeResize(dense->closure_rows);
      const DenseSolution<T> x =
          solveDense(e, std::vector<char>(model.dof(), 0), state.tau, state.qdd);
      all[0].left = x.qdd;
      all[0].right = column(swept.qdd);
      all[1].left = x.nu;
      all[1].right = swept.lambda;
    });
  };
  return inquiry;
}

/// Driven joints and acceleration constraints.
Inquiry hybrid(const scene::Mechanism& mechanism, std::shared_ptr<const DenseProgram> dense) {
  Inquiry inquiry;
  inquiry.checks = {
      question("hybrid dynamics", "qdd",
               "qdd with driven joints and constraints on links by the sweeps = one dense system"),
      question("hybrid dynamics", "nu",
               "forces of constraints on links by the sweeps = one dense system"),
      question("hybrid dynamics", "tau",
               "forces of driven joints by the sweeps = one dense system"),
      question(
          "operational space", "b",
          "J qdd + (dJ/dt) qd under the controller's torques = what the task asks, whatever the "
          "posture")};
  inquiry.ask = [dense, &mechanism](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state) {
    using T = PrimeField;
    return answered(4, [&](SidesOfAll& all) {
      const auto model = recursive::buildModel(mechanism, number);
      recursive::Workspace<T> ws(model);
      auto held =
          recursive::accelerationConstraints(mechanism, number, model, state.x, state.qd, ws);
      recursive::ConstraintWorkspace<T> cws(model, static_cast<int>(held.size()));
      std::vector<char> driven;
      for (const scene::Expression* motion : mechanism.motions()) driven.push_back(motion ? 1 : 0);
      std::vector<T> qdd = state.qdd, tau = state.tau;
      recursive::hybridDynamics(model, state.x, state.qd, driven, held, ws, cws, qdd, tau);
      DenseEquations<T> e = denseEquations(*dense, mechanism, number, state);
      const Eigen::Index k = static_cast<Eigen::Index>(held.size());
      e.J = e.J.bottomRows(k).eval();
      e.b = e.b.tail(k).eval();
      e.C = e.C.tail(k).eval();
      const DenseSolution<T> x = solveDense(e, driven, state.tau, state.qdd);
      all[0].left = x.qdd;
      all[0].right = column(qdd);
      all[1].left = x.nu;
      all[1].right = cws.nu;
      all[2].left = x.tau;
      all[2].right = column(tau);
      // the same constraints as tasks of motors at all joints
      for (auto& task : held) task.compliance.resize(0);
      tau = state.tau;
      if (k > 0) recursive::taskTorque(model, state.x, state.qd, held, ws, cws, tau);
      MatrixOf<T> M = e.M;
      VectorOf<T> moved = column(tau) - e.bias;
      recursive::factorize(M);
      recursive::solve(M, moved);
      all[3].left = e.J * moved;
      all[3].right = e.b;
    });
  };
  return inquiry;
}

/// A constrained base by Gauss' problem of six unknowns.
Inquiry baseProblem(const scene::Mechanism& mechanism, std::shared_ptr<const DenseProgram> dense) {
  Inquiry inquiry;
  inquiry.checks = {
      question(
          "least constraint", "qdd",
          "qdd of a floating robot with a constrained base, Gauss' problem of six unknowns = one "
          "dense system"),
      question("least constraint", "nu",
               "forces on the base by Gauss' problem = one dense system")};
  inquiry.ask = [dense, &mechanism](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state) {
    using T = PrimeField;
    return answered(2, [&](SidesOfAll& all) {
      const auto model = recursive::buildModel(mechanism, number);
      recursive::Workspace<T> ws(model);
      const auto held =
          recursive::accelerationConstraints(mechanism, number, model, state.x, state.qd, ws);
      const Eigen::Index k = static_cast<Eigen::Index>(held.size());
      recursive::LinkConstraint<T> base;
      base.A.resize(6, k);
      base.b.resize(k);
      for (Eigen::Index i = 0; i < k; ++i) {
        base.A.col(i) = held[i].A.col(0);
        base.b(i) = held[i].b(0);
      }
      std::vector<T> qdd = state.qdd;
      VectorOf<T> force;
      recursive::baseConstrainedDynamics(model, state.x, state.qd, state.tau, base, ws, qdd,
                                         &force);
      DenseEquations<T> e = denseEquations(*dense, mechanism, number, state);
      e.J = e.J.bottomRows(k).eval();
      e.b = e.b.tail(k).eval();
      e.C = e.C.tail(k).eval();
      const DenseSolution<T> x =
          solveDense(e, std::vector<char>(model.dof(), 0), state.tau, state.qdd);
      all[0].left = x.qdd;
      all[0].right = column(qdd);
      all[1].left = x.nu;
      all[1].right = force;
    });
  };
  return inquiry;
}

/// Whether all acceleration constraints are hard and on the link that floats.
bool holdsItsBase(const scene::Mechanism& mechanism) {
  const auto& held = mechanism.acceleration_constraints;
  return !held.empty() && !mechanism.isDriven() &&
         std::all_of(held.begin(), held.end(), [&](const scene::AccelerationConstraint& one) {
           const scene::Link& link = mechanism.links[static_cast<std::size_t>(one.link)];
           return one.link == 1 && link.joint.kind == scene::JointKind::kFloating &&
                  one.compliance.isLiteralZero();
         });
}

}  // namespace

std::vector<CheckResult> checkConstrainedExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const scene::Mechanism* derived) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const bool is_held = mechanism.isDriven() || !mechanism.acceleration_constraints.empty();
  if (mechanism.closures.empty() && !is_held) return {};
  if (mechanism.hasMimics()) {
    CheckResult check = question("closed and hybrid dynamics", "qdd",
                                 "constrained motion by the sweeps = one dense system");
    check.seed = options.seed;
    check.verdict = Verdict::kNotAnswerable;
    check.reason =
        "joints follow others (mimic), and the constrained sweeps solve for each joint where they "
        "pass it";
    return {check};
  }
  const auto dense =
      std::make_shared<const DenseProgram>(derived ? *derived : mechanism, options.parameters);
  std::vector<CheckResult> checks;
  if (!mechanism.closures.empty()) checks = decide(scene, loops(mechanism, dense), options);
  if (is_held)
    for (const CheckResult& check : decide(scene, hybrid(mechanism, dense), options))
      checks.push_back(check);
  if (holdsItsBase(mechanism))
    for (const CheckResult& check : decide(scene, baseProblem(mechanism, dense), options))
      checks.push_back(check);
  return checks;
}

}  // namespace dynwitness::crosscheck
