// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/closed_work.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/motion/motion_tables.hpp"
#include "crosscheck/motion/state_gap.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr long kFirstSteps = 16;
constexpr double kFirstStepError = 1e-2;
constexpr double kLeastStepError = 1000 * std::numeric_limits<double>::epsilon();
constexpr int kFewestDigits = 6;  // decimal places to which a reference is known

SimulateOptions optionsOf(const ClosedMethod& method, double duration) {
  SimulateOptions options;
  options.duration = duration;
  options.outputs = 1;
  options.method = method.integrator;
  options.formulation = method.formulation;
  options.stabilisation = method.stabilisation;
  return options;
}

std::vector<long double> endOf(const scene::Mechanism& mechanism, const Simulation& run,
                               const std::vector<long double>& like = {}) {
  std::vector<double> y = run.points.back().q;
  y.insert(y.end(), run.points.back().qd.begin(), run.points.back().qd.end());
  y.push_back(0);
  return placed(mechanism, y, like);
}

double apart(const std::vector<long double>& a, const std::vector<long double>& b) {
  return static_cast<double>(largestGap(a, b, a.size()));
}

/// Radau's end, its steps halved until two are no nearer to each other than those before; none: it
/// does not arrive.
std::vector<long double> radauEnd(const scene::Scene& scene, double duration,
                                  const std::vector<long double>& like) {
  constexpr long kMostSteps = 1L << 13;
  SimulateOptions options =
      optionsOf({"radau_iia_5", Formulation::kIndex2, Stabilisation::kNone, 5}, duration);
  std::vector<long double> best, before;
  double change = std::numeric_limits<double>::infinity();
  for (long steps = kFirstSteps; steps <= kMostSteps; steps *= 2) {
    options.step = duration / static_cast<double>(steps);
    std::vector<long double> now;
    try {
      now = endOf(scene.mechanism, simulate(scene, options), like);
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error&) {  // a step too long for Newton's method
      continue;
    } catch (const std::domain_error&) {  // or for its states on the way
      continue;
    }
    const double moved =
        before.empty() ? std::numeric_limits<double>::infinity() : apart(now, before);
    before = now;
    // wild as long as the steps do not follow: there differences rise and fall
    if (change < std::pow(10, -kFewestDigits) && !(moved < change)) break;
    if (moved < change) best = now, change = moved;
  }
  return best;
}

/// "published positions 4e-11 away" (data/reference/motion); "": none are of that time.
std::string publishedText(const scene::Scene& scene, const Simulation& run, double duration) {
  std::string text;
  for (MotionTable table : motionTables(scene)) {
    table.rows.erase(std::remove_if(table.rows.begin(), table.rows.end(),
                                    [&](const auto& row) { return row.time != duration; }),
                     table.rows.end());
    if (table.rows.empty()) continue;
    text += fmt::format("{}{} {:.1g} away", text.empty() ? "" : ", ",
                        table.own.empty() ? "published positions" : "positions by hand",
                        compareMotion(scene, run, table).worst);
  }
  return text;
}

/// One run, told as a point.
class Measuring {
 public:
  Measuring(const scene::Scene& scene, const ReferenceMotion& reference)
      : scene_(scene), reference_(reference) {}

  WorkPoint operator()(const SimulateOptions& options) const {
    constexpr int kMostRuns = 5;
    constexpr double kLongEnough = 0.02;  // [s]: a clock's tick is nothing beside it
    WorkPoint point;
    point.step = options.step;
    point.seconds = std::numeric_limits<double>::infinity();
    const std::clock_t begin = std::clock();
    try {
      double spent = 0;
      for (int run = 0; run < kMostRuns && spent < kLongEnough; ++run) {
        const Simulation result = simulate(scene_, options);
        spent += result.cpu_s;
        point.seconds = std::min(point.seconds, result.cpu_s);
        if (run > 0) continue;
        point.calls = result.evaluations;
        point.step = options.duration / static_cast<double>(std::max(result.steps, 1L));
        point.error = apart(endOf(scene_.mechanism, result, reference_.y), reference_.y);
        point.energy_error = result.worst_energy / reference_.most_kinetic;
      }
      if (!std::isfinite(point.error)) point.failure = "not finite";
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      point.failure = error.what();
    } catch (const std::domain_error& error) {  // a state on the way that has no accelerations
      point.failure = error.what();
    }
    if (!std::isfinite(point.seconds)) {  // the price of what does not arrive
      point.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      point.calls = formedUntilItFails(options);
    }
    return point;
  }

 private:
  /// How often the equations are formed in a run that does not arrive, projections included.
  long formedUntilItFails(SimulateOptions options) const {
    long formed = 0;
    options.forces = [&formed](double, std::vector<double>*) { ++formed; };
    try {
      simulate(scene_, options);
    } catch (const std::exception&) {  // as before
    }
    return formed;
  }

  const scene::Scene& scene_;
  const ReferenceMotion& reference_;
};

/// Where an error has risen again, the least of the line is what rounding leaves of it.
ObservedOrder observedOrderOf(const WorkLine& line, const ReferenceMotion& reference,
                              bool is_equal) {
  const auto& points = line.points;
  double least = std::numeric_limits<double>::infinity();
  for (const WorkPoint& point : points)
    if (point.failure.empty()) least = std::min(least, point.error);
  const bool has_risen =
      points.size() > 1 && points.back().failure.empty() && points.back().error > least;
  const double floor = std::max(reference.error, has_risen ? least : 0.0);
  ObservedOrder order = observedOrder(points, [floor](const WorkPoint&) { return floor; });
  if (order.value == 0 && !is_equal)
    order.why_not = "its steps are chosen one by one, and their mean is no step: " + order.why_not;
  return order;
}

