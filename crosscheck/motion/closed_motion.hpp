// SPDX-License-Identifier: GPL-3.0-or-later
// The equations of a closed and driven mechanism at a state, for whoever integrates them.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "crosscheck/motion/link_tasks.hpp"
#include "crosscheck/motion/simulate.hpp"
#include "recursive/constrained_solver.hpp"
#include "recursive/point_springs.hpp"

namespace dynwitness::crosscheck {

/** A mechanism with closures, springs between points, loads, and driven joints.

    Driven joints are no unknowns: whatever a state says about them, their positions, rates and
    accelerations are those of their motions at that time. With indices f of the free and p of the
    driven degrees of freedom

        M_ff qdd_f = (Q - bias)_f + J_f' lambda,   J_f qdd_f = -gamma - J_p qdd_p
        tau_p = (M qdd + bias - Q)_p - J_p' lambda                              what the drives take

    (the bias being that at qdd_f = 0).

    so that the inertia that a drive moves need not be known. J qd, with all of qd, is dphi/dt.

    Acceleration constraints are further rows of J, those that give way (compliance C) part of the
    inertia: M + J' C^-1 J. Where the controller reads them as tasks, their forces are motors'. */
class ClosedMotion {
 public:
  using State = std::vector<double>;  ///< (q, qd, work of loads, dampers and drives)
  using Vector = Eigen::VectorXd;

  /// @param baumgarte_rate  w of  phi'' + 2 w phi' + w^2 phi = 0; zero: phi'' = 0
  /// @param pushes  SimulateOptions::forces, part of Q
  ClosedMotion(const scene::Scene& scene, double baumgarte_rate, Controller controller = {},
               std::function<void(double, std::vector<double>*)> pushes = {});
  ClosedMotion(const ClosedMotion&) = delete;
  ClosedMotion& operator=(const ClosedMotion&) = delete;

  int dof() const { return model_.dof(); }
  int positions() const { return model_.positions; }
  int rows() const { return constraints_.rows(); }
  bool isPushed() const { return static_cast<bool>(pushes_); }  ///< by forces over time
  /// Whether there are joint forces of motors: pushes, or a controller's.
  bool hasMotors() const {
    return isPushed() || controller_.hasPosture() ||
           (controller_.tasks != Controller::Tasks::kConstraint && tasks_.count() > 0);
  }
  int freedoms() const { return static_cast<int>(free_.size()); }
  const std::vector<int>& freeRates() const { return free_; }
  const std::vector<int>& freePositions() const { return free_slots_; }

  /// The scene's start, driven joints where they are at t = 0.
  State start(const scene::Scene& scene) const;
  /// Puts the driven joints where they are at this time.
  void impose(double time, State* y) const;

  /// dy/dt, by index 1. Counts as one evaluation.
  void operator()(const State& y, State& rate, double time);

  /** Which equations stand for all, decided at this state and kept until the next call. Redundant
      equations depend on each other only where phi = 0, and the trial states inside a step of an
      integrator do not lie there: deciding again at each of them would make the accelerations jump.
      */
  void choose(const State& y, double time);
  const std::vector<int>& chosen() const { return chosen_; }

  struct Solution {
    Vector qdd;                    ///< of all degrees of freedom
    Vector lambda;                 ///< of all equations
    std::vector<bool> determined;  ///< by multiplier
    double contradiction = 0;      ///< largest |J qdd + gamma|
    Vector drive;                  ///< forces of the drives, zero where there is none [N m], [N]
    Vector nu;                     ///< of acceleration constraints or tasks
    Vector motors;                 ///< pushes and the controller's joint forces [N m], [N]
  };
  /// With the chosen equations; the multipliers of the others are zero.
  Solution accelerations(const State& y, double time);
  /// With all, redundant ones too: for the multipliers.
  Solution accelerationsOfAll(const State& y, double time);

