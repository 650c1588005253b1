// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <fmt/format.h>

#include "recursive/constrained_solver.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/point_springs.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
using State = std::vector<double>;  // (q, qd, work of loads and dampers)
using Vector = Eigen::VectorXd;

constexpr double kSmallestStep = 1e-12;  // [s]
constexpr long kMostSteps = 1000000;

/// A closed mechanism as an ordinary differential equation with invariants.
class ClosedMotion {
 public:
  ClosedMotion(const scene::Scene& scene, Stabilisation stabilisation, double rate)
      : number_(scene.mechanism),
        model_(recursive::buildModel(scene.mechanism, number_)),
        ws_(model_),
        constraints_(recursive::buildConstraints(scene.mechanism, number_, model_)),
        springs_(recursive::buildPointSprings(scene.mechanism, number_, model_)),
        baumgarte_(stabilisation == Stabilisation::kBaumgarte ? rate : 0),
        x_(model_.positions), qd_(dof()), q_rate_(model_.positions), zero_(dof(), 0.0), tau_(dof()), bias_(dof()), M_(dof(), dof()) {}

  int dof() const { return model_.dof(); }
  int positions() const { return model_.positions; }
  int rows() const { return constraints_.rows(); }
  State start(const scene::Scene& scene) const {
    State y;
    for (const scene::Number& q : scene.start_q) y.push_back(number_(q));
    for (const scene::Number& qd : scene.start_qd) y.push_back(number_(qd));
    y.push_back(0);
    return y;
  }

  void operator()(const State& y, State& rate, double) {
    ++evaluations;
    const auto& result = accelerations(y);
    recursive::positionRates(model_, x_, qd_, q_rate_);
    std::copy(q_rate_.begin(), q_rate_.end(), rate.begin());
    for (int i = 0; i < dof(); ++i) rate[positions() + i] = result.qdd(i);
    rate.back() = loadPower() - spring_.dissipation - recursive::frictionPower(model_, qd_);
  }

  /** Which equations stand for all, decided at this state and kept until the next call. Redundant
      equations depend on each other only where phi = 0, and the trial states inside a step of an integrator
      do not lie there: deciding again at each of them would make the accelerations jump. */
  void choose(const State& y) {
    equations(y);
    recursive::massMatrix(model_, x_, ws_, M_);
    solver_.factorize(M_, constraints_.J);
    chosen_ = solver_.independentRows();
  }

  /// M qdd = tau_springs - bias + J' lambda,   J qdd = -gamma - 2 w J qd - w^2 phi
  recursive::ConstrainedSolver<double>::Result accelerations(const State& y) {
    equations(y);
    return accelerationsHere(false);
  }
  /// The same with all rows, redundant ones too: for the multipliers.
  recursive::ConstrainedSolver<double>::Result accelerationsOfAll(const State& y) {
    equations(y);
    return accelerationsHere(true);
  }

 private:
  recursive::ConstrainedSolver<double>::Result accelerationsHere(bool all) {
    std::fill(tau_.begin(), tau_.end(), 0.0);
    spring_ = recursive::addSpringForces(model_, springs_, constraints_.X_W, ws_, tau_);
    recursive::inverseDynamics(model_, x_, qd_, zero_, ws_, bias_);
    Vector f(dof());
    for (int i = 0; i < dof(); ++i) f(i) = tau_[i] - bias_[i];
    const Vector b = -constraints_.gamma - 2 * baumgarte_ * phiRate() -
                     baumgarte_ * baumgarte_ * constraints_.phi;
    if (all) {
      recursive::massMatrix(model_, x_, ws_, M_);
      solver_.factorize(M_, constraints_.J);
      return solver_.solve(f, b);
    }
    factorize();
    return solver_.solve(f, chosen(b));
  }

 public:

  double phi() const { return largest(constraints_.phi); }
  double phiRateSize() const { return largest(phiRate()); }
  int rank() const { return static_cast<int>(solver_.rank()); }

