// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of closed mechanisms: how far it leaves the constraints and the energy, and what it costs.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** How the constraints are kept, phi'' = 0 having been made part of the equations (index 1):
      kNone        nothing more: phi drifts away with t^2
      kBaumgarte   phi'' + 2 w phi' + w^2 phi = 0 in its place
      kProjection  after each step q and qd are moved back to phi = 0, J qd = 0, by the shortest way
                   in M's norm */
enum class Stabilisation { kNone, kBaumgarte, kProjection };

/** Which form of the constraints is solved for, together with M qdd = .. + J' lambda:
      kIndex1   phi'' = 0:  multipliers and accelerations follow at once; phi and phi' drift
      kIndex2   phi' = 0;   phi drifts linearly
      kIndex3   phi = 0;    phi' = 0 holds as well as the integrator's rates do
      kGgl      phi = 0 and phi' = 0, with q' = qd - J' mu: index 2 (Gear, Leimkuhler and Gupta);
                mu is as small as the error
    All but the first need an implicit method. */
enum class Formulation { kIndex1, kIndex2, kIndex3, kGgl };
/// Whether it solves for phi = 0, which equations of rates alone do not have.
constexpr bool needsPositions(Formulation formulation) {
  return formulation == Formulation::kIndex3 || formulation == Formulation::kGgl;
}

/** Joint forces of a controller, besides what else moves a scene.

        posture     tau = stiffness (q(0) - q) - damping qd,  of every free joint with one axis
        tasks, x the place and xd the rate along an acceleration constraint's direction, whose
        value's integral is  xd* = xd(0) + value t,  x* = x(0) + xd(0) t + value t^2 / 2,
          kConstraint         J qdd + (dJ/dt) qd + compliance nu = value  ideal forces J' nu hold it
          kOperationalSpace   J qdd + (dJ/dt) qd = value + damping (xd* - xd) + stiffness (x* - x)
                              motors supply J' nu and what the posture adds in the null space of the
                              tasks: together J' Lambda (..) + (1 - J' Jbar') tau_posture (Khatib)
          kImpedance          nu = damping (xd* - xd) + stiffness (x* - x),  motors supply J' nu
    Gains are of the accelerations [1/s^2], [1/s] in operational space, of forces otherwise. */
struct Controller {
  enum class Tasks { kConstraint, kOperationalSpace, kImpedance };
  Tasks tasks = Tasks::kConstraint;
  double task_stiffness = 0, task_damping = 0;
  double posture_stiffness = 0, posture_damping = 0;

  bool hasPosture() const { return posture_stiffness != 0 || posture_damping != 0; }
};
/// "constraint", "operational_space", "impedance"
const char* name(Controller::Tasks tasks);
/** What a run waits for: a function of the state that passes zero. It is looked for between the
    ends of steps, so that two passages within one step are not seen, and then found by bisection to
    the rounding of its time, each trial integrated as a step is. */
struct AwaitedEvent {
  std::function<double(double time, const double* q, const double* qd)> of;
  int direction = 0;  ///< +1: where it rises, -1: where it falls, 0: both
  int times = 1;      ///< so many, then the run ends
};

struct SimulateOptions {
  double duration = 10;            ///< [s]
  int outputs = 100;               ///< equal intervals at whose ends the state is kept
  std::vector<double> more_times;  ///< and at these, as far as they lie within the duration [s]
  std::string method = "runge_kutta_fehlberg78";
  double step_error =
      1e-10;  ///< asked of each step: |error| <= step_error (1 + |y|), y in [rad, m, 1/s ..]
  Stabilisation stabilisation = Stabilisation::kProjection;
  double baumgarte_rate = 20;  ///< w [1/s]
  Formulation formulation = Formulation::kIndex1;
  double step = 0.001;  ///< of methods whose steps are equal [s]
  Controller controller = {};
  std::function<void(double time)> progress = {};  ///< called after each step
  /// Adds joint forces to these at a time [N m, N]; their work is in the balance. None: no forces.
  std::function<void(double time, std::vector<double>* tau)> forces = {};
  AwaitedEvent until = {};  ///< without a function: none; of methods that choose their steps
};

