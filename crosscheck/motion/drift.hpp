// SPDX-License-Identifier: GPL-3.0-or-later
// Energy along simulated motion.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::crosscheck {

/// Energy along simulated paths of one scene with one integrator.
struct Drift {
  struct Path {
    double step = 0;            ///< [s]
    double worst = 0;           ///< largest |E - E0| / scale along the path
    std::vector<double> time;   ///< [s], thinned for charts
    std::vector<double> error;  ///< |E - E0| / scale at those times
    double end_time = 0;        ///< [s]: whole steps, as near to the duration as they come
    std::vector<double> end;    ///< (q, qd, work) then; empty: it left the numbers
  };
  std::string method;  ///< "runge_kutta4"
  int method_order = 0;
  double duration = 0;        ///< [s]
  double scale = 0;           ///< [J]: the largest kinetic energy seen along the finest path
  double observed_order = 0;  ///< of the worst drift, from the two finest steps above rounding
  std::vector<Path> paths;    ///< step sizes falling
};

struct DriftOptions {
  double duration = 10;       ///< [s]
  std::vector<double> steps;  ///< [s], falling; empty: 0.01 s halved until the order shows
  std::string method = "runge_kutta4";
  /// Whose qdd moves the scene, nullptr: its own. With another's, the energy is found to drift.
  const scene::Mechanism* moved_by = nullptr;
};

/** Simulates the scene from its start state with the articulated-body sweep, no joint forces, and
    follows E = T + V; with viscous friction, what it has taken, the integral of its power, is
    added. A path ends where it leaves the numbers; its `worst` is not finite then.
    @return without paths where M is singular at the start state, so that no motion follows
    @throws scene::InputError for an unknown method, a step that is not positive, and what
            Command::kDrift refuses: scenes whose energy is not constant, or jumps */
Drift measureDrift(const PreparedScene& scene, const DriftOptions& options);

/// Why a Drift has no paths.
inline constexpr const char* kNoMotion = "qdd has no value at the start state: M is singular there";

/// Whether the order of the method shows between the two finest steps, or nothing is lost but
/// rounding.
bool isResolved(const Drift& drift);

/// Each step may add a rounding error of eps to the energy's scale: below steps * eps, differences
/// between step sizes mean nothing.
double roundingFloor(const Drift& drift, const Drift::Path& path);

/// The order between the two finest steps whose drift lies above rounding; 0 when there are no two.
double observedOrder(const Drift& drift);

/// With its finest steps the method loses nothing but rounding, as it does in free fall with any.
/// (A wrong qdd drifts by the same amount at every step size, far above that.)
bool belowRounding(const Drift& drift);

/// Whether the finest path stayed with the numbers.
bool isFinite(const Drift& drift);

/** What two methods, each at its finest steps that arrive, say of the end: "a (h = 0.01 s) and b
    (h = 0.01 s) agree to 3 digits: at t = 0.5 s they are 2e-4 apart [..]". "": one of them does not
    arrive, or not at the same time. Energy alone does not say where a motion is. */
std::string comparedEnds(const scene::Scene& scene, const Drift& a, const Drift& b);

/// When an error of half of the largest kinetic energy was reached [s]: where energy was gained,
/// that is all that the motion itself had. Negative: it is not seen on the path.
double lossTime(const Drift::Path& path);
/// Whether a path lost or gained that much, or left the numbers.
bool isLost(const Drift::Path& path);

/// Takes out the paths that left the numbers: they have nothing to show.
void eraseLostPaths(Drift& drift);

/// A motion in steps that adapt to it.
struct AdaptiveRun {
  struct Point {
    double time, worst, rounding,
        kinetic;  ///< [s]; largest |E - E0|, sum of roundings, largest T so far [J]
  };
  double step_error;
  double shortest_step = 0;  ///< [s]
  std::vector<Point> points;

  double end() const { return points.empty() ? 0 : points.back().time; }
  /// The last point up to this time.
  const Point& at(double time) const;
};

/// By Dormand and Prince's pair of orders 5 and 4, each step's error kept below step_error (1 +
/// |y|). Ends early where the steps become too many or nothing finite follows.
AdaptiveRun runAdaptively(const PreparedScene& scene, const DriftOptions& options,
                          double step_error);

}  // namespace dynwitness::crosscheck
