// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/link_tasks.hpp"

#include <algorithm>

#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/operational_space.hpp"

namespace dynwitness::crosscheck {

LinkTasks::LinkTasks(const scene::Mechanism& mechanism, const recursive::Model<double>& model)
    : mechanism_(mechanism), model_(model), number_(mechanism) {
  using Axes = scene::AccelerationConstraint::Axes;
  const auto isZero = [](const scene::Vector& v) {
    return std::all_of(v.begin(), v.end(),
                       [](const scene::Number& x) { return x.isLiteralZero(); });
  };
  for (const scene::AccelerationConstraint& held : mechanism.acceleration_constraints) {
    const bool in_world = held.axes == Axes::kWorld;
    // components of wd in the link's axes are the rates of those of w; of xdd they are not
    tasks_.push_back({held.name, held.link, recursive::detail::vector<double>(held.at, number_),
                      recursive::detail::vector<double>(held.direction, number_),
                      in_world || isZero(held.direction), in_world && isZero(held.rotation),
                      number_(held.value)});
  }
  const Vector none = Vector::Zero(count());
  J = recursive::MatrixX<double>::Zero(count(), model.dof());
  value = compliance = place = rate = start_place_ = start_rate_ = none;
}

void LinkTasks::at(const std::vector<scene::JointPosition<double>>& x,
                   const std::vector<double>& qd, const recursive::Constraints<double>& closures,
                   recursive::Workspace<double>& ws) {
  // ws.a: accelerations at qdd = 0, without gravity
  const auto held = recursive::accelerationConstraints(mechanism_, number_, model_, x, qd, ws);
  recursive::taskJacobian(model_, held, ws, J);
  rate = J * Eigen::Map<const Vector>(qd.data(), static_cast<Eigen::Index>(qd.size()));
  for (int k = 0; k < count(); ++k) {
    const Task& task = tasks_[static_cast<std::size_t>(k)];
    const auto& constraint = held[static_cast<std::size_t>(k)];
    value(k) = constraint.b(0) - constraint.A.col(0).dot(ws.a[constraint.link].vector());
    compliance(k) = constraint.compliance(0);
    if (!task.has_place) continue;
    const auto& in_model = model_.places[task.link];
    const recursive::Transform<double> X = in_model.X * closures.X_W[in_model.link];
    place(k) = task.direction.dot(X.p + X.R.transpose() * task.at);
  }
}

void LinkTasks::startHere() {
  start_place_ = place;
  start_rate_ = rate;
}

LinkTasks::Vector LinkTasks::rateErrors(double time) const {
  Vector out = Vector::Zero(count());
  for (int k = 0; k < count(); ++k)
    if (hasRate(k))
      out(k) = rate(k) - start_rate_(k) - tasks_[static_cast<std::size_t>(k)].value * time;
  return out;
}

LinkTasks::Vector LinkTasks::placeErrors(double time) const {
  Vector out = Vector::Zero(count());
  for (int k = 0; k < count(); ++k)
    if (hasPlace(k))
      out(k) = place(k) - start_place_(k) - start_rate_(k) * time -
               tasks_[static_cast<std::size_t>(k)].value * time * time / 2;
  return out;
}

}  // namespace dynwitness::crosscheck
