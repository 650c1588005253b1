// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/closed_motion.hpp"
#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/motion/implicit.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/tree_motion.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
using State = ClosedMotion::State;

constexpr double kSmallestStep = 1e-12;  // [s]
constexpr long kMostSteps = 1000000;
constexpr double kRounding =
    4 * std::numeric_limits<double>::epsilon();  // of differences of times, relative to these

Simulation::Point pointAt(ClosedMotion& motion, const State& y, double time, double start_balance) {
  Simulation::Point point;
  const double balance = motion.balance(y, time), work = y.back();
  point.time = time;
  point.q.assign(y.begin(), y.begin() + motion.positions());
  point.qd.assign(y.begin() + motion.positions(), y.end() - 1);
  point.phi = motion.phi();
  point.phi_rate = motion.phiRateSize();
  point.energy_error = std::abs(balance - start_balance);
  point.work = work;
  point.kinetic = motion.kinetic();
  const auto entries = [](const Eigen::VectorXd& v) {
    return std::vector<double>(v.data(), v.data() + v.size());
  };
  point.place_errors = entries(motion.tasks().placeErrors(time));
  point.rate_errors = entries(motion.tasks().rateErrors(time));
  point.potential = balance + work - point.kinetic;
  return point;
}

template <typename Stepper>
void forgetDerivative(odeint::controlled_runge_kutta<Stepper>&,
                      odeint::explicit_error_stepper_tag) {}
/// A method that carries the last derivative over to the next step must hear that y was moved.
template <typename Controlled>
void forgetDerivative(Controlled& stepper, odeint::explicit_error_stepper_fsal_tag) {
  stepper.reset();
}

