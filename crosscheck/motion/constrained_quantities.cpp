// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/constrained_quantities.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/constrained_reactions.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "recursive/operational_space.hpp"
#include "recursive/point_springs.hpp"
#include "scene/motion.hpp"

namespace dynwitness::crosscheck {

using Matrix = recursive::MatrixX<double>;
using Vector = Eigen::VectorXd;

struct ConstrainedQuantities::Parts {
  explicit Parts(const scene::Scene& of)
      : scene(of),
        number(of.mechanism),
        model(recursive::buildModel(of.mechanism, number)),
        ws(model),
        closures(recursive::buildConstraints(of.mechanism, number, model)),
        springs(recursive::buildPointSprings(of.mechanism, number, model)),
        driven(recursive::drivenRates(of.mechanism)),
        joints(of.mechanism, number) {}
  std::vector<recursive::LinkConstraint<double>> held(const scene::State<double>& state) {
    return recursive::accelerationConstraints(scene.mechanism, number, model, state.x, state.qd,
                                              ws);
  }
  /// tau with the forces of springs between points; closures.J and gamma are of this state then.
  std::vector<double> forces(const scene::State<double>& state) {
    recursive::constraintEquations(model, state.x, state.qd, ws, closures);
    std::vector<double> tau = state.tau;
    recursive::addSpringForces(model, springs, closures.X_W, ws, tau);
    return tau;
  }