WorkLine lineOf(const scene::Scene& scene, const ClosedMethod& method, const Measuring& measure,
                const WorkOptions& options, const ReferenceMotion& reference) {
  constexpr long kMostSteps = 1L << 19;
  WorkLine line;
  line.method = method.label();
  line.order = method.order;
  if (needsPositions(method.formulation) && scene.mechanism.hasClosuresOfRates()) {
    line.left_out = "closures of rates alone (skate, rolling) have no phi = 0 to solve for";
    return line;
  }
  const bool is_constrained = !scene.mechanism.closures.empty(),
             is_projected = method.stabilisation == Stabilisation::kProjection;
  if (!is_constrained && !is_projected) {
    line.left_out = "no closures: there is one form of the equations, index1";
    return line;
  }
  SimulateOptions with = optionsOf(method, options.duration);
  const bool is_equal = hasEqualSteps(method.integrator);
  try {
    for (long steps = kFirstSteps; steps <= kMostSteps; steps *= 2) {
      if (is_equal)
        with.step = options.duration / static_cast<double>(steps);
      else
        with.step_error = line.points.empty() ? kFirstStepError : with.step_error / 10;
      if (!is_equal && with.step_error < kLeastStepError) break;
      line.points.push_back(measure(with));
      const WorkPoint& point = line.points.back();
      if (point.failure.empty() && point.error <= reference.error) break;
      if (point.failure.empty() && 2 * point.seconds > options.longest_run) break;
    }
  } catch (const scene::InputError& refused) {
    line.points.clear();
    line.left_out = refused.what();
    return line;
  }
  const ObservedOrder order = observedOrderOf(line, reference, is_equal);
  line.observed_order = order.value;
  line.no_order = order.why_not;
  return line;
}

}  // namespace

std::string ClosedMethod::label() const {
  return fmt::format(
      "{} {}", integrator,
      stabilisation == Stabilisation::kNone ? name(formulation) : name(stabilisation));
}

const std::vector<ClosedMethod>& closedMethods() {
  using F = Formulation;
  using S = Stabilisation;
  static const std::vector<ClosedMethod> all = {
      {"semi_implicit_euler", F::kIndex1, S::kProjection, 1},
      {"runge_kutta4", F::kIndex1, S::kNone, 4},
      {"runge_kutta4", F::kIndex1, S::kBaumgarte, 4},
      {"runge_kutta4", F::kIndex1, S::kProjection, 4},
      {"runge_kutta_dopri5", F::kIndex1, S::kProjection, 5},
      {"runge_kutta_fehlberg78", F::kIndex1, S::kProjection, 8},
      {"bulirsch_stoer8", F::kIndex1, S::kProjection, 8},
      {"gauss_6", F::kIndex1, S::kProjection, 6},
      {"implicit_euler", F::kIndex2, S::kNone, 1},
      {"radau_iia_3", F::kIndex2, S::kNone, 3},
      {"radau_iia_5", F::kIndex1, S::kProjection, 5},
      {"radau_iia_5", F::kIndex2, S::kNone, 5},
      {"radau_iia_5", F::kIndex3, S::kNone, 3},
      {"radau_iia_5", F::kGgl, S::kNone, 5}};
  return all;
}

ReferenceMotion closedReference(const scene::Scene& scene, double duration) {
  ReferenceMotion out;
  SimulateOptions options = optionsOf(
      {"runge_kutta_fehlberg78", Formulation::kIndex1, Stabilisation::kProjection, 8}, duration);
  options.step_error = kLeastStepError;
  const Simulation run = simulate(scene, options);
  out.y = endOf(scene.mechanism, run);
  const std::vector<long double> other = radauEnd(scene, duration, out.y);
  if (other.empty())
    throw std::runtime_error("no reference: radau_iia_5 on index 2 does not arrive with any step");
  out.error = apart(out.y, other);
  if (!(out.digits() >= kFewestDigits))
    throw std::runtime_error(fmt::format(
        "no reference: after {} s runge_kutta_fehlberg78 (index 1, projection) and radau_iia_5 "
        "(index 2) are {:.2g} apart; {} decimal places are needed, allowed: a shorter --duration",
        duration, out.error, kFewestDigits));
  out.by = "runge_kutta_fehlberg78 (projection) and radau_iia_5 (index2)";
  out.published = publishedText(scene, run, duration);
  out.most_kinetic = run.most_kinetic;
  return out;
}

WorkPrecision measureClosedWork(const scene::Scene& scene, const WorkOptions& options) {
  std::set<std::string> known;
  for (const ClosedMethod& method : closedMethods()) known.insert(method.integrator);
  for (const std::string& method : options.methods)
    if (known.count(method) == 0)
      throw scene::InputError({}, fmt::format("method '{}' with closed loops, allowed: {}", method,
                                              fmt::join(known, ", ")));
  WorkPrecision out;
  out.scene = scene.name;
  out.title = scene.title;
  out.duration = options.duration;
  if (options.progress) options.progress("reference");
  out.reference = closedReference(scene, options.duration);
  const Measuring measure(scene, out.reference);
  for (const ClosedMethod& method : closedMethods()) {
    if (!options.methods.empty() && std::find(options.methods.begin(), options.methods.end(),
                                              method.integrator) == options.methods.end())
      continue;
    if (options.progress) options.progress(method.label());
    out.lines.push_back(lineOf(scene, method, measure, options, out.reference));
  }
  return out;
}

}  // namespace dynwitness::crosscheck