std::vector<double> outputTimes(const SimulateOptions& options) {
  std::vector<double> times;
  for (int k = 1; k <= options.outputs; ++k)
    times.push_back(options.duration * k / options.outputs);
  for (const double time : options.more_times)
    if (time > 0 && time <= options.duration) times.push_back(time);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// Watches a simulation: what is kept of it, and how far it was off.
class Watch {
 public:
  Watch(ClosedMotion& motion, const State& y, const SimulateOptions& options, Simulation* out)
      : motion_(motion), options_(options), out_(out), E_0_(motion.balance(y, 0)) {
    look(y, 0, true);
    begin_ = std::clock();
    paused_ = 0;
  }
  /// After a step. Its time is not the integrator's. @param keep  whether the state is an output
  void look(const State& y, double time, bool keep, const Eigen::VectorXd* lambda = nullptr) {
    const std::clock_t pause = std::clock();
    Simulation::Point point = pointAt(motion_, y, time, E_0_);
    keepWorse(&out_->worst_phi, point.phi);
    keepWorse(&out_->worst_phi_rate, point.phi_rate);
    keepWorse(&out_->worst_energy, point.energy_error);
    keepWorse(&out_->most_kinetic, motion_.kinetic());
    for (std::size_t k = 0; k < out_->tasks.size(); ++k) {
      keepWorse(&out_->tasks[k].worst_place, std::abs(point.place_errors[k]));
      keepWorse(&out_->tasks[k].worst_rate, std::abs(point.rate_errors[k]));
    }
    if (keep) {
      const auto solution = motion_.accelerationsOfAll(y, time);
      const Eigen::VectorXd& l = lambda ? *lambda : solution.lambda;
      point.qdd.assign(solution.qdd.data(), solution.qdd.data() + solution.qdd.size());
      point.lambda.assign(l.data(), l.data() + l.size());
      point.determined = solution.determined;
      if (motion_.hasMotors())
        point.tau.assign(solution.motors.data(), solution.motors.data() + solution.motors.size());
      point.nu.assign(solution.nu.data(), solution.nu.data() + solution.nu.size());
      out_->points.push_back(std::move(point));
    }
    paused_ += std::clock() - pause;
  }
  double seconds() const {
    return static_cast<double>(std::clock() - begin_ - paused_) / CLOCKS_PER_SEC;
  }
  void stepped(double time) {
    ++out_->steps;
    if (out_->steps > kMostSteps)
      throw std::runtime_error(fmt::format("simulate: {} steps and only {} of {} s done",
                                           kMostSteps, time, options_.duration));
    if (options_.progress) options_.progress(time);
  }
  void settled() {
    out_->rank_lowest = std::min(out_->rank_lowest, motion_.rank());
    out_->rank_highest = std::max(out_->rank_highest, motion_.rank());
  }

 private:
  ClosedMotion& motion_;
  const SimulateOptions& options_;
  Simulation* out_;
  double E_0_;
  std::clock_t begin_ = 0, paused_ = 0;
};

bool isFinite(const State& y) {
  return std::all_of(y.begin(), y.end(), [](double v) { return std::isfinite(v); });
}

/** One trial step of *dt from *t. What rejects it, besides its error: a state on the way that has
    no finite accelerations, which one of a shorter step may have.
    @return  "" where it was taken; otherwise why not, *dt the step to try next and y as it was */
template <typename Controlled, typename Category>
std::string tryStep(Controlled& stepper, Category category, ClosedMotion& motion, State* y,
                    double* t, double* dt) {
  constexpr double kShrink = 5;  // odeint's own limit for errors, however large
  const State before = *y;
  const double from = *t, asked = *dt;
  std::string why;
  try {
    if (stepper.try_step(std::ref(motion), *y, *t, *dt) != odeint::success)
      return "its error is larger than asked for";
    if (isFinite(*y)) return {};
    why = "its end is not finite";
  } catch (const std::domain_error& no_answer) {
    why = no_answer.what();
  } catch (const std::runtime_error& no_answer) {
    why = no_answer.what();
  }
  *y = before;
  *t = from;
  *dt = asked / kShrink;
  forgetDerivative(stepper, category);
  return why;
}

/// Looks for an event between the ends of steps.
class Waiting {
 public:
  Waiting(const ClosedMotion& motion, const AwaitedEvent& event, const State& y)
      : positions_(motion.positions()), event_(event) {
    if (event_.of) last_ = at(y, 0);
  }
  double at(const State& y, double time) const {
    return event_.of(time, y.data(), y.data() + positions_);
  }
  /// Whether it was passed since the last call.
  bool sees(const State& y, double time) {
    if (!event_.of) return false;
    const double before = last_;
    last_ = at(y, time);
    return (before < 0 && last_ >= 0 && event_.direction >= 0) ||
           (before > 0 && last_ <= 0 && event_.direction <= 0);
  }
  /// Whether a value has the sign that it has after the passage that was seen last.
  bool isPast(double value) const {
    return last_ > 0 ? value >= 0 : last_ < 0 ? value <= 0 : value == 0;
  }

 private:
  int positions_;
  const AwaitedEvent& event_;
  double last_ = 0;
};

template <typename Stepper>
void integrate(ClosedMotion& motion, State y, const SimulateOptions& options, Simulation* out) {
  auto stepper = odeint::make_controlled(options.step_error, options.step_error, Stepper());
  const typename Stepper::stepper_category category{};
  Watch watch(motion, y, options, out);
  double time = 0, step = options.duration / options.outputs / 100;
  Waiting waiting(motion, options.until, y);
  // y at `end`, from y at `from`: a step, or as many as it takes
  const auto moved = [&](State from_y, double from, double end) {
    auto once = odeint::make_controlled(options.step_error, options.step_error, Stepper());
    for (double h = end - from; from < end;) {
      double dt = std::min(h, end - from), t = from;
      if (!(dt > kSmallestStep) && dt < end - from)
        throw std::runtime_error(fmt::format(
            "simulate: the step fell below {} s at t = {} s, where an event is looked for",
            kSmallestStep, from));
      const bool cut = dt == end - from;
      const std::string why = tryStep(once, category, motion, &from_y, &t, &dt);
      h = dt;
      if (why.empty()) from = cut ? end : t;
    }
    motion.impose(end, &from_y);
    if (options.stabilisation == Stabilisation::kProjection && motion.rows() > 0)
      motion.project(&from_y, end);
    return from_y;
  };
  for (const double end : outputTimes(options)) {
    while (time < end) {
      // the last step before an output is cut to it, and does not teach the next one its size
      const bool cut = time + step >= end;
      double dt = cut ? end - time : step, t = time;
      const double before_time = time;
      const State before = options.until.of ? y : State();
      if (const std::string why = tryStep(stepper, category, motion, &y, &t, &dt); !why.empty()) {
        ++out->rejected;
        step = dt;
        if (!(step > kSmallestStep))
          throw std::runtime_error(fmt::format(
              "simulate: the step fell below {} s at t = {} s: {}{}", kSmallestStep, time, why,
              motion.hasHeldRows() ? "; acceleration constraints may ask here for more "
                                     "than the pose gives, allowed: a shorter duration"
                                   : ""));
        continue;
      }
      watch.stepped(time);
      time = cut ? end : t;
      if (!cut || dt < step) step = dt;
      motion.impose(time, &y);
      if (options.stabilisation == Stabilisation::kProjection && motion.rows() > 0) {
        motion.project(&y, time);
        motion.choose(y, time);
        forgetDerivative(stepper, category);
        watch.settled();
      }
      if (waiting.sees(y, time)) {
        double low = before_time, high = time;
        State at = y;
        for (double middle; middle = low + (high - low) / 2, middle > low && middle < high;) {
          const State trial = moved(before, before_time, middle);
          if (waiting.isPast(waiting.at(trial, middle)))
            high = middle, at = trial;
          else
            low = middle;
        }
        out->events.push_back(high);
        motion.choose(y, time);
        if (static_cast<int>(out->events.size()) == options.until.times) {
          watch.look(at, high, true);
          out->cpu_s = watch.seconds();
          return;
        }
      }
      watch.look(y, time, cut);
    }
  }
  out->cpu_s = watch.seconds();
}

/** Steps as long as asked: equal ones between outputs.
    @param step  (time, next) -> multipliers that it solved for, or null */
template <typename Step>
void inSteps(ClosedMotion& motion, State* y, const SimulateOptions& options, Watch& watch,
             const Step& step) {
  double time = 0;
  for (const double end : outputTimes(options)) {
    const double from = time;
    const auto count = static_cast<long>(std::ceil((end - from - kRounding * end) / options.step));
    for (long k = 1; k <= count; ++k) {
      const double next = k == count ? end : from + (end - from) * static_cast<double>(k) / count;
      const Eigen::VectorXd* lambda = step(time, next);
      if (!isFinite(*y))
        throw std::runtime_error(fmt::format("simulate: not finite at t = {} s", next));
      watch.stepped(time);
      time = next;
      if (options.stabilisation == Stabilisation::kProjection && motion.rows() > 0) {
        motion.project(y, time);
        motion.choose(*y, time);
        watch.settled();
      }
      watch.look(*y, time, k == count, lambda);
    }
  }
}

/// Radau IIA, which knows the formulations.
template <int Stages>
void integrateImplicitly(ClosedMotion& motion, State y, const SimulateOptions& options,
                         Simulation* out) {
  RadauIIA radau(motion, Stages, options.formulation);
  radau.start(y, 0);
  Watch watch(motion, y, options, out);
  inSteps(motion, &y, options, watch, [&](double time, double next) {
    radau.step(&y, time, next);
    return &radau.multipliers();
  });
  out->cpu_s = watch.seconds();
}
/// A closed mechanism as equations for any integrator; momenta it has where it is a tree alone.
class ClosedEquations : public MotionEquations<double> {
 public:
  ClosedEquations(ClosedMotion& motion, const scene::Mechanism& mechanism)
      : motion_(motion),
        tree_(mechanism),
        is_tree_(motion.rows() == 0 && !motion.isPushed() && motion.freedoms() == motion.dof() &&
                 mechanism.isOpenTree() && !motion.isHeld()) {}
  ~ClosedEquations() override { motion_.evaluations += tree_.calls; }

  int positions() const override { return motion_.positions(); }
  int dof() const override { return motion_.dof(); }
  void rate(const State& y, double time, State* rate) override { motion_(y, *rate, time); }
  bool isAutonomous() const override {
    return motion_.freedoms() == motion_.dof() && !motion_.isPushed() && !motion_.isHeld();
  }
  void move(State* y, const State& u) const override { tree_.move(y, u); }
  State commutator(const State& u, const State& v) const override { return tree_.commutator(u, v); }
  bool hasMomenta() const override { return is_tree_ && tree_.hasMomenta(); }
  State momentum(const State& y) override { return tree_.momentum(y); }
  State velocity(const State& y, const State& p) override { return tree_.velocity(y, p); }
  State pull(const State& y) override { return tree_.pull(y); }

 private:
  ClosedMotion& motion_;
  TreeMotion<double> tree_;
  bool is_tree_;
};

/// Whether somebody else than the integrator moves y after a step.
bool movesStates(const ClosedMotion& motion, const SimulateOptions& options) {
  return motion.freedoms() != motion.dof() ||
         (motion.rows() > 0 && options.stabilisation == Stabilisation::kProjection);
}

/// Any other integrator, with steps as integrateImplicitly() takes them.
void integrateInSteps(ClosedMotion& motion, const scene::Scene& scene, State y,
                      const SimulateOptions& options, Simulation* out) {
  ClosedEquations equations(motion, scene.mechanism);
  const auto stepper = stepsOf<double>(options.method, equations);
  const bool is_moved = movesStates(motion, options);
  if (is_moved && integratorNamed(options.method).remembers)
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("method '{}', allowed: any other, or a tree without drives; it goes on from "
                    "earlier steps, and projection or drives move the state after each",
                    options.method));
  double last = 0;  // [s]: length of the step before
  Watch watch(motion, y, options, out);
  inSteps(motion, &y, options, watch, [&](double time, double next) {
    const double h = next - time;
    if (std::abs(h - last) > kRounding * next) {
      stepper->forget();
      last = h;
    }
    stepper->step(&y, time, h);
    motion.impose(next, &y);
    if (is_moved) stepper->forget();
    return nullptr;
  });
  out->cpu_s = watch.seconds();
}

