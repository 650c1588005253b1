// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/tree_motion.hpp"
#include "crosscheck/scalars/rounded_state.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
using Vector = std::vector<double>;  // (q, qd, what friction has taken [J])

constexpr int kChartPoints = 400;    // a path is thinned to about this many for the chart
constexpr double kFirstStep = 0.01;  // [s]
constexpr int kMostHalvings = 9;
constexpr double kMostSteps = 1e8;
constexpr double kLost = 0.5;  // of the largest kinetic energy

struct Trace {
  Drift::Path path;
  double most_kinetic = 0;
};

Trace simulate(TreeMotion<double>& motion, const std::string& method, Vector y, double step,
               double duration) {
  const auto stepper = stepsOf<double>(method, motion);
  const long steps = std::lround(duration / step);
  scene::Work work("simulated motions", static_cast<double>(steps), static_cast<double>(steps));
  const long stride = std::max(1L, steps / kChartPoints);
  const double E_0 = motion.energy(y);
  Trace trace;
  trace.path.step = step;
  double most_since_point = 0;
  for (long k = 1; k <= steps; ++k, work.done()) {
    try {
      stepper->step(&y, (k - 1) * step, step);
    } catch (const std::runtime_error&) {  // an implicit step without a solution
      trace.path.worst = std::numeric_limits<double>::quiet_NaN();
      break;
    }
    const double error = std::abs(motion.energy(y) - E_0);
    const double kinetic = motion.kinetic(y);
    trace.most_kinetic = kinetic <= trace.most_kinetic ? trace.most_kinetic : kinetic;
    // NaN counts as the worst: a path that left the numbers has lost its energy
    trace.path.worst = error <= trace.path.worst ? trace.path.worst : error;
    if (!std::isfinite(error)) break;
    most_since_point = error <= most_since_point ? most_since_point : error;
    if (k % stride == 0 ||
        k == steps) {  // the chart keeps the largest of each stretch, not a sample
      trace.path.time.push_back(k * step);
      trace.path.error.push_back(most_since_point);
      most_since_point = 0;
    }
  }
  trace.path.end_time = static_cast<double>(steps) * step;
  if (std::isfinite(trace.path.worst)) trace.path.end = y;
  return trace;
}

/// Order seen between two step sizes.
double orderBetween(const Drift::Path& coarse, const Drift::Path& fine) {
  return std::log(coarse.worst / fine.worst) / std::log(coarse.step / fine.step);
}

bool orderShows(const Drift& drift) {
  return drift.paths.size() >= 2 && drift.observed_order > drift.method_order - 1;
}

/// How much rounding the state to double may move E = T + V [J].
class EnergyRounding {
 public:
  explicit EnergyRounding(const PreparedScene& scene)
      : model_(scene.model<RunningError>()), ws_(model_) {}
  double operator()(const Vector& y) {
    std::vector<scene::JointPosition<RunningError>> x;
    for (int i = 0; i < model_.positions; ++i) x.push_back(roundedPosition(y[i]));
    const std::vector<RunningError> qd =
        rounded(Vector(y.begin() + model_.positions, y.begin() + model_.positions + model_.dof()));
    const RunningError T = recursive::kineticEnergy(model_, x, qd, ws_);
    return T.bound() + recursive::potentialEnergy(model_, x, ws_).bound() +
           RunningError::kUnitRoundoff * std::abs(y.back());
  }

 private:
  recursive::Model<RunningError> model_;
  recursive::Workspace<RunningError> ws_;
};

}  // namespace

Drift measureDrift(const PreparedScene& scene, const DriftOptions& options) {
  const Integrator& method = integratorNamed(options.method);
  requireTreated(scene.scene(), Command::kDrift);
  if (!(options.duration > 0) || !std::isfinite(options.duration))
    throw scene::InputError({},
                            fmt::format("duration is {} s, allowed: positive", options.duration));
  if (options.steps.empty() && options.duration / kFirstStep > kMostSteps / (1 << kMostHalvings))
    throw scene::InputError(
        {}, fmt::format("duration is {} s, allowed: up to {} s where no steps are given",
                        options.duration, kFirstStep * kMostSteps / (1 << kMostHalvings)));
  for (const double step : options.steps)
    if (!(step > 0) || step > options.duration || options.duration / step > kMostSteps)
      throw scene::InputError(
          {}, fmt::format("step is {} s, allowed: positive, at most the duration of {} s, and at "
                          "least a hundred millionth of it",
                          step, options.duration));

  TreeMotion<double> motion(scene.mechanism(), options.moved_by);
  const Vector start = startOf<double>(scene.scene());

  Drift drift;
  drift.method = method.name;
  drift.method_order = method.order;
  drift.duration = options.duration;
  Vector rate(start.size());
  motion.rate(start, 0, &rate);
  if (!std::all_of(rate.begin(), rate.end(), [](double x) { return std::isfinite(x); }))
    return drift;
  const auto run = [&](double step) {
    const Trace trace = simulate(motion, method.name, start, step, options.duration);
    drift.paths.push_back(trace.path);
    // of the finest path in the end, if it stayed with the numbers
    if (std::isfinite(trace.path.worst) || drift.paths.size() == 1)
      drift.scale = trace.most_kinetic;
  };
  // errors are kept in joules until the scale is known
  const auto relative = [&] {
    Drift out = drift;
    for (Drift::Path& path : out.paths) {
      if (out.scale == 0) continue;  // nothing moved, nothing was lost
      path.worst /= out.scale;
      for (double& error : path.error) error /= out.scale;
    }
    out.observed_order = observedOrder(out);
    return out;
  };
  scene::Work work("", 1);
  if (!options.steps.empty()) {
    std::vector<double> steps = options.steps;
    double all = 0;
    for (const double step : steps) all += std::round(options.duration / step);
    work.expect(all);
    std::sort(steps.rbegin(), steps.rend());
    for (const double step : steps) run(step);
    return relative();
  }
  // three steps at least for the chart, then on until the method's order shows
  double step = kFirstStep;
  for (int k = 0; k <= kMostHalvings; ++k, step /= 2) {
    const double finest =
        std::min(step, kFirstStep / 8);  // four runs at least, each twice as long as the last
    work.expect(2 * options.duration / finest);
    run(step);
    const Drift so_far = relative();
    // a step too coarse for this motion; of a wrong qdd the finest is too
    if (!isFinite(so_far) && k < kMostHalvings) {
      drift.paths.clear();
      continue;
    }
    if (so_far.paths.size() < 4) continue;
    if (orderShows(so_far) || belowRounding(so_far) || !isFinite(so_far) || so_far.scale == 0)
      break;
  }
  return relative();
}