  /// phi and J at this state.
  void equations(const State& y) {
    for (int i = 0; i < positions(); ++i) x_[i] = scene::jointPosition(y[i]);
    std::copy_n(y.begin() + positions(), dof(), qd_.begin());
    recursive::constraintEquations(model_, x_, qd_, ws_, constraints_);
  }

  /** Newton's method for phi(q) = 0, each step the shortest in M's norm, then the same for J qd = 0.
      It ends when phi no longer halves: then rounding is what is left. */
  void project(State* y) {
    if (rows() == 0) return;
    equations(*y);
    constexpr int kMostSteps = 25;
    for (int k = 0; k < kMostSteps; ++k) {
      const double before = phi();
      if (before == 0) break;
      factorize();
      const Vector dq = solver_.shortest(-chosen(constraints_.phi));
      State moved = *y;
      recursive::positionRates(model_, x_, std::vector<double>(dq.data(), dq.data() + dof()), q_rate_);
      for (int i = 0; i < positions(); ++i) moved[i] += q_rate_[i];
      equations(moved);
      if (!(phi() < before)) break;
      *y = moved;
      if (phi() > before / 2) break;
    }
    equations(*y);
    factorize();
    const Vector dqd = solver_.shortest(-chosen(phiRate()));
    for (int i = 0; i < dof(); ++i) (*y)[positions() + i] += dqd(i);
  }

  /// E - work of loads and dampers [J]; the part that must not change.
  double balance(const State& y) {
    equations(y);
    std::fill(tau_.begin(), tau_.end(), 0.0);
    const double springs =
        recursive::addSpringForces(model_, springs_, constraints_.X_W, ws_, tau_).energy;
    kinetic_ = recursive::kineticEnergy(model_, x_, qd_, ws_);
    return kinetic_ + recursive::potentialEnergy(model_, x_, ws_) + springs - y.back();
  }
  double kinetic() const { return kinetic_; }

  /// A point of a link of the scene in world axes.
  std::array<double, 3> place(const State& y, const scene::Attachment& point) {
    equations(y);
    const auto& in_model = model_.places[point.link];
    const recursive::Transform<double> X =
        in_model.link < 0 ? in_model.X : in_model.X * constraints_.X_W[in_model.link];
    const recursive::Vector3<double> p =
        X.p + X.R.transpose() * recursive::detail::vector<double>(point.xyz, number_);
    return {p.x(), p.y(), p.z()};
  }

  long evaluations = 0;

 private:
  static double largest(const Vector& v) { return v.size() == 0 ? 0 : v.cwiseAbs().maxCoeff(); }
  Vector phiRate() const {
    return constraints_.J * Eigen::Map<const Vector>(qd_.data(), dof());
  }
  Vector chosen(const Vector& all) const {
    Vector out(chosen_.size());
    for (std::size_t i = 0; i < chosen_.size(); ++i) out(i) = all(chosen_[i]);
    return out;
  }
  /// With the chosen rows alone, whatever their rank is here.
  void factorize() {
    recursive::massMatrix(model_, x_, ws_, M_);
    J_chosen_.resize(chosen_.size(), dof());
    for (std::size_t i = 0; i < chosen_.size(); ++i) J_chosen_.row(i) = constraints_.J.row(chosen_[i]);
    solver_.factorize(M_, J_chosen_, 0);
  }
  /// Of the wrenches, at the velocities of the last equations().
  double loadPower() {
    for (auto& f : ws_.f) f = recursive::Force<double>::zero();
    recursive::subtractLoads(model_, ws_, ws_.f);
    double power = 0;
    for (std::size_t i = 0; i < model_.links.size(); ++i) power -= dot(ws_.v[i], ws_.f[i]);
    return power;
  }