enum class Way { kAdaptive, kFormulations, kSteps };
using Integrate = void (*)(ClosedMotion&, State, const SimulateOptions&, Simulation*);
struct Method {
  const char* name;
  Way way;
  Integrate integrate;  ///< null: integrateInSteps()
};
/// Those that do more here than take a step.
const Method kMethods[] = {
    {"runge_kutta_fehlberg78", Way::kAdaptive, integrate<odeint::runge_kutta_fehlberg78<State>>},
    {"runge_kutta_dopri5", Way::kAdaptive, integrate<odeint::runge_kutta_dopri5<State>>},
    {"radau_iia_5", Way::kFormulations, integrateImplicitly<3>},
    {"radau_iia_3", Way::kFormulations, integrateImplicitly<2>},
    {"implicit_euler", Way::kFormulations, integrateImplicitly<1>},
};
Method methodOf(const std::string& name) {
  for (const Method& method : kMethods)
    if (name == method.name) return method;
  return {integratorNamed(name).name, Way::kSteps, nullptr};
}

void require(bool holds, const char* what, double value, const char* allowed) {
  if (!holds)
    throw scene::InputError({}, fmt::format("{} is {}, allowed: {}", what, value, allowed));
}

}  // namespace

const char* name(Controller::Tasks tasks) {
  switch (tasks) {
    case Controller::Tasks::kConstraint:
      return "constraint";
    case Controller::Tasks::kOperationalSpace:
      return "operational_space";
    case Controller::Tasks::kImpedance:
      return "impedance";
  }
  return "";
}

