// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/modified_midpoint.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <fmt/format.h>

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/energy.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
using Vector = std::vector<double>;  // (q, qd, what friction has taken [J])

constexpr int kChartPoints = 400;        // a path is thinned to about this many for the chart
constexpr double kFirstStep = 0.01;      // [s]
constexpr int kMostHalvings = 9;

/// The mechanism as an ordinary differential equation, and its energy.
class Motion {
 public:
  explicit Motion(const scene::Mechanism& mechanism)
      : model_(recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism))),
        ws_(model_), x_(model_.positions), qd_(model_.dof()), qdd_(model_.dof()),
        q_rate_(model_.positions), no_force_(model_.dof(), 0.0) {}

  void operator()(const Vector& y, Vector& rate, double) {
    split(y);
    recursive::forwardDynamics(model_, x_, qd_, no_force_, ws_, qdd_);
    recursive::positionRates(model_, x_, qd_, q_rate_);
    std::copy(q_rate_.begin(), q_rate_.end(), rate.begin());
    std::copy(qdd_.begin(), qdd_.end(), rate.begin() + model_.positions);
    rate.back() = recursive::frictionPower(model_, qd_);
  }
  double kinetic(const Vector& y) {
    split(y);
    return recursive::kineticEnergy(model_, x_, qd_, ws_);
  }
  /// T + V, and with friction what it has taken: the sum must not change.
  double energy(const Vector& y) {
    const double E = kinetic(y) + recursive::potentialEnergy(model_, x_, ws_);
    return model_.friction ? E + y.back() : E;
  }

 private:
  void split(const Vector& y) {
    for (int i = 0; i < model_.positions; ++i) x_[i] = scene::jointPosition(y[i]);
    std::copy_n(y.begin() + model_.positions, model_.dof(), qd_.begin());
  }
  recursive::Model<double> model_;
  recursive::Workspace<double> ws_;
  std::vector<scene::JointPosition<double>> x_;
  Vector qd_, qdd_, q_rate_, no_force_;
};

struct Trace {
  Drift::Path path;
  double most_kinetic = 0;
};

template <typename Stepper>
Trace simulate(Motion& motion, Vector y, double step, double duration) {
  Stepper stepper;
  const long steps = std::lround(duration / step);
  const long stride = std::max(1L, steps / kChartPoints);
  const double E_0 = motion.energy(y);
  Trace trace;
  trace.path.step = step;
  double most_since_point = 0;
  for (long k = 1; k <= steps; ++k) {
    stepper.do_step(std::ref(motion), y, (k - 1) * step, step);
    const double error = std::abs(motion.energy(y) - E_0);
    const double kinetic = motion.kinetic(y);
    trace.most_kinetic = kinetic <= trace.most_kinetic ? trace.most_kinetic : kinetic;
    // NaN counts as the worst: a path that left the numbers has lost its energy
    trace.path.worst = error <= trace.path.worst ? trace.path.worst : error;
    most_since_point = error <= most_since_point ? most_since_point : error;
    if (k % stride == 0) {  // the chart keeps the largest of each stretch, not a sample
      trace.path.time.push_back(k * step);
      trace.path.error.push_back(most_since_point);
      most_since_point = 0;
    }
  }
  return trace;
}

using Simulate = Trace (*)(Motion&, Vector, double, double);
struct Method {
  const char* name;
  int order;
  Simulate simulate;
};
const Method kMethods[] = {
    {"euler", 1, simulate<odeint::euler<Vector>>},
    {"modified_midpoint", 2, simulate<odeint::modified_midpoint<Vector>>},
    {"runge_kutta4", 4, simulate<odeint::runge_kutta4<Vector>>},
    {"runge_kutta_dopri5", 5, simulate<odeint::runge_kutta_dopri5<Vector>>},
    {"runge_kutta_fehlberg78", 8, simulate<odeint::runge_kutta_fehlberg78<Vector>>},
};

const Method& methodNamed(const std::string& name) {
  std::string names;
  for (const Method& method : kMethods) {
    if (name == method.name) return method;
    names += std::string(names.empty() ? "" : ", ") + method.name;
  }
  throw scene::InputError({}, fmt::format("unknown method '{}', allowed: {}", name, names));
}

/// Order seen between two step sizes.
double orderBetween(const Drift::Path& coarse, const Drift::Path& fine) {
  return std::log(coarse.worst / fine.worst) / std::log(coarse.step / fine.step);
}

/// Each step may add a rounding error of eps to the energy's scale: below steps * eps, differences
/// between step sizes mean nothing.
double roundingFloor(const Drift& drift, const Drift::Path& path) {
  return std::numeric_limits<double>::epsilon() * drift.duration / path.step;
}

/// The order between the two finest steps whose drift lies above rounding; 0 when there are no two.
double observedOrder(const Drift& drift) {
  for (std::size_t k = drift.paths.size(); k-- > 1;)
    if (drift.paths[k].worst > roundingFloor(drift, drift.paths[k]))
      return orderBetween(drift.paths[k - 1], drift.paths[k]);
  return 0;
}

bool orderShows(const Drift& drift) {
  return drift.paths.size() >= 2 && drift.observed_order > drift.method_order - 1;
}

/// With its finest steps the method loses nothing but rounding, as it does in free fall with any. (A
/// wrong qdd drifts by the same amount at every step size, far above that.)
bool belowRounding(const Drift& drift) {
  return drift.paths.back().worst <= roundingFloor(drift, drift.paths.back());
}