  scene::RealNumbers<double> number_;
  recursive::Model<double> model_;
  recursive::Workspace<double> ws_;
  recursive::Constraints<double> constraints_;
  std::vector<recursive::PointSpring<double>> springs_;
  double baumgarte_;
  recursive::ConstrainedSolver<double> solver_;
  recursive::SpringState<double> spring_;
  std::vector<scene::JointPosition<double>> x_;
  std::vector<double> qd_, q_rate_, zero_, tau_, bias_;
  recursive::MatrixX<double> M_, J_chosen_;
  std::vector<int> chosen_;
  double kinetic_ = 0;
};

Simulation::Point pointAt(ClosedMotion& motion, const State& y, double time, double start_balance) {
  Simulation::Point point;
  const double error = std::abs(motion.balance(y) - start_balance);
  point.time = time;
  point.q.assign(y.begin(), y.begin() + motion.positions());
  point.qd.assign(y.begin() + motion.positions(), y.end() - 1);
  point.phi = motion.phi();
  point.phi_rate = motion.phiRateSize();
  point.energy_error = error;
  return point;
}

template <typename Stepper>
void forgetDerivative(odeint::controlled_runge_kutta<Stepper>&, odeint::explicit_error_stepper_tag) {}
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

template <typename Stepper>
void integrate(ClosedMotion& motion, State y, const SimulateOptions& options, Simulation* out) {
  auto stepper = odeint::make_controlled(options.step_error, options.step_error, Stepper());
  const double E_0 = motion.balance(y);
  const auto take = [&](const State& state, double time) {
    const Simulation::Point point = pointAt(motion, state, time, E_0);
    const auto keep = [](double* worst, double value) {  // NaN counts as the worst
      if (!(value <= *worst)) *worst = value;
    };
    keep(&out->worst_phi, point.phi);
    keep(&out->worst_phi_rate, point.phi_rate);
    keep(&out->worst_energy, point.energy_error);
    keep(&out->most_kinetic, motion.kinetic());
    return point;
  };
  out->points.push_back(take(y, 0));
  const std::clock_t begin = std::clock();
  std::clock_t watching = 0;  // not the integrator's
  double time = 0, step = options.duration / options.outputs / 100;
  for (const double end : outputTimes(options)) {
    while (time < end) {
      // the last step before an output is cut to it, and does not teach the next one its size
      const bool cut = time + step >= end;
      double dt = cut ? end - time : step, t = time;
      const bool accepted =
          stepper.try_step(std::ref(motion), y, t, dt) == odeint::success &&
          std::all_of(y.begin(), y.end(), [](double v) { return std::isfinite(v); });
      if (!accepted) {
        ++out->rejected;
        step = dt;
        if (!(step > kSmallestStep))
          throw std::runtime_error(fmt::format("simulate: the step fell below {} s at t = {} s",
                                               kSmallestStep, time));
        continue;
      }
      ++out->steps;
      time = cut ? end : t;
      if (!cut || dt < step) step = dt;
      if (out->steps > kMostSteps)
        throw std::runtime_error(fmt::format("simulate: {} steps and only {} of {} s done",
                                             kMostSteps, time, options.duration));
      if (options.stabilisation == Stabilisation::kProjection && motion.rows() > 0) {
        motion.project(&y);
        motion.choose(y);
        forgetDerivative(stepper, typename Stepper::stepper_category());
        out->rank_lowest = std::min(out->rank_lowest, motion.rank());
        out->rank_highest = std::max(out->rank_highest, motion.rank());
      }
      const std::clock_t pause = std::clock();
      const Simulation::Point point = take(y, time);
      if (cut) out->points.push_back(point);
      watching += std::clock() - pause;
    }
  }
  out->cpu_s = static_cast<double>(std::clock() - begin - watching) / CLOCKS_PER_SEC;
}

struct Method {
  const char* name;
  void (*integrate)(ClosedMotion&, State, const SimulateOptions&, Simulation*);
};
const Method kMethods[] = {
    {"runge_kutta_fehlberg78", integrate<odeint::runge_kutta_fehlberg78<State>>},
    {"runge_kutta_dopri5", integrate<odeint::runge_kutta_dopri5<State>>},
};