bool hasEqualSteps(const std::string& method) {
  return methodOf(method).way != Way::kAdaptive;
}
bool knowsFormulations(const std::string& method) {
  return methodOf(method).way == Way::kFormulations;
}

namespace {

/// What the controller cannot be.
void requireController(const scene::Scene& scene, const SimulateOptions& options) {
  const Controller& c = options.controller;
  for (const auto& [what, gain] :
       {std::pair<const char*, double>{"stiffness of tasks", c.task_stiffness},
        {"damping of tasks", c.task_damping},
        {"stiffness of the posture", c.posture_stiffness},
        {"damping of the posture", c.posture_damping}})
    require(gain >= 0 && std::isfinite(gain), what, gain, "zero or more");
  const bool has_tasks = c.tasks != Controller::Tasks::kConstraint;
  if (has_tasks && scene.mechanism.acceleration_constraints.empty())
    throw scene::InputError({scene.file.string(), 0},
                            fmt::format("controller {}: the scene has no acceleration_constraint, "
                                        "which are its tasks",
                                        name(c.tasks)));
  if (!has_tasks && (c.task_stiffness != 0 || c.task_damping != 0))
    throw scene::InputError({},
                            "gains of tasks with acceleration constraints as constraints, allowed: "
                            "a controller, operational_space or impedance");
}

}  // namespace

