// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/closed_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/joint_forces.hpp"
#include "scene/motion.hpp"

namespace dynwitness::crosscheck {

ClosedMotion::ClosedMotion(const scene::Scene& scene, double baumgarte_rate, Controller controller,
                           std::function<void(double, std::vector<double>*)> pushes)
    : number_(scene.mechanism),
      model_(recursive::buildModel(scene.mechanism, number_)),
      ws_(model_),
      constraints_(recursive::buildConstraints(scene.mechanism, number_, model_)),
      springs_(recursive::buildPointSprings(scene.mechanism, number_, model_)),
      baumgarte_(baumgarte_rate),
      x_(model_.positions),
      qd_(dof()),
      q_rate_(model_.positions),
      tau_(dof()),
      bias_(dof()),
      pushes_(std::move(pushes)),
      push_(dof(), 0.0),
      motors_(dof(), 0.0),
      given_(dof(), 0.0),
      M_(dof(), dof()),
      controller_(controller),
      tasks_(scene.mechanism, model_),
      task_force_(Vector::Zero(tasks_.count())) {
  int rate = 0, slot = 0;
  for (const scene::Link& link : scene.mechanism.links) {
    const int rates = link.joint.ownRates();  // followers' positions are integrated with the others
    const int slots = static_cast<int>(scene::positionSlots(link.joint.kind).size());
    if (link.joint.motion.empty()) {
      for (int k = 0; k < rates; ++k) free_.push_back(rate + k);
      for (int k = 0; k < slots; ++k) free_slots_.push_back(slot + k);
      if (rates == 1) posture_.push_back({rate, slot});
    } else {
      for (int k = 0; k < rates; ++k) drives_.push_back({rate + k, slot + k, link.joint.motion[k]});
    }
    rate += rates;
    slot += slots;
  }
  posture_start_ = Vector::Zero(static_cast<Eigen::Index>(posture_.size()));
  if (controller_.tasks == Controller::Tasks::kImpedance) return;
  const auto& held = scene.mechanism.acceleration_constraints;
  for (int k = 0; k < tasks_.count(); ++k) {
    const bool yields = controller_.tasks == Controller::Tasks::kConstraint &&
                        number_(held[static_cast<std::size_t>(k)].compliance) != 0;
    (yields ? yielding_ : rigid_).push_back(k);
  }
}

void ClosedMotion::startHere(const State& y) {
  equations(y, 0);
  tasks_.startHere();
  for (std::size_t i = 0; i < posture_.size(); ++i)
    posture_start_(static_cast<Eigen::Index>(i)) = x_[posture_[i][1]].q;
}

ClosedMotion::State ClosedMotion::start(const scene::Scene& scene) const {
  State y;
  for (const scene::Number& q : scene.start_q) y.push_back(number_(q));
  for (const scene::Number& qd : scene.start_qd) y.push_back(number_(qd));
  y.push_back(0);
  impose(0, &y);
  return y;
}

bool ClosedMotion::isClosed() const {
  const double least = std::sqrt(std::numeric_limits<double>::epsilon());
  return phi() <= least && phiRateSize() <= least;
}

void ClosedMotion::impose(double time, State* y) const {
  for (const Drive& drive : drives_) {
    const scene::Jet<double> q = scene::motionAt(drive.motion, number_, time);
    (*y)[drive.slot] = q.value;
    (*y)[positions() + drive.rate] = q.rate;
  }
}

void ClosedMotion::equations(const State& y, double time) {
  for (int i = 0; i < positions(); ++i) x_[i].q = y[i];
  std::copy_n(y.begin() + positions(), dof(), qd_.begin());
  for (const Drive& drive : drives_) {
    const scene::Jet<double> q = scene::motionAt(drive.motion, number_, time);
    x_[drive.slot].q = q.value;
    qd_[drive.rate] = q.rate;
    given_[drive.rate] = q.second;
  }
  if (pushes_) {
    std::fill(push_.begin(), push_.end(), 0.0);
    pushes_(time, &push_);
  }
  for (auto& x : x_) x = scene::jointPosition(x.q);
  recursive::constraintEquations(model_, x_, qd_, ws_, constraints_);
  time_ = time;
  if (tasks_.count() > 0) tasks_.at(x_, qd_, constraints_, ws_);
}

void ClosedMotion::operator()(const State& y, State& rate, double time) {
  ++evaluations;
  const Solution result = accelerations(y, time);
  recursive::positionRates(model_, x_, qd_, q_rate_);
  std::copy(q_rate_.begin(), q_rate_.end(), rate.begin());
  for (int i = 0; i < dof(); ++i) rate[positions() + i] = result.qdd(i);
  double power =
      loadPower() - spring_.dissipation - recursive::frictionPower(model_, qd_) + control_power_;
  if (hasHeldRows()) power += result.nu.dot(tasks_.rate);
  for (const Drive& drive : drives_) power += result.drive(drive.rate) * qd_[drive.rate];
  rate.back() = power;
}

void ClosedMotion::choose(const State& y, double time) {
  equations(y, time);
  recursive::massMatrix(model_, x_, ws_, M_);
  solver_.factorize(M_(free_, free_), constraints_.J(Eigen::all, free_));
  chosen_ = solver_.independentRows();
  if (!rigid_.empty()) chooseHeld();
}

/// One after the other, behind all closures, which nothing else keeps.
void ClosedMotion::chooseHeld() {
  chosen_rigid_.clear();
  const auto closed = static_cast<Eigen::Index>(chosen_.size());
  for (const int k : rigid_) {
    recursive::MatrixX<double> J(closed + static_cast<Eigen::Index>(chosen_rigid_.size()) + 1,
                                 dof());
    J << constraints_.J(chosen_, Eigen::all), tasks_.J(chosen_rigid_, Eigen::all), tasks_.J.row(k);
    solver_held_.factorize(M_(free_, free_), J(Eigen::all, free_));
    if (solver_held_.rank() == J.rows()) chosen_rigid_.push_back(k);
  }
}

ClosedMotion::Solution ClosedMotion::accelerations(const State& y, double time) {
  equations(y, time);
  return solved(false);
}
ClosedMotion::Solution ClosedMotion::accelerationsOfAll(const State& y, double time) {
  equations(y, time);
  return solved(true);
}

void ClosedMotion::pull() {
  tau_ = motors_ = push_;
  spring_ = recursive::addSpringForces(model_, springs_, constraints_.X_W, ws_, tau_);
  control_power_ = 0;
  const auto add = [&](int rate, double force) {
    tau_[rate] += force;
    motors_[rate] += force;
    control_power_ += force * qd_[rate];
  };
  if (controller_.hasPosture())
    for (std::size_t i = 0; i < posture_.size(); ++i) {
      const auto [rate, slot] = posture_[i];
      add(rate, controller_.posture_stiffness *
                        (posture_start_(static_cast<Eigen::Index>(i)) - x_[slot].q) -
                    controller_.posture_damping * qd_[rate]);
    }
  if (controller_.tasks != Controller::Tasks::kImpedance || tasks_.count() == 0) return;
  task_force_ = -controller_.task_stiffness * tasks_.placeErrors(time_) -
                controller_.task_damping * tasks_.rateErrors(time_);
  const Vector tau = tasks_.J.transpose() * task_force_;
  for (int i = 0; i < dof(); ++i) add(i, tau(i));
}

ClosedMotion::Vector ClosedMotion::forces() {
  pull();
  recursive::inverseDynamics(model_, x_, qd_, given_, ws_, bias_);
  Vector f(dof());
  for (int i = 0; i < dof(); ++i) f(i) = tau_[i] - bias_[i];
  return f;
}

ClosedMotion::Solution ClosedMotion::solved(bool all) {
  const Vector f = forces();
  const Eigen::Map<const Vector> given(given_.data(), dof());
  const Vector b = -constraints_.gamma - constraints_.J * given - 2 * baumgarte_ * phiRate() -
                   baumgarte_ * baumgarte_ * constraints_.phi;
  if (hasHeldRows()) return solvedHeld(all, f, b);
  Solution out;
  out.nu = task_force_;
  out.motors = Eigen::Map<const Vector>(motors_.data(), dof());
  out.lambda = Vector::Zero(rows());
  if (all) {
    recursive::massMatrix(model_, x_, ws_, M_);
    solver_.factorize(M_(free_, free_), constraints_.J(Eigen::all, free_));
    const auto result = solver_.solve(f(free_), b);
    out.qdd = ofAll(result.qdd);
    out.lambda = result.lambda;
    out.determined = result.determined;
    out.contradiction = result.contradiction;
  } else {
    factorizeChosen();
    const auto result = solver_.solve(f(free_), b(chosen_));
    out.qdd = ofAll(result.qdd);
    out.lambda(chosen_) = result.lambda;
    out.determined.assign(rows(), chosen_.size() == static_cast<std::size_t>(rows()));
    out.contradiction = result.contradiction;
  }
  out.drive = Vector::Zero(dof());
  if (drives_.empty()) return out;
  const Vector taken =
      M_ * out.qdd - f - constraints_.J.transpose() * out.lambda;  // f has no M qdd_f
  for (const Drive& drive : drives_) out.drive(drive.rate) = taken(drive.rate);
  out.qdd += given;
  return out;
}

/** With the acceleration constraints: rigid ones as rows, those that give way (y) by
        nu_y = C^-1 (b_y - J_y qdd),  which makes M + J_y' C^-1 J_y of M
    @param f, b  as without them */
ClosedMotion::Solution ClosedMotion::solvedHeld(bool all, const Vector& f, const Vector& b) {
  const Eigen::Map<const Vector> given(given_.data(), dof());
  Vector asked = tasks_.value - tasks_.J * given;
  if (controller_.tasks == Controller::Tasks::kOperationalSpace)
    asked -= controller_.task_stiffness * tasks_.placeErrors(time_) +
             controller_.task_damping * tasks_.rateErrors(time_);
  std::vector<int> closed = chosen_;
  recursive::massMatrix(model_, x_, ws_, M_);
  if (all) {
    solver_.factorize(M_(free_, free_), constraints_.J(Eigen::all, free_));
    closed.resize(static_cast<std::size_t>(rows()));
    std::iota(closed.begin(), closed.end(), 0);
  }
  const recursive::MatrixX<double> J_y = tasks_.J(yielding_, Eigen::all);
  const Vector stiffness = tasks_.compliance(yielding_).cwiseInverse();
  const recursive::MatrixX<double> M = M_ + J_y.transpose() * stiffness.asDiagonal() * J_y;
  const Vector pulled = f + J_y.transpose() * (stiffness.asDiagonal() * asked(yielding_));
  const auto m = static_cast<Eigen::Index>(closed.size()),
             k = static_cast<Eigen::Index>(chosen_rigid_.size());
  recursive::MatrixX<double> J(m + k, dof());
  J << constraints_.J(closed, Eigen::all), tasks_.J(chosen_rigid_, Eigen::all);
  Vector right(m + k);
  right << b(closed), asked(chosen_rigid_);
  if (all)
    solver_held_.factorize(M(free_, free_), J(Eigen::all, free_));
  else
    solver_held_.factorize(M(free_, free_), J(Eigen::all, free_), 0);
  const auto result = solver_held_.solve(pulled(free_), right);
  Solution out;
  out.qdd = ofAll(result.qdd);
  out.contradiction = result.contradiction;
  out.lambda = Vector::Zero(rows());
  out.lambda(closed) = result.lambda.head(m);
  out.determined.assign(rows(), closed.size() == static_cast<std::size_t>(rows()));
  if (all) out.determined.assign(result.determined.begin(), result.determined.begin() + m);
  out.nu = Vector::Zero(tasks_.count());
  out.nu(chosen_rigid_) = result.lambda.tail(k);
  const Vector left = asked - tasks_.J * out.qdd;
  out.nu(yielding_) = stiffness.cwiseProduct(left(yielding_));
  out.motors = Eigen::Map<const Vector>(motors_.data(), dof());
  if (controller_.tasks == Controller::Tasks::kOperationalSpace)
    out.motors += tasks_.J.transpose() * out.nu;
  requireHeld(out, f, asked);
  out.drive = Vector::Zero(dof());
  if (drives_.empty()) return out;
  const Vector taken =
      M_ * out.qdd - f - constraints_.J.transpose() * out.lambda - tasks_.J.transpose() * out.nu;
  for (const Drive& drive : drives_) out.drive(drive.rate) = taken(drive.rate);
  out.qdd += given;
  return out;
}

/** Rows that others imply are left to these. They hold where half of the digits agree of all that
    is summed up:  J (M^-1 f + M^-1 J' (lambda, nu)),  whose parts may be much larger than their
    sum.
    @throws std::runtime_error  one does not */
void ClosedMotion::requireHeld(const Solution& solution, const Vector& f,
                               const Vector& asked) const {
  const Vector left = asked - tasks_.J * solution.qdd;
  const double half = std::sqrt(std::numeric_limits<double>::epsilon());
  const auto exceeds = [&](int row, double summed) {
    return std::abs(left(row)) > half * (std::abs(asked(row)) + summed);
  };
  for (const int row : rigid_) {
    if (!exceeds(row, 0)) continue;
    const Eigen::LLT<recursive::MatrixX<double>> M(M_(free_, free_));
    const Vector held =
        constraints_.J.transpose() * solution.lambda + tasks_.J.transpose() * solution.nu;
    const Vector parts =
        M.solve(Vector(f(free_))).cwiseAbs() + M.solve(Vector(held(free_))).cwiseAbs();
    if (!exceeds(row, tasks_.J(row, free_).cwiseAbs().dot(parts))) continue;
    throw std::runtime_error(fmt::format(
        "acceleration constraint '{}' contradicts closures or others at t = {} s: {:.3g} is left, "
        "allowed: values that can hold together",
        tasks_.name(row), time_, left(row)));
  }
}

ClosedMotion::Residuals ClosedMotion::residuals(const State& y, const Vector& qdd,
                                                const Vector& lambda, const Vector& mu,
                                                double time) {
  ++evaluations;
  equations(y, time);
  Residuals out;
  Vector all = Eigen::Map<const Vector>(given_.data(), dof());
  all(free_) = qdd;
  pull();
  recursive::inverseDynamics(model_, x_, qd_, std::vector<double>(all.data(), all.data() + dof()),
                             ws_, bias_);
  const recursive::MatrixX<double> J = constraints_.J(chosen_, Eigen::all);
  out.force = Eigen::Map<const Vector>(bias_.data(), dof()) -
              Eigen::Map<const Vector>(tau_.data(), dof()) - J.transpose() * lambda;
  out.phi = constraints_.phi(chosen_);
  out.rate = phiRate()(chosen_);
  out.second = J * all + constraints_.gamma(chosen_) + 2 * baumgarte_ * out.rate +
               baumgarte_ * baumgarte_ * out.phi;
  Vector rates = Eigen::Map<const Vector>(qd_.data(), dof());
  if (mu.size() > 0) rates -= J.transpose() * mu;
  recursive::positionRates(model_, x_, std::vector<double>(rates.data(), rates.data() + dof()),
                           q_rate_);
  out.position_rates = Eigen::Map<const Vector>(q_rate_.data(), positions());
  out.power =
      loadPower() - spring_.dissipation - recursive::frictionPower(model_, qd_) + control_power_;
  for (const Drive& drive : drives_) out.power += out.force(drive.rate) * qd_[drive.rate];
  return out;
}

void ClosedMotion::project(State* y, double time) {
  if (rows() == 0) return;
  equations(*y, time);
  constexpr int kMostSteps = 25;
  for (int k = 0; k < kMostSteps; ++k) {
    const double before = phi();
    if (before == 0) break;
    factorizeChosen();
    const Vector dq = ofAll(solver_.shortest(-constraints_.phi(chosen_)));
    State moved = *y;
    recursive::positionRates(model_, x_, std::vector<double>(dq.data(), dq.data() + dof()),
                             q_rate_);
    for (int i = 0; i < positions(); ++i) moved[i] += q_rate_[i];
    equations(moved, time);
    if (!(phi() < before)) break;
    *y = moved;
    if (phi() > before / 2) break;
  }
  equations(*y, time);
  factorizeChosen();
  const Vector dqd = ofAll(solver_.shortest(-phiRate()(chosen_)));
  for (int i = 0; i < dof(); ++i) (*y)[positions() + i] += dqd(i);
}

double ClosedMotion::balance(const State& y, double time) {
  equations(y, time);
  std::fill(tau_.begin(), tau_.end(), 0.0);
  const double springs =
      recursive::addSpringForces(model_, springs_, constraints_.X_W, ws_, tau_).energy;
  kinetic_ = recursive::kineticEnergy(model_, x_, qd_, ws_);
  return kinetic_ + recursive::potentialEnergy(model_, x_, ws_) + springs - y.back();
}

std::array<double, 3> ClosedMotion::place(const State& y, double time,
                                          const scene::Attachment& point) {
  equations(y, time);
  const auto& in_model = model_.places[point.link];
  const recursive::Transform<double> X =
      in_model.link < 0 ? in_model.X : in_model.X * constraints_.X_W[in_model.link];
  const recursive::Vector3<double> p =
      X.p + X.R.transpose() * recursive::detail::vector<double>(point.xyz, number_);
  return {p.x(), p.y(), p.z()};
}

/// With the chosen rows alone, whatever their rank is here.
void ClosedMotion::factorizeChosen() {
  recursive::massMatrix(model_, x_, ws_, M_);
  solver_.factorize(M_(free_, free_), constraints_.J(chosen_, free_), 0);
}

ClosedMotion::Vector ClosedMotion::ofAll(const Vector& of_free) const {
  Vector all = Vector::Zero(dof());
  all(free_) = of_free;
  return all;
}

/// At the velocities of the last equations().
double ClosedMotion::loadPower() {
  for (auto& f : ws_.f) f = recursive::Force<double>::zero();
  recursive::subtractLoads(model_, ws_, ws_.f);
  double power = 0;
  for (int i = 0; i < dof(); ++i) power += push_[i] * qd_[i];
  for (std::size_t i = 0; i < model_.links.size(); ++i) power -= dot(ws_.v[i], ws_.f[i]);
  return power;
}

}  // namespace dynwitness::crosscheck