const Method& methodNamed(const std::string& name) {
  std::string names;
  for (const Method& method : kMethods) {
    if (name == method.name) return method;
    names += std::string(names.empty() ? "" : ", ") + method.name;
  }
  throw scene::InputError({}, fmt::format("unknown method '{}', allowed: {}", name, names));
}

void require(bool holds, const char* what, double value, const char* allowed) {
  if (!holds) throw scene::InputError({}, fmt::format("{} is {}, allowed: {}", what, value, allowed));
}

}  // namespace

std::vector<std::string> simulateMethods() {
  std::vector<std::string> names;
  for (const Method& method : kMethods) names.emplace_back(method.name);
  return names;
}

Simulation simulate(const scene::Scene& scene, const SimulateOptions& options) {
  const Method& method = methodNamed(options.method);
  require(options.duration > 0 && std::isfinite(options.duration), "duration", options.duration,
          "positive");
  require(options.outputs > 0, "number of outputs", options.outputs, "one or more");
  require(options.step_error > 0 && options.step_error < 1, "step_error", options.step_error,
          "between 0 and 1");
  require(options.baumgarte_rate >= 0 && std::isfinite(options.baumgarte_rate), "Baumgarte's rate",
          options.baumgarte_rate, "zero or more");
  ClosedMotion motion(scene, options.stabilisation, options.baumgarte_rate);
  State y = motion.start(scene);
  motion.equations(y);
  Simulation out;
  out.constraints = motion.rows();
  out.start_residual = std::max(motion.phi(), motion.phiRateSize());
  motion.choose(y);
  motion.project(&y);
  motion.choose(y);
  // Newton's method squares what is left with each step: from below the root of eps [m, rad, 1/s] the
  // next one ends at rounding; where it stays above, it did not arrive
  const double kOnConstraints = std::sqrt(std::numeric_limits<double>::epsilon());
  if (!(motion.phi() <= kOnConstraints) || !(motion.phiRateSize() <= kOnConstraints))
    throw scene::InputError(
        {scene.file.string(), 0},
        fmt::format("start: the closures are {:.3g} apart and no small change of q and qd closes "
                    "them ({:.3g} is left), allowed: a start near a closed position",
                    out.start_residual, std::max(motion.phi(), motion.phiRateSize())));
  out.rank_lowest = out.rank_highest = motion.rank();
  motion.evaluations = 0;
  method.integrate(motion, y, options, &out);
  out.evaluations = motion.evaluations;
  return out;
}

ConstrainedState constrainedAccelerations(const scene::Scene& scene, const std::vector<double>& q,
                                          const std::vector<double>& qd) {
  ClosedMotion motion(scene, Stabilisation::kNone, 0);
  State y = q;
  y.insert(y.end(), qd.begin(), qd.end());
  y.push_back(0);
  if (static_cast<int>(q.size()) != motion.positions() || static_cast<int>(qd.size()) != motion.dof())
    throw std::invalid_argument(
        fmt::format("constrainedAccelerations: q, qd: expected {} and {} joint values, got {} and {}",
                    motion.positions(), motion.dof(), q.size(), qd.size()));
  const auto result = motion.accelerationsOfAll(y);
  ConstrainedState out;
  out.qdd.assign(result.qdd.data(), result.qdd.data() + result.qdd.size());
  out.lambda.assign(result.lambda.data(), result.lambda.data() + result.lambda.size());
  out.determined = result.determined;
  out.rank = motion.rank();
  return out;
}

std::vector<std::array<double, 3>> pathOf(const scene::Scene& scene, const Simulation& simulation,
                                          const scene::Attachment& point) {
  ClosedMotion motion(scene, Stabilisation::kNone, 0);
  std::vector<std::array<double, 3>> path;
  for (const Simulation::Point& state : simulation.points) {
    State y = state.q;
    y.insert(y.end(), state.qd.begin(), state.qd.end());
    y.push_back(0);
    path.push_back(motion.place(y, point));
  }
  return path;
}

}  // namespace dynwitness::crosscheck