Simulation simulate(const scene::Scene& scene, const SimulateOptions& options) {
  const Method method = methodOf(options.method);
  requireTreated(scene, Command::kSimulate);
  require(options.duration > 0 && std::isfinite(options.duration), "duration", options.duration,
          "positive");
  require(options.outputs > 0, "number of outputs", options.outputs, "one or more");
  require(options.step_error > 0 && options.step_error < 1, "step_error", options.step_error,
          "between 0 and 1");
  require(options.baumgarte_rate >= 0 && std::isfinite(options.baumgarte_rate), "Baumgarte's rate",
          options.baumgarte_rate, "zero or more");
  if (options.formulation != Formulation::kIndex1 && method.way != Way::kFormulations)
    throw scene::InputError(
        {}, fmt::format("method '{}' with index 2 or 3, allowed: radau_iia_5, radau_iia_3, "
                        "implicit_euler; {} solves index 1 only",
                        options.method, options.method));
  if (options.formulation != Formulation::kIndex1 && options.stabilisation != Stabilisation::kNone)
    throw scene::InputError(
        {},
        "stabilisation with index 2 or 3, allowed: none, for these keep what they "
        "solve for; index 1 alone is stabilised");
  if (needsPositions(options.formulation) && scene.mechanism.hasClosuresOfRates())
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("formulation {} solves for phi = 0, which closures of rates alone (skate, "
                    "rolling) do not have, allowed: index1, index2",
                    name(options.formulation)));
  if (method.way != Way::kAdaptive && !(options.step > 0 && std::isfinite(options.step) &&
                                        options.duration / options.step <= kMostSteps))
    throw scene::InputError(
        {},
        fmt::format("step is {} s, allowed: positive, and at least the duration of {} s over {}",
                    options.step, options.duration, kMostSteps));
  requireController(scene, options);
  if (options.until.of && method.way != Way::kAdaptive)
    throw scene::InputError(
        {}, fmt::format("method '{}' with an event to wait for, allowed: runge_kutta_fehlberg78, "
                        "runge_kutta_dopri5",
                        options.method));
  ClosedMotion motion(
      scene, options.stabilisation == Stabilisation::kBaumgarte ? options.baumgarte_rate : 0,
      options.controller, options.forces);
  if (motion.hasHeldRows() && method.way == Way::kFormulations)
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("method '{}' with acceleration constraints, allowed: explicit ones",
                    options.method));
  if (motion.freedoms() == 0)
    throw scene::InputError({scene.file.string(), 0},
                            "all joints are driven, allowed: at least one that is free to move");
  State y = motion.start(scene);
  motion.equations(y, 0);
  Simulation out;
  out.constraints = motion.rows();
  out.start_residual = std::max(motion.phi(), motion.phiRateSize());
  motion.choose(y, 0);
  motion.project(&y, 0);
  motion.choose(y, 0);
  if (!motion.isClosed())
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("start: the closures are {:.3g} apart and no small change of q and qd closes "
                    "them ({:.3g} is left), allowed: a start near a closed position",
                    out.start_residual, std::max(motion.phi(), motion.phiRateSize())));
  out.rank_lowest = out.rank_highest = motion.rank();
  motion.startHere(y);
  if (motion.hasHeldRows()) {
    try {
      motion.accelerationsOfAll(y, 0);
    } catch (const std::runtime_error& contradiction) {
      throw scene::InputError({scene.file.string(), 0}, contradiction.what());
    }
  }
  const LinkTasks& tasks = motion.tasks();
  for (int k = 0; k < tasks.count(); ++k)
    out.tasks.push_back(
        {tasks.name(k), tasks.hasPlace(k), tasks.hasRate(k),
         options.controller.tasks == Controller::Tasks::kConstraint && tasks.compliance(k) != 0});
  motion.evaluations = 0;
  if (method.integrate != nullptr)
    method.integrate(motion, y, options, &out);
  else
    integrateInSteps(motion, scene, y, options, &out);
  out.evaluations = motion.evaluations;
  return out;
}