/// Methods are integrators() by name. Whether this one has the step that is asked for;
/// runge_kutta_fehlberg78 and runge_kutta_dopri5 choose theirs by an error.
/// @throws scene::InputError  there is none of that name
bool hasEqualSteps(const std::string& method);
/// Whether it solves index 2 and 3, too: Radau IIA (implicit.hpp).
bool knowsFormulations(const std::string& method);

struct Simulation {
  struct Point {
    double time;
    std::vector<double> q, qd, qdd;
    /// Of motors: what the options give over time, and the controller's [N m, N]; none: no motors.
    std::vector<double> tau;
    double phi, phi_rate;  ///< largest |phi|, |J qd| at this time
    double energy_error;   ///< |E - E0 - work| [J]
    double work;  ///< of loads, dampers, drives, acceleration constraints and the controller [J]
    double kinetic, potential;     ///< [J], springs included
    std::vector<double> lambda;    ///< of all equations; of implicit methods what they solved for
    std::vector<bool> determined;  ///< by multiplier: mechanics of rigid bodies says what it is
    std::vector<double> nu;        ///< of acceleration constraints or tasks
    /// By task: how far place and rate are from the integrals of its value (LinkTasks).
    std::vector<double> place_errors, rate_errors;
  };
  /// An acceleration constraint or task along the motion.
  struct Task {
    std::string name;
    bool has_place, has_rate;
    bool yields;                             ///< it has a compliance, which plays a part
    double worst_place = 0, worst_rate = 0;  ///< over all steps [m], [m/s, 1/s]
  };
  std::vector<Point> points;  ///< the first at t = 0
  std::vector<Task> tasks;
  std::vector<double> events;  ///< times of what was awaited [s]
  int constraints = 0, rank_lowest = 0, rank_highest = 0;
  double start_residual = 0;  ///< largest |phi| and |J qd| of the scene's start, before projection
  double worst_phi = 0, worst_phi_rate = 0, worst_energy = 0;  ///< over all steps
  double most_kinetic = 0;                                     ///< [J]
  long steps = 0, rejected = 0, evaluations = 0;
  double cpu_s = 0;
};

/** Simulates the scene with its closures, springs, loads, driven joints and acceleration
    constraints, from its start state, without other joint forces than the controller's and those of
    the options. The start is first moved onto phi = 0 and J qd = 0. Acceleration constraints act
    along the whole motion; nothing corrects how their integrals drift but a controller's gains.
    @throws scene::InputError  an unknown method, options out of range, or a start that no small
            correction brings onto the constraints; an implicit method with rows for acceleration
            constraints; tasks asked of a scene that has none
    @throws std::runtime_error the integrator cannot go on (its step fell below 1e-12 s) */
Simulation simulate(const scene::Scene& scene, const SimulateOptions& options);

/// Largest differences of two simulations of a scene at the outputs that both have.
struct MotionGap {
  double q = 0, qd = 0;  ///< [rad, m, 1], [rad/s, m/s]; NaN where one is
  int shared = 0;        ///< such outputs after the start: 0: nothing was compared
};
MotionGap gapBetween(const Simulation& a, const Simulation& b);
/// Largest difference of the times of events [s]; infinite where one has more of them.
double eventGap(const Simulation& a, const Simulation& b);

/// The options of another run: by the other method that chooses its steps, for half the error of a
/// step (a method that is wrong and says that it succeeded may be so again at half the error), or
/// with steps of half the length; and with twice as many outputs, so that all its steps are
/// shorter.
SimulateOptions finer(const SimulateOptions& options);

/// Accelerations and multipliers at a state of the closed mechanism, without other joint forces.
struct ConstrainedState {
  std::vector<double> qdd, lambda;
  std::vector<double> drive;  ///< forces of driven joints, zero elsewhere
  std::vector<bool> determined;
  int rank = 0;
};
ConstrainedState constrainedAccelerations(const scene::Scene& scene, const std::vector<double>& q,
                                          const std::vector<double>& qd, double time = 0);

/// A point of a link in world axes [m], for each state of a simulation.
std::vector<std::array<double, 3>> pathOf(const scene::Scene& scene, const Simulation& simulation,
                                          const scene::Attachment& point);

}  // namespace dynwitness::crosscheck
