// SPDX-License-Identifier: GPL-3.0-or-later
// Constrained and hybrid dynamics by sweeps against one dense system of Lagrange's equations.
#include <algorithm>
#include <memory>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/witnesses/dense_equations.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "recursive/least_constraint.hpp"
#include "recursive/operational_space.hpp"

namespace dynwitness::crosscheck {
namespace {

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

/// Loops by local elimination, driven joints among theirs.
Inquiry loops(const scene::Mechanism& mechanism, std::shared_ptr<const DerivedConstraints> dense) {
  Inquiry inquiry;
  inquiry.checks = {
      question("closed loops", "qdd",
               "qdd of closed loops, each eliminated where it closes = one dense system"),
      question("closed loops", "lambda",
               "multipliers of closed loops by the sweeps = one dense system")};
  if (mechanism.isDriven())
    inquiry.checks.push_back(
        question("closed loops", "tau",
                 "forces of driven joints in closed loops by the sweeps = one dense system"));
  inquiry.ask = [dense, &mechanism](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state) {
    using T = PrimeField;
    return answered(mechanism.isDriven() ? 3 : 2, [&](SidesOfAll& all) {
      const auto model = recursive::buildModel(mechanism, number);
      recursive::Workspace<T> ws(model);
      const std::vector<char> driven = recursive::drivenRates(mechanism);
      auto closures = recursive::buildConstraints(mechanism, number, model);
      recursive::constraintEquations(model, state.x, state.qd, ws, closures);
      const auto swept = recursive::closedForwardDynamics(model, state.x, state.qd, state.tau,
                                                          closures, ws, false, driven, state.qdd);
      DenseEquations<T> e = derivedEquations<false>(*dense, mechanism, number, state);
      e.J.conservativeResize(dense->closure_rows, Eigen::NoChange);
      e.b.conservativeResize(dense->closure_rows);
      e.C.conservativeResize(dense->closure_rows);
      const DenseSolution<T> x = solveDense(e, driven, state.tau, state.qdd);
      all[0].left = x.qdd;
      all[0].right = column(swept.qdd);
      all[1].left = x.nu;
      all[1].right = swept.lambda;
      if (!mechanism.isDriven()) return;
      std::vector<T> taken(model.dof(), T(0));
      recursive::inverseDynamics(model, state.x, state.qd, swept.qdd, ws, taken);
      const VectorOf<T> drive = column(taken) - closures.J.transpose() * swept.lambda;
      all[2].left = x.tau;
      all[2].right = column(state.tau);
      for (int i = 0; i < model.dof(); ++i)
        if (driven[i]) all[2].right(i, 0) = drive(i);
    });
  };
  return inquiry;
}

/// Driven joints and acceleration constraints.
Inquiry hybrid(const scene::Mechanism& mechanism, std::shared_ptr<const DerivedConstraints> dense) {
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
      const std::vector<char> driven = recursive::drivenRates(mechanism);
      std::vector<T> qdd = state.qdd, tau = state.tau;
      recursive::hybridDynamics(model, state.x, state.qd, driven, held, ws, cws, qdd, tau);
      DenseEquations<T> e = derivedEquations<false>(*dense, mechanism, number, state);
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
Inquiry baseProblem(const scene::Mechanism& mechanism,
                    std::shared_ptr<const DerivedConstraints> dense) {
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
      DenseEquations<T> e = derivedEquations<false>(*dense, mechanism, number, state);
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

/** Springs between points. A field has no square root for their length l, so that another pull is
    put in place of theirs,  (stiffness l^2 + damping l l') d,  which asks the same of the points,
    their distance and its rate. */
Inquiry springs(const scene::Mechanism& mechanism,
                std::shared_ptr<const DerivedConstraints> dense) {
  Inquiry inquiry;
  inquiry.checks = {question(
      "springs between points", "tau",
      "joint forces of pulls (stiffness l^2 + damping l l') d between points by the sweeps = their "
      "virtual work")};
  inquiry.ask = [dense, &mechanism](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state) {
    using T = PrimeField;
    return answered(1, [&](SidesOfAll& all) {
      const auto model = recursive::buildModel(mechanism, number);
      recursive::Workspace<T> ws(model);
      auto closures = recursive::buildConstraints(mechanism, number, model);
      recursive::constraintEquations(model, state.x, state.qd, ws, closures);
      std::vector<T> tau(model.dof(), T(0));
      recursive::detail::addPulls(
          model, recursive::buildPointSprings(mechanism, number, model), closures.X_W, ws, tau,
          [](const recursive::PointSpring<T>& s, const recursive::Vector3<T>& d,
             const recursive::Vector3<T>& d_rate) {
            return recursive::Vector3<T>(d * T(s.stiffness * d.dot(d) + s.damping * d.dot(d_rate)));
          });
      const DenseEquations<T> e = derivedEquations<false>(*dense, mechanism, number, state);
      all[0].left =
          detail::againstSprings(
              e.frames, static_cast<Eigen::Index>(mechanism.acceleration_constraints.size()),
              mechanism, number, state.qd,
              [&number](const scene::Spring& spring, const T& l2, const T& l_l_rate) {
                return number(spring.stiffness) * l2 + number(spring.damping) * l_l_rate;
              }) *
          T(-1);
      all[0].right = column(tau);
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
  if (mechanism.isOpenTree() && !is_held) return {};
  if (mechanism.hasMimics() && (!mechanism.closures.empty() || is_held)) {
    CheckResult check = question("closed and hybrid dynamics", "qdd",
                                 "constrained motion by the sweeps = one dense system");
    check.seed = options.seed;
    check.verdict = Verdict::kNotAnswerable;
    check.reason =
        "joints follow others (mimic), and the constrained sweeps solve for each joint where they "
        "pass it";
    return {check};
  }
  const auto dense = std::make_shared<const DerivedConstraints>(
      derived ? *derived : mechanism, options.parameters == Parameters::kAsWritten, true);
  std::vector<CheckResult> checks;
  if (!mechanism.closures.empty()) checks = decide(scene, loops(mechanism, dense), options);
  if (!mechanism.springs.empty())
    for (const CheckResult& check : decide(scene, springs(mechanism, dense), options))
      checks.push_back(check);
  if (!mechanism.closures.empty() && !mechanism.acceleration_constraints.empty()) {
    CheckResult check = question("closed loops", "nu",
                                 "closed loops under acceleration constraints by the sweeps = one "
                                 "dense system");
    check.seed = options.seed;
    check.verdict = Verdict::kNotAnswerable;
    check.reason = "no sweep eliminates loops under acceleration constraints";
    checks.push_back(check);
  }
  if (is_held)
    for (const CheckResult& check : decide(scene, hybrid(mechanism, dense), options))
      checks.push_back(check);
  if (holdsItsBase(mechanism))
    for (const CheckResult& check : decide(scene, baseProblem(mechanism, dense), options))
      checks.push_back(check);
  return checks;
}

}  // namespace dynwitness::crosscheck