  /// phi, J, gamma and the tasks at this state.
  void equations(const State& y, double time);
  const recursive::MatrixX<double>& jacobian() const { return constraints_.J; }
  const LinkTasks& tasks() const { return tasks_; }
  /// The controller's references are integrals from this state on, at t = 0.
  void startHere(const State& y);
  /// Whether it holds links by rows of their own, which residuals() has not.
  bool hasHeldRows() const { return !rigid_.empty() || !yielding_.empty(); }
  /// Whether more than the mechanism's own parts moves it.
  bool isHeld() const { return tasks_.count() > 0 || controller_.hasPosture(); }
  double phi() const { return largest(constraints_.phi); }
  double phiRateSize() const { return largest(phiRate()); }
  /// Whether projections have arrived at closed positions and rates. Newton's method squares what
  /// is left with each step: from below the root of eps [m, rad, 1/s] the next ends at rounding.
  bool isClosed() const;
  int rank() const { return static_cast<int>(solver_.rank()); }

  /** What Newton and Euler leave of  M qdd + bias - Q - J' lambda  at any qdd and lambda, and the
      residuals of the chosen equations for position, rate and acceleration there. Counts as one
      evaluation. */
  struct Residuals {
    Vector force;              ///< of all degrees of freedom: on driven ones what the drive takes
    Vector phi, rate, second;  ///< chosen equations
    Vector position_rates;     ///< of qd - J' mu, of all slots
    double power = 0;          ///< of loads, dampers and drives [W]
  };
  Residuals residuals(const State& y, const Vector& qdd, const Vector& lambda, const Vector& mu,
                      double time);

  /** Newton's method for phi(q) = 0, each step the shortest in M's norm, then the same for J qd =
      0. It ends when phi no longer halves: then rounding is what is left. */
  void project(State* y, double time);

  /// E - work of loads, dampers and drives [J]; the part that must not change.
  double balance(const State& y, double time);
  double kinetic() const { return kinetic_; }

  /// A point of a link of the scene in world axes.
  std::array<double, 3> place(const State& y, double time, const scene::Attachment& point);

  long evaluations = 0;

 private:
  static double largest(const Vector& v) { return v.size() == 0 ? 0 : v.cwiseAbs().maxCoeff(); }
  Vector phiRate() const { return constraints_.J * Eigen::Map<const Vector>(qd_.data(), dof()); }
  Solution solved(bool all);
  /// Of springs between points and the controller, into tau_; the latter into motors_.
  void pull();
  /// Q - bias, bias at the accelerations given_ of the driven joints.
  Vector forces();
  Solution solvedHeld(bool all, const Vector& f, const Vector& b);
  void requireHeld(const Solution& solution, const Vector& f, const Vector& asked) const;
  void chooseHeld();
  void factorizeChosen();
  Vector ofAll(const Vector& of_free) const;
  double loadPower();  ///< of wrenches and pushes

  scene::RealNumbers<double> number_;
  recursive::Model<double> model_;
  recursive::Workspace<double> ws_;
  recursive::Constraints<double> constraints_;
  std::vector<recursive::PointSpring<double>> springs_;
  double baumgarte_;
  struct Drive {
    int rate, slot;
    scene::Expression motion;
  };
  std::vector<Drive> drives_;
  std::vector<int> free_, free_slots_;  ///< rates and slots that no drive has
  recursive::ConstrainedSolver<double> solver_;
  recursive::SpringState<double> spring_;
  std::vector<scene::JointPosition<double>> x_;
  std::vector<double> qd_, q_rate_, tau_, bias_;
  std::function<void(double, std::vector<double>*)> pushes_;
  std::vector<double> push_;    ///< at the time of the last equations()
  std::vector<double> motors_;  ///< with the controller's, at the last pull()
  std::vector<double> given_;   ///< accelerations of the driven, zero of the free
  recursive::MatrixX<double> M_;
  std::vector<int> chosen_;
  double kinetic_ = 0;

  Controller controller_;
  LinkTasks tasks_;
  std::vector<int> rigid_, yielding_;  ///< acceleration constraints by compliance; none: tasks
  std::vector<int> chosen_rigid_;      ///< that depend neither on closures nor on each other
  recursive::ConstrainedSolver<double> solver_held_;
  std::vector<std::array<int, 2>> posture_;  ///< rates and slots of free joints with one axis
  Vector posture_start_, task_force_;        ///< by posture_; of an impedance
  double time_ = 0, control_power_ = 0;
};

}  // namespace dynwitness::crosscheck