  scene::Scene scene;
  scene::RealNumbers<double> number;
  recursive::Model<double> model;
  recursive::Workspace<double> ws;
  recursive::Constraints<double> closures;
  std::vector<recursive::PointSpring<double>> springs;
  std::vector<char> driven;
  recursive::MechanismOfJoints<double> joints;
};

ConstrainedQuantities::ConstrainedQuantities(const scene::Scene& scene)
    : parts_(std::make_unique<Parts>(scene)) {}
ConstrainedQuantities::~ConstrainedQuantities() = default;

bool ConstrainedQuantities::isConstrained(const scene::Mechanism& mechanism) {
  return !mechanism.isOpenTree() || mechanism.isDriven() ||
         !mechanism.acceleration_constraints.empty();
}

ConstrainedRoad ConstrainedQuantities::usualRoad() const {
  const scene::Mechanism& mechanism = parts_->scene.mechanism;
  const bool both = !mechanism.closures.empty() &&
                    (mechanism.isDriven() || !mechanism.acceleration_constraints.empty());
  // the constrained sweeps solve for each joint where they pass it, which neither a follower nor a
  // rotor geared to several rates allows
  return both || mechanism.hasCoupledRates() ? ConstrainedRoad::kDense : ConstrainedRoad::kSweeps;
}

namespace {

Vector vectorOf(const std::vector<double>& v) {
  return Eigen::Map<const Vector>(v.data(), static_cast<Eigen::Index>(v.size()));
}
std::vector<bool> flags(const std::vector<char>& v, std::size_t from, std::size_t count) {
  return {v.begin() + static_cast<std::ptrdiff_t>(from),
          v.begin() + static_cast<std::ptrdiff_t>(from + count)};
}

}  // namespace

ConstrainedMotion ConstrainedQuantities::motion(const scene::State<double>& state,
                                                ConstrainedRoad road) const {
  Parts& p = *parts_;
  const int n = p.model.dof(), m_c = p.closures.rows();
  const std::vector<double> tau = p.forces(state);
  const auto held = p.held(state);
  const int m = static_cast<int>(held.size());
  ConstrainedMotion out;
  out.rows = m_c + m;
  out.lambda = Vector(m_c);
  out.nu = Vector(m);
  if (road == ConstrainedRoad::kSweeps) {
    if (usualRoad() == ConstrainedRoad::kDense)
      throw std::invalid_argument(
          "motion: closures with driven joints or acceleration constraints, or joints "
          "that follow others: expected the dense road");
    if (m_c > 0) {
      const auto swept =
          recursive::closedForwardDynamics(p.model, state.x, state.qd, tau, p.closures, p.ws);
      out.qdd = vectorOf(swept.qdd);
      out.lambda = swept.lambda;
      out.lambda_determined = flags(swept.determined, 0, m_c);
      out.tau = vectorOf(state.tau);
      out.rank = swept.rank;
      return out;
    }
    recursive::ConstraintWorkspace<double> cws(p.model, m);
    std::vector<double> qdd = state.qdd, with_springs = tau;
    recursive::hybridDynamics(p.model, state.x, state.qd, p.driven, held, p.ws, cws, qdd,
                              with_springs);
    out.qdd = vectorOf(qdd);
    out.nu = cws.nu;
    out.nu_determined = flags(cws.of_N.determined(), 0, m);
    out.tau = vectorOf(with_springs) - vectorOf(tau) + vectorOf(state.tau);
    out.rank = cws.of_N.rank();
    return out;
  }

  // one system: all rows, the driven joints' columns on the right
  Matrix J(m_c + m, n), M(n, n);
  Vector b(m_c + m), C = Vector::Zero(m_c + m);
  J.topRows(m_c) = p.closures.J;
  b.head(m_c) = -p.closures.gamma;
  Matrix J_held(m, n);
  recursive::taskJacobian(p.model, held, p.ws, J_held);
  J.bottomRows(m) = J_held;
  // A' a at qdd = 0 and without gravity is (dJ/dt) qd
  std::vector<double> zero(n, 0.0), bias(n);
  recursive::inverseDynamics(p.model, state.x, state.qd, zero, p.ws, bias,
                             recursive::Terms::none());
  for (int k = 0; k < m; ++k) {
    b(m_c + k) = held[k].b(0) - held[k].A.col(0).dot(p.ws.a[held[k].link].vector());
    C(m_c + k) = held[k].compliance(0);
  }
  recursive::inverseDynamics(p.model, state.x, state.qd, zero, p.ws, bias);
  recursive::massMatrix(p.model, state.x, p.ws, M);
  std::vector<int> free;
  Vector given = Vector::Zero(n);
  for (int i = 0; i < n; ++i) {
    if (p.driven[i])
      given(i) = state.qdd[i];
    else
      free.push_back(i);
  }
  const Vector f = vectorOf(tau) - vectorOf(bias) - M * given;
  const Eigen::LLT<Matrix> of_M(M(free, free));
  if (!free.empty() && of_M.info() != Eigen::Success)
    throw std::invalid_argument("motion: M: expected a positive definite matrix");
  const Matrix J_free = J(Eigen::all, free), M_inverse_J = of_M.solve(Matrix(J_free.transpose()));
  const Vector at_rest = of_M.solve(Vector(f(free)));
  Matrix N = J_free * M_inverse_J;
  N.diagonal() += C;
  recursive::SemidefiniteSolver<double> solver(m_c + m);
  solver.factorize(N);
  Vector force = b - J * given - J_free * at_rest;
  solver.solve(force);
  out.qdd = given;
  out.qdd(free) = at_rest + M_inverse_J * force;
  out.lambda = force.head(m_c);
  out.nu = force.tail(m);
  out.lambda_determined = flags(solver.determined(), 0, m_c);
  out.nu_determined = flags(solver.determined(), m_c, m);
  out.rank = solver.rank();
  const Vector taken = M * out.qdd + vectorOf(bias) - vectorOf(tau) - J.transpose() * force;
  out.tau = vectorOf(state.tau);
  for (int i = 0; i < n; ++i)
    if (p.driven[i]) out.tau(i) = taken(i) + state.tau[i];
  return out;
}

const char* name(ConstrainedQuantity quantity) {
  switch (quantity) {
    case ConstrainedQuantity::kQdd:
      return "qdd";
    case ConstrainedQuantity::kLambda:
      return "lambda";
    case ConstrainedQuantity::kNu:
      return "nu";
    case ConstrainedQuantity::kTauDrive:
      return "tau_drive";
    case ConstrainedQuantity::kN:
      return "N";
    case ConstrainedQuantity::kTaskInertia:
      return "Lambda";
    case ConstrainedQuantity::kJ:
      return "J";
    case ConstrainedQuantity::kJbar:
      return "Jbar";
    case ConstrainedQuantity::kTaskTorque:
      return "task_torque";
    case ConstrainedQuantity::kNullTorque:
      return "null_torque";
    case ConstrainedQuantity::kReactions:
      return "reactions";
  }
  return "?";
}

std::optional<ConstrainedQuantity> constrainedQuantityNamed(const std::string& text) {
  for (int k = 0; k <= static_cast<int>(ConstrainedQuantity::kReactions); ++k)
    if (const auto quantity = static_cast<ConstrainedQuantity>(k); text == name(quantity))
      return quantity;
  return std::nullopt;
}

Eigen::MatrixXd ConstrainedQuantities::answer(ConstrainedQuantity quantity,
                                              const scene::State<double>& state) const {
  using Asked = ConstrainedQuantity;
  const std::string asked = name(quantity);
  Parts& p = *parts_;
  const auto require = [&](bool holds, const char* what) {
    if (!holds)
      throw scene::InputError({p.scene.file.string(), 0},
                              asked + ": the scene has no " + what + ", expected one");
  };
  if (quantity == Asked::kQdd) return motion(state, usualRoad()).qdd;
  if (quantity == Asked::kLambda) {
    require(p.closures.rows() > 0, "closures");
    return motion(state, usualRoad()).lambda;
  }
  if (quantity == Asked::kReactions) {
    const scene::Mechanism& mechanism = p.scene.mechanism;
    const ConstrainedMotion moving = motion(state, usualRoad());
    const std::vector<double> qdd(moving.qdd.begin(), moving.qdd.end());
    std::vector<double> out(6 * (mechanism.links.size() - 1),
                            std::numeric_limits<double>::infinity());
    if (!moving.qdd.allFinite()) return vectorOf(out);  // no value, whichever reaction is asked
    recursive::constrainedReactions(mechanism, p.number, state.x, state.qd, qdd, moving.lambda,
                                    moving.nu, p.joints, out);
    const std::vector<char> determined =
        recursive::determinedReactions(mechanism, p.number, state.x, state.qd, p.driven, p.joints);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (!determined[i]) out[i] = std::numeric_limits<double>::quiet_NaN();
    return vectorOf(out);
  }
  const auto held = p.held(state);
  if (quantity == Asked::kNu) {
    require(!held.empty(), "acceleration_constraint");
    return motion(state, usualRoad()).nu;
  }
  if (quantity == Asked::kTauDrive) {
    require(p.scene.mechanism.isDriven(), "driven joint");
    return motion(state, usualRoad()).tau;
  }
  require(!held.empty(), "acceleration_constraint");
  if (p.scene.mechanism.hasMimics())
    throw scene::InputError(
        {p.scene.file.string(), 0},
        asked +
            ": joints follow others (mimic), which the sweeps of tasks do not know, "
            "allowed: qdd, lambda, nu, tau_drive");
  auto tasks = held;
  for (auto& task : tasks) task.compliance.resize(0);
  const int n = p.model.dof(), m = static_cast<int>(tasks.size());
  recursive::ConstraintWorkspace<double> cws(p.model, m);
  std::vector<double> qdd(n), tau = state.tau;
  recursive::constrainedForwardDynamics(p.model, state.x, state.qd, tau, tasks, p.ws, cws, qdd);
  Matrix J(m, n), Jbar(n, m);
  recursive::taskJacobian(p.model, tasks, p.ws, J);
  if (quantity == Asked::kJ) return J;
  if (quantity == Asked::kN) return cws.N;
  if (cws.of_N.rank() < m)
    throw scene::InputError({p.scene.file.string(), 0}, asked + ": the constraints are " +
                                                            std::to_string(m) + " of rank " +
                                                            std::to_string(cws.of_N.rank()) +
                                                            " here, allowed: independent ones");
  if (quantity == Asked::kTaskInertia) {
    Matrix inverse = Matrix::Identity(m, m);
    for (int k = 0; k < m; ++k) {
      Vector column = inverse.col(k);
      cws.of_N.solve(column);
      inverse.col(k) = column;
    }
    return inverse;
  }
  recursive::dynamicallyConsistentInverse(p.model, p.ws, cws, Jbar);
  if (quantity == Asked::kJbar) return Jbar;
  if (quantity == Asked::kNullTorque) {
    recursive::nullSpaceTorque(J, Jbar, tau);
    return vectorOf(tau);
  }
  recursive::taskTorque(p.model, state.x, state.qd, tasks, p.ws, cws, tau);
  return vectorOf(tau);
}

scene::State<double> ConstrainedQuantities::start() const {
  const Parts& p = *parts_;
  scene::State<double> state;
  std::vector<double> q;
  for (const scene::Number& x : p.scene.start_q) q.push_back(p.number(x));
  for (const scene::Number& qd : p.scene.start_qd) state.qd.push_back(p.number(qd));
  state.qdd.assign(state.qd.size(), 0.0);
  state.tau.assign(state.qd.size(), 0.0);
  std::size_t rate = 0, slot = 0;
  for (const scene::Link& link : p.scene.mechanism.links) {
    for (std::size_t k = 0; k < link.joint.motion.size(); ++k) {
      const scene::Jet<double> jet = scene::motionAt(link.joint.motion[k], p.number, 0.0);
      q[slot + k] = jet.value;
      state.qd[rate + k] = jet.rate;
      state.qdd[rate + k] = jet.second;
    }
    rate += static_cast<std::size_t>(link.joint.ownRates());
    slot += scene::positionSlots(link.joint.kind).size();
  }
  for (const double x : q) state.x.push_back(scene::jointPosition(x));
  return state;
}

}  // namespace dynwitness::crosscheck