MotionGap gapBetween(const Simulation& a, const Simulation& b) {
  MotionGap gap;
  auto other = b.points.begin();
  for (const Simulation::Point& point : a.points) {
    while (other != b.points.end() && other->time < point.time) ++other;
    if (other == b.points.end() || other->time != point.time) continue;
    keepWorse(&gap.q, largestGap(point.q, other->q, point.q.size()));
    keepWorse(&gap.qd, largestGap(point.qd, other->qd, point.qd.size()));
    if (point.time > 0) ++gap.shared;
  }
  return gap;
}

double eventGap(const Simulation& a, const Simulation& b) {
  if (a.events.size() != b.events.size()) return std::numeric_limits<double>::infinity();
  return largestGap(a.events, b.events, a.events.size());
}

SimulateOptions finer(const SimulateOptions& options) {
  SimulateOptions out = options;
  (hasEqualSteps(options.method) ? out.step : out.step_error) /= 2;
  if (!hasEqualSteps(options.method))
    out.method =
        options.method == "runge_kutta_dopri5" ? "runge_kutta_fehlberg78" : "runge_kutta_dopri5";
  out.outputs *= 2;  // steps end at outputs, and may be no longer than that asks
  return out;
}

ConstrainedState constrainedAccelerations(const scene::Scene& scene, const std::vector<double>& q,
                                          const std::vector<double>& qd, double time) {
  ClosedMotion motion(scene, 0);
  State y = q;
  y.insert(y.end(), qd.begin(), qd.end());
  y.push_back(0);
  if (static_cast<int>(q.size()) != motion.positions() ||
      static_cast<int>(qd.size()) != motion.dof())
    throw std::invalid_argument(fmt::format(
        "constrainedAccelerations: q, qd: expected {} and {} joint values, got {} and {}",
        motion.positions(), motion.dof(), q.size(), qd.size()));
  const auto result = motion.accelerationsOfAll(y, time);
  const auto values = [](const Eigen::VectorXd& v) {
    return std::vector<double>(v.data(), v.data() + v.size());
  };
  return {values(result.qdd), values(result.lambda), values(result.drive), result.determined,
          motion.rank()};
}

std::vector<std::array<double, 3>> pathOf(const scene::Scene& scene, const Simulation& simulation,
                                          const scene::Attachment& point) {
  ClosedMotion motion(scene, 0);
  std::vector<std::array<double, 3>> path;
  for (const Simulation::Point& state : simulation.points) {
    State y = state.q;
    y.insert(y.end(), state.qd.begin(), state.qd.end());
    y.push_back(0);
    path.push_back(motion.place(y, state.time, point));
  }
  return path;
}

}  // namespace dynwitness::crosscheck
