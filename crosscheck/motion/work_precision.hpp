// SPDX-License-Identifier: GPL-3.0-or-later
// What the accuracy of a whole simulation costs, method by method.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// The end of a motion by two methods that share no formula but the sweeps; of trees in long
/// double.
struct ReferenceMotion {
  std::vector<long double> y;  ///< (q, qd), quaternions of length 1
  std::string by;    ///< "runge_kutta_fehlberg78 and gauss_6 of Hamilton's equations, ..."
  double error = 0;  ///< largest difference of the two [rad, m, rad/s, m/s]
  /// Against the elliptic functions, where the scene is a pendulum that swings.
  std::optional<double> elliptic_error;
  std::string published;    ///< of a closed mechanism: how far published positions are; "": none
  double most_kinetic = 0;  ///< along the motion [J]

  int digits() const;  ///< decimal places to which the two agree
};
/// @throws std::runtime_error  one does not arrive, or they do not agree to six places, and to
///         which digit they do: the motion is too long, or too wild
ReferenceMotion referenceMotion(const scene::Scene& scene, double duration);

/// (q, qd) at a time of a pendulum that swings: one revolute joint, M constant, g = k sin(q - q_0).
/// Nothing: the scene is none.
std::optional<std::vector<long double>> ellipticPendulum(const scene::Scene& scene, double time);

struct WorkPoint {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double step = 0;       ///< [s]
  long calls = 0;        ///< of the equations of motion
  double seconds = 0;    ///< of CPU, fastest of some runs
  double error = kNone;  ///< largest |q - q_ref|, |qd - qd_ref| at the end [rad, m, rad/s, m/s]
  /// Largest |E - E_0| after a step, over the largest kinetic energy.
  double energy_error = kNone;
  std::string failure;  ///< why there is no end; "": there is
};

struct WorkLine {
  std::string method;
  int order = 0;                  ///< by theory
  double observed_order = 0;      ///< observedOrder(); 0: there is none ...
  std::string no_order;           ///< ... and why
  std::vector<WorkPoint> points;  ///< steps falling
  std::string left_out;           ///< why it was not run
};

struct WorkPrecision {
  std::string scene, title, machine;
  double duration = 0;
  ReferenceMotion reference;
  std::vector<WorkLine> lines;
};

struct WorkOptions {
  double duration = 5;               ///< [s]
  std::vector<std::string> methods;  ///< empty: all that know the scene
  double longest_run = 0.3;          ///< [s] of CPU: steps are halved until one takes longer
  std::function<void(const std::string& method)> progress = {};
};

struct ObservedOrder {
  double value = 0;     ///< 0: there is no asymptotic range
  std::string why_not;  ///< in words, where there is none
};
/** log(e' / e) / log(h' / h) of the errors e at the end between the two finest steps h above a
    floor, if it is that between the two before.
    @param points  steps falling
    @param floor   (point) -> error that is rounding's, or the reference's: an order is seen above
                   30 times that */
ObservedOrder observedOrder(const std::vector<WorkPoint>& points,
                            const std::function<double(const WorkPoint&)>& floor);

/** Each method with steps of duration / 16, halved until its error is rounding or a run takes
    longer than longest_run. Rounding is measured, as what a method does otherwise in long double.
    @throws scene::InputError   what Command::kDrift refuses
    @throws std::runtime_error  what referenceMotion() throws */
WorkPrecision measureWork(const scene::Scene& scene, const WorkOptions& options);

/// Order of the error of the end, between two steps in long double, halved until it no longer
/// changes by more than a twentieth. 0: no such steps; before them errors are the reference's.
double convergedOrder(const scene::Scene& scene, const std::string& method, double duration);

}  // namespace dynwitness::crosscheck
