// SPDX-License-Identifier: GPL-3.0-or-later
// Constrained and hybrid dynamics by sweeps against one dense system of Lagrange's equations.
#include <algorithm>
#include <memory>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/dense_equations.hpp"
#include "crosscheck/witnesses/lagrange.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/constrained_reactions.hpp"
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
                                    const scene::State<PrimeField>& state,
                                    const std::vector<char>&) {
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
      const VectorX<T> drive = column(taken) - closures.J.transpose() * swept.lambda;
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
                                    const scene::State<PrimeField>& state,
                                    const std::vector<char>&) {
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
      MatrixX<T> M = e.M;
      VectorX<T> moved = column(tau) - e.bias;
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
                                    const scene::State<PrimeField>& state,
                                    const std::vector<char>&) {
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
      VectorX<T> force;
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

/** A field has no square root for the length l of springs between points, so that another pull is
    put in place of theirs,  (stiffness l^2 + damping l l') d,  which asks the same of the points,
    their distance and its rate. Here for the sweeps. */
recursive::Vector3<PrimeField> fieldPull(const recursive::PointSpring<PrimeField>& s,
                                         const recursive::Vector3<PrimeField>& d,
                                         const recursive::Vector3<PrimeField>& d_rate) {
  return d * PrimeField(s.stiffness * d.dot(d) + s.damping * d.dot(d_rate));
}
/// And by length, for what is derived.
auto fieldPullByLength(const FieldNumbers& number) {
  return [&number](const scene::Spring& spring, const PrimeField& l2, const PrimeField& l_l_rate) {
    return number(spring.stiffness) * l2 + number(spring.damping) * l_l_rate;
  };
}

/// Springs between points, as fieldPull() has them.
Inquiry springs(const scene::Mechanism& mechanism,
                std::shared_ptr<const DerivedConstraints> dense) {
  Inquiry inquiry;
  inquiry.checks = {question(
      "springs between points", "tau",
      "joint forces of pulls (stiffness l^2 + damping l l') d between points by the sweeps = their "
      "virtual work")};
  inquiry.ask = [dense, &mechanism](const FieldNumbers& number,
                                    const scene::State<PrimeField>& state,
                                    const std::vector<char>&) {
    using T = PrimeField;
    return answered(1, [&](SidesOfAll& all) {
      const auto model = recursive::buildModel(mechanism, number);
      recursive::Workspace<T> ws(model);
      auto closures = recursive::buildConstraints(mechanism, number, model);
      recursive::constraintEquations(model, state.x, state.qd, ws, closures);
      std::vector<T> tau(model.dof(), T(0));
      recursive::detail::addPulls(model, recursive::buildPointSprings(mechanism, number, model),
                                  closures.X_W, ws, tau, fieldPull);
      const DenseEquations<T> e = derivedEquations<false>(*dense, mechanism, number, state);
      all[0].left =
          detail::againstSprings(
              e.frames, static_cast<Eigen::Index>(mechanism.acceleration_constraints.size()),
              mechanism, number, state.qd, fieldPullByLength(number)) *
          T(-1);
      all[0].right = column(tau);
    });
  };
  return inquiry;
}

/** Reactions of all joints under closures, springs and acceleration constraints. Both sides are
    formulas in qdd and the multipliers, whatever these are: any will do, and so redundant closures
    do, which leave them open. */
Inquiry reactions(const scene::Mechanism& mechanism,
                  std::shared_ptr<const DerivedConstraints> dense,
                  std::shared_ptr<const DerivedReactions> cut) {
  Inquiry inquiry;
  inquiry.checks = {question(
      "reactions of the whole mechanism", "reactions",
      "reactions by the sweeps, for any qdd and multipliers, springs pulling (stiffness l^2 + "
      "damping l l') d = multipliers of cut joints")};
  inquiry.ask = [dense, cut, &mechanism](const FieldNumbers& number,
                                         const scene::State<PrimeField>& state,
                                         const std::vector<char>&) {
    using T = PrimeField;
    return answered(1, [&](SidesOfAll& all) {
      const auto held = static_cast<Eigen::Index>(mechanism.acceleration_constraints.size());
      VectorX<T> forces(dense->closure_rows + held);
      for (Eigen::Index i = 0; i < forces.size(); ++i) {
        const auto n = static_cast<Eigen::Index>(state.tau.size());
        forces(i) = state.tau[static_cast<std::size_t>(i % n)] * T(1 + static_cast<int>(i / n));
      }
      const DenseEquations<T> e = derivedEquations<false>(*dense, mechanism, number, state);
      all[0].left =
          derivedReactions(*cut, e, mechanism, number, state, forces, fieldPullByLength(number));
      recursive::MechanismOfJoints<T> of(mechanism, number);
      std::vector<T> swept(6 * (mechanism.links.size() - 1), T(0));
      recursive::detail::reactionsUnder(
          mechanism, number, state.x, state.qd, state.qdd,
          VectorX<T>(forces.head(dense->closure_rows)), VectorX<T>(forces.tail(held)),
          [&of](std::vector<T>& tau) {
            recursive::detail::addPulls(of.model, of.springs, of.closures.X_W, of.ws, tau,
                                        fieldPull);
          },
          of, swept);
      all[0].right = column(swept);
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

/// No sweep answers, and why.
CheckResult unanswered(const char* law, const char* quantity, const char* statement,
                       const char* reason, const ExactOptions& options) {
  CheckResult check = question(law, quantity, statement);
  check.seed = options.seed;
  check.verdict = Verdict::kNotAnswerable;
  check.reason = reason;
  return check;
}

}  // namespace

std::vector<CheckResult> checkConstrainedExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const scene::Mechanism* derived) {
  return checkConstrainedExactly(scene, options,
                                 DerivedPrograms(derived ? *derived : scene.mechanism,
                                                 options.parameters == Parameters::kAsWritten));
}

std::vector<CheckResult> checkConstrainedExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const DerivedPrograms& derived) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const bool is_held = mechanism.isDriven() || !mechanism.acceleration_constraints.empty(),
             is_closed = !mechanism.closures.empty();
  if (mechanism.isOpenTree() && !is_held) return {};
  const auto dense = std::make_shared<const DerivedConstraints>(derived, true);
  std::vector<CheckResult> checks;
  const auto ask = [&](const Inquiry& inquiry) {
    for (const CheckResult& check : decide(scene, inquiry, options)) checks.push_back(check);
  };
  ask(reactions(mechanism, dense, std::make_shared<const DerivedReactions>(derived.cut())));
  if (!mechanism.springs.empty()) ask(springs(mechanism, dense));
  if (mechanism.hasMimics() && (is_closed || is_held)) {
    checks.push_back(unanswered(
        "closed and hybrid dynamics", "qdd", "constrained motion by the sweeps = one dense system",
        "joints follow others (mimic), and the constrained sweeps solve for each joint where they "
        "pass it",
        options));
    return checks;
  }
  if (is_closed) ask(loops(mechanism, dense));
  if (is_closed && !mechanism.acceleration_constraints.empty())
    checks.push_back(
        unanswered("closed loops", "nu",
                   "closed loops under acceleration constraints by the sweeps = one dense system",
                   "no sweep eliminates loops under acceleration constraints", options));
  if (is_held) ask(hybrid(mechanism, dense));
  if (holdsItsBase(mechanism)) ask(baseProblem(mechanism, dense));
  return checks;
}

}  // namespace dynwitness::crosscheck