bool isFinite(const Drift& drift) {
  return std::isfinite(drift.scale) &&
         std::all_of(drift.paths.begin(), drift.paths.end(),
                     [](const Drift::Path& path) { return std::isfinite(path.worst); });
}

}  // namespace

std::vector<std::pair<std::string, int>> driftMethods() {
  std::vector<std::pair<std::string, int>> out;
  for (const Method& method : kMethods) out.emplace_back(method.name, method.order);
  return out;
}

bool conservesEnergy(const scene::Mechanism& mechanism) {
  return mechanism.wrenches.empty() && mechanism.isOpenTree() && !mechanism.hasCoulombFriction();
}

Drift measureDrift(const scene::Scene& scene, const DriftOptions& options) {
  const Method& method = methodNamed(options.method);
  if (!scene.mechanism.isOpenTree())
    throw scene::InputError({scene.file.string(), 0},
                            "has closures, or springs between points, allowed: a tree of links; "
                            "'dynwitness simulate' moves this scene");
  if (scene.mechanism.hasCoulombFriction())
    throw scene::InputError({scene.file.string(), 0},
                            "has Coulomb friction, which jumps where a joint turns back: no integrator has "
                            "its order there, drift cannot be measured; allowed: viscous friction");
  if (!conservesEnergy(scene.mechanism))
    throw scene::InputError({scene.file.string(), 0},
                            "has a wrench: its energy is not constant, drift cannot be measured");
  if (!(options.duration > 0) || !std::isfinite(options.duration))
    throw scene::InputError({}, fmt::format("duration is {} s, allowed: positive", options.duration));
  constexpr double kMostSteps = 1e8;
  for (const double step : options.steps)
    if (!(step > 0) || step > options.duration || options.duration / step > kMostSteps)
      throw scene::InputError(
          {}, fmt::format("step is {} s, allowed: positive, at most the duration of {} s, and at "
                          "least a hundred millionth of it", step, options.duration));

  Motion motion(scene.mechanism);
  const scene::RealNumbers<double> number(scene.mechanism);
  Vector start;
  for (const scene::Number& q : scene.start_q) start.push_back(number(q));
  for (const scene::Number& qd : scene.start_qd) start.push_back(number(qd));
  start.push_back(0);

  Drift drift;
  drift.method = method.name;
  drift.method_order = method.order;
  drift.duration = options.duration;
  Vector rate(start.size());
  motion(start, rate, 0);
  if (!std::all_of(rate.begin(), rate.end(), [](double x) { return std::isfinite(x); }))
    return drift;
  const auto run = [&](double step) {
    const Trace trace = method.simulate(motion, start, step, options.duration);
    drift.paths.push_back(trace.path);
    drift.scale = trace.most_kinetic;  // of the finest path in the end
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
  if (!options.steps.empty()) {
    std::vector<double> steps = options.steps;
    std::sort(steps.rbegin(), steps.rend());
    for (const double step : steps) run(step);
    return relative();
  }
  // three steps at least for the chart, then on until the method's order shows
  double step = kFirstStep;
  for (int k = 0; k <= kMostHalvings; ++k, step /= 2) {
    run(step);
    const Drift so_far = relative();
    // a step too coarse for this motion; of a wrong qdd the finest is too
    if (!isFinite(so_far) && k < kMostHalvings) {
      drift.paths.clear();
      continue;
    }
    if (so_far.paths.size() < 4) continue;
    if (orderShows(so_far) || belowRounding(so_far) || !isFinite(so_far) || so_far.scale == 0) break;
  }
  return relative();
}

CheckResult checkDrift(const Drift& drift) {
  CheckResult check;
  check.check = "energy drift";
  check.statement = fmt::format("|E - E0| falls as step^{} with {}", drift.method_order, drift.method);
  check.quantity = "energy";
  check.left = "articulated_body";
  check.unit = "observed order (at least)";
  check.states = static_cast<int>(drift.paths.size());
  check.worst = drift.observed_order;
  check.limit = drift.method_order - 1;
  check.ratio = orderShows(drift) ? check.limit / check.worst : std::numeric_limits<double>::infinity();
  if (drift.paths.empty()) {
    check.verdict = Verdict::kNotAnswerable;
    check.reason = kNoMotion;
    check.ratio = 0;
  } else if (drift.scale == 0) {
    check.verdict = Verdict::kNotAnswerable;
    check.reason = "nothing moves from the start state: give the scene a [start]";
    check.ratio = 0;
  } else if (!isFinite(drift)) {
    check.verdict = Verdict::kDisagree;
    check.reason = "the simulated motion leaves the numbers (NaN or infinite energy)";
  } else if (belowRounding(drift)) {
    check.unit = "rounding of the steps";
    check.ratio = check.worst = drift.paths.back().worst / roundingFloor(drift, drift.paths.back());
    check.limit = 1;
  } else if (!orderShows(drift)) {
    check.verdict = Verdict::kDisagree;
    check.reason = fmt::format("energy drift falls with order {:.2f} down to steps of {:.2g} s; {} has {}",
                               drift.observed_order, drift.paths.back().step, drift.method,
                               drift.method_order);
  }
  return check;
}

}  // namespace dynwitness::crosscheck