double observedOrder(const Drift& drift) {
  for (std::size_t k = drift.paths.size(); k-- > 1;)
    if (drift.paths[k].worst > roundingFloor(drift, drift.paths[k]))
      return std::isfinite(drift.paths[k - 1].worst)
                 ? orderBetween(drift.paths[k - 1], drift.paths[k])
                 : 0;
  return 0;
}

double roundingFloor(const Drift& drift, const Drift::Path& path) {
  return std::numeric_limits<double>::epsilon() * drift.duration / path.step;
}

bool belowRounding(const Drift& drift) {
  return drift.paths.back().worst <= roundingFloor(drift, drift.paths.back());
}

bool isFinite(const Drift& drift) {
  return std::isfinite(drift.scale) && std::isfinite(drift.paths.back().worst);
}

const AdaptiveRun::Point& AdaptiveRun::at(double time) const {
  const auto after = std::upper_bound(points.begin(), points.end(), time,
                                      [](double t, const Point& p) { return t < p.time; });
  return *std::prev(after);
}

AdaptiveRun runAdaptively(const PreparedScene& scene, const DriftOptions& options,
                          double step_error) {
  constexpr int kMostAdaptiveSteps = 200000;
  TreeMotion<double> motion(scene.mechanism(), options.moved_by);
  const auto rate = [&](const Vector& y, Vector& out, double time) { motion.rate(y, time, &out); };
  EnergyRounding rounding(scene);
  auto stepper =
      odeint::make_controlled(step_error, step_error, odeint::runge_kutta_dopri5<Vector>());
  Vector y = startOf<double>(scene.scene());
  const double E_0 = motion.energy(y);
  AdaptiveRun run{step_error, 0, {}};
  AdaptiveRun::Point point{0, 0, rounding(y), 0};
  double time = 0, step = kFirstStep;
  for (int k = 0; k < kMostAdaptiveSteps && time < options.duration; ++k) {
    const double before = time, tried = std::min(step, options.duration - time);
    if (before + tried == before) break;
    step = tried;
    Vector next = y;
    if (stepper.try_step(rate, next, time, step) != odeint::success) continue;
    const double error = std::abs(motion.energy(next) - E_0), kinetic = motion.kinetic(next);
    if (!std::isfinite(error) || !std::isfinite(kinetic)) {  // no error, for the stepper
      stepper.reset();
      time = before;
      step = tried / 2;
      continue;
    }
    y = next;
    // the step that ends the path is cut, and says nothing of what the motion asks for
    if (run.points.empty() || (tried < run.shortest_step && time < options.duration))
      run.shortest_step = tried;
    point = {time, std::max(point.worst, error), point.rounding + rounding(y),
             std::max(point.kinetic, kinetic)};
    run.points.push_back(point);
  }
  return run;
}

bool isResolved(const Drift& drift) {
  return !drift.paths.empty() && drift.scale > 0 && isFinite(drift) &&
         (belowRounding(drift) || orderShows(drift));
}

std::string comparedEnds(const scene::Scene& scene, const Drift& a, const Drift& b) {
  const auto arrives = [](const Drift::Path& path) { return !path.end.empty(); };
  const auto one = std::find_if(a.paths.rbegin(), a.paths.rend(), arrives);
  const auto other = std::find_if(b.paths.rbegin(), b.paths.rend(), arrives);
  if (one == a.paths.rend() || other == b.paths.rend()) return "";
  const double time = one->end_time;  // a product, rounded once
  if (std::abs(other->end_time - time) > 2 * std::numeric_limits<double>::epsilon() * time)
    return "";
  const std::vector<long double> first = placed(scene.mechanism, one->end),
                                 second = placed(scene.mechanism, other->end, first);
  const auto gap = static_cast<double>(largestGap(first, second, first.size()));
  long double size = 0;
  for (const long double x : first) keepWorse(&size, std::abs(x));
  for (const long double x : second) keepWorse(&size, std::abs(x));
  return fmt::format(
      "{} (h = {:.3g} s) and {} (h = {:.3g} s) {}: at t = {:.3g} s they are {:.2g} apart [rad, m, "
      "rad/s, m/s]",
      a.method, one->step, b.method, other->step,
      agreementText(sharedDigits(gap, static_cast<double>(size))), time, gap);
}

double lossTime(const Drift::Path& path) {
  for (std::size_t i = 0; i < path.time.size(); ++i)
    if (path.error[i] >= kLost) return path.time[i];
  return -1;
}

bool isLost(const Drift::Path& path) {
  return !(path.worst < kLost);
}

void eraseLostPaths(Drift& drift) {
  drift.paths.erase(
      std::remove_if(drift.paths.begin(), drift.paths.end(),
                     [](const Drift::Path& path) { return !std::isfinite(path.worst); }),
      drift.paths.end());
}

}  // namespace dynwitness::crosscheck
