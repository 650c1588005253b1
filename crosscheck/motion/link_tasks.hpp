// SPDX-License-Identifier: GPL-3.0-or-later
// Acceleration constraints along a motion: as constraints, or as the tasks of a controller.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "recursive/constraints.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// The acceleration constraints of a scene at a state, in the order of the scene.
class LinkTasks {
 public:
  using Vector = Eigen::VectorXd;

  /// Scene and model must outlive it.
  LinkTasks(const scene::Mechanism& mechanism, const recursive::Model<double>& model);

  int count() const { return static_cast<int>(tasks_.size()); }
  const std::string& name(int k) const { return tasks_[static_cast<std::size_t>(k)].name; }
  /// Whether its value is the rate of change of J qd: of directions that turn with a link it is
  /// not.
  bool hasRate(int k) const { return tasks_[static_cast<std::size_t>(k)].has_rate; }
  /// Whether J qd is the rate of change of a place, of a point along a world's direction.
  bool hasPlace(int k) const { return tasks_[static_cast<std::size_t>(k)].has_place; }

  /// @param closures  constraintEquations() has run on it and on ws for this state
  void at(const std::vector<scene::JointPosition<double>>& x, const std::vector<double>& qd,
          const recursive::Constraints<double>& closures, recursive::Workspace<double>& ws);
  /// Integrals are from this state, at t = 0.
  void startHere();

  /// x - x* and xd - xd* at this time; 0 of what has none.
  Vector placeErrors(double time) const;
  Vector rateErrors(double time) const;

  recursive::MatrixX<double> J;  ///< m x n
  Vector value;                  ///< of J qdd: what is asked less (dJ/dt) qd [m/s^2, 1/s^2]
  Vector compliance;             ///< [1/kg, ..]
  Vector place, rate;            ///< x [m], xd = J qd [m/s, 1/s]

 private:
  struct Task {
    std::string name;
    int link;  ///< of the scene
    recursive::Vector3<double> at, direction;
    bool has_rate, has_place;
    double value;
  };
  const scene::Mechanism& mechanism_;
  const recursive::Model<double>& model_;
  scene::RealNumbers<double> number_;
  std::vector<Task> tasks_;
  Vector start_place_, start_rate_;
};

}  // namespace dynwitness::crosscheck
