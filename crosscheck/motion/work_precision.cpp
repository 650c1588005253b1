// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/work_precision.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/tree_motion.hpp"

namespace dynwitness::crosscheck {
namespace {

using Real = long double;

double apart(const std::vector<Real>& a, const std::vector<Real>& b) {
  return static_cast<double>(largestGap(a, b, a.size()));
}

/// The state at the end of equal steps. @param after  (y): called after each
template <typename T, typename After>
std::vector<T> ended(TreeMotion<T>& motion, const std::string& method, std::vector<T> y,
                     double duration, long steps, const After& after) {
  const auto stepper = stepsOf<T>(method, motion);
  const T h = T(duration) / T(steps);
  for (long k = 0; k < steps; ++k) {
    stepper->step(&y, k * h, h);
    after(y);
  }
  return y;
}
constexpr auto kNothing = [](const auto&) {};

constexpr long kFirstSteps = 16;
constexpr int kFewestDigits = 6;  // decimal places to which a reference is known
/* An observed order is within a tenth of its limit where no more than half of that is another
   error's and half the next power's. One part of rounding, or of the reference, in 30 of error
   moves it by log2(1 + 1/30) = 0.047. A next term, smaller by h^k, k >= 1, moves it by less than it
   has changed by at the last halving. */
constexpr double kAboveRounding = 30, kSettled = 0.05;

/// Steps halved until two ends are no nearer to each other than those before.
struct Converged {
  std::vector<Real> y;
  double change = std::numeric_limits<double>::infinity();
  long steps = 0;  ///< of y
};
Converged converge(const scene::Scene& scene, const std::string& method, double duration) {
  constexpr long kMostSteps = 1L << 17;
  TreeMotion<Real> motion(scene.mechanism);
  const std::vector<Real> start = startOf<Real>(scene);
  Converged best;
  std::vector<Real> before;
  for (long steps = kFirstSteps; steps <= kMostSteps; steps *= 2) {
    std::vector<Real> now;
    try {
      now = placed(scene.mechanism, ended(motion, method, start, duration, steps, kNothing));
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error&) {  // a step too long for an implicit method
      continue;
    }
    const double change =
        before.empty() ? std::numeric_limits<double>::infinity() : apart(now, before);
    before = now;
    // wild as long as the steps do not follow: there differences rise and fall
    if (best.change < std::pow(10, -kFewestDigits) && !(change < best.change)) break;
    if (change < best.change) best = {now, change, steps};
  }
  return best;
}

double secondsNow() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

WorkPoint measuredPoint(const scene::Scene& scene, TreeMotion<double>& motion,
                        const std::string& method, const ReferenceMotion& reference,
                        double duration, long steps) {
  constexpr int kMostRuns = 5;
  constexpr double kLongEnough = 0.02;  // [s]: a clock's tick is nothing beside it
  const std::vector<double> start = startOf<double>(scene);
  WorkPoint point;
  point.step = duration / static_cast<double>(steps);
  point.seconds = std::numeric_limits<double>::infinity();
  double begin = 0;
  try {
    std::vector<double> end;
    double spent = 0;
    for (int run = 0; run < kMostRuns && spent < kLongEnough * kMostRuns; ++run) {
      motion.calls = 0;
      begin = secondsNow();
      int times = 0;
      do {  // short ones many times, for the clock's sake
        end = ended(motion, method, start, duration, steps, kNothing);
        ++times;
      } while (secondsNow() - begin < kLongEnough);
      point.calls = motion.calls / times;
      const double took = secondsNow() - begin;
      point.seconds = std::min(point.seconds, took / times);
      spent += took;
    }
    point.error = apart(placed(scene.mechanism, end), reference.y);
    if (!std::isfinite(point.error)) {
      double time = 0;
      ended(motion, method, start, duration, steps, [&](const std::vector<double>& y) {
        if (std::all_of(y.begin(), y.end(), [](double x) { return std::isfinite(x); }))
          time += point.step;
      });
      point.failure = fmt::format("not finite after t = {:.3g} s", time);
      return point;
    }
    const double E_0 = motion.energy(start);
    double worst = 0;
    ended(motion, method, start, duration, steps, [&](const std::vector<double>& y) {
      keepWorse(&worst, std::abs(motion.energy(y) - E_0) / reference.most_kinetic);
    });
    point.energy_error = worst;
    if (!std::isfinite(worst)) point.failure = "energy is not finite on the way";
  } catch (const scene::InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    point.failure = error.what();
    if (!std::isfinite(point.seconds)) {  // the price of what does not arrive
      point.calls = motion.calls;
      point.seconds = secondsNow() - begin;
    }
  }
  return point;
}

/// What rounding does to the end: the same steps in long double. Infinity: it is not known.
double roundingOf(const scene::Scene& scene, const std::string& method, double duration,
                  long steps) {
  TreeMotion<double> rounded(scene.mechanism);
  TreeMotion<Real> exact(scene.mechanism);
  try {
    const auto there = placed(
        scene.mechanism, ended(exact, method, startOf<Real>(scene), duration, steps, kNothing));
    return apart(
        placed(scene.mechanism,
               ended(rounded, method, startOf<double>(scene), duration, steps, kNothing), there),
        there);
  } catch (const scene::InputError&) {
    throw;
  } catch (const std::runtime_error&) {  // an implicit step without a solution
    return std::numeric_limits<double>::infinity();
  }
}

/// Rounding adds up as the root of the number of steps, or faster: coarser steps have less of it.
ObservedOrder observedOrderOf(const scene::Scene& scene, const WorkLine& line,
                              const ReferenceMotion& reference, double duration) {
  const double step = line.points.back().step,
               finest = roundingOf(scene, line.method, duration, std::lround(duration / step));
  return observedOrder(line.points, [&](const WorkPoint& point) {
    return std::max(reference.error, finest * std::sqrt(step / point.step));
  });
}

/// Why a reference is none.
std::string disagreement(const char* first, const char* second, const Converged& one,
                         const Converged& other) {
  for (const auto& [method, run] : {std::pair{first, &one}, std::pair{second, &other}})
    if (run->y.empty())
      return fmt::format("{} in long double does not arrive with any step", method);
  double size = 0;
  for (const Real x : one.y) keepWorse(&size, static_cast<double>(std::abs(x)));
  const double gap = apart(one.y, other.y);
  return fmt::format("{} and {} in long double {}: they are {:.2g} apart", first, second,
                     agreementText(sharedDigits(gap, size)), gap);
}

}  // namespace

int ReferenceMotion::digits() const {
  return static_cast<int>(std::floor(-std::log10(std::max(error, 1e-20))));
}

ObservedOrder observedOrder(const std::vector<WorkPoint>& points,
                            const std::function<double(const WorkPoint&)>& floor) {
  const auto arrives = [&](std::size_t k) { return points[k].failure.empty(); };
  std::size_t end = points.size();  // after the finest step above the floor
  while (end > 0 &&
         !(arrives(end - 1) && points[end - 1].error > kAboveRounding * floor(points[end - 1])))
    --end;
  std::size_t first = end;
  while (first > 0 && arrives(first - 1)) --first;
  if (end - first < 3) {
    std::string why = fmt::format(
        "of its steps {} in a row arrive with an error above {:.0f} times that of rounding and "
        "reference, and three have to",
        end - first, kAboveRounding);
    if (first > 0)
      why += fmt::format("; the next longer, {:.2g} s, fails: {}", points[first - 1].step,
                         points[first - 1].failure);
    return {0, why};
  }
  const auto between = [&](std::size_t k) {
    return std::log(points[k - 1].error / points[k].error) /
           std::log(points[k - 1].step / points[k].step);
  };
  const double order = between(end - 1), before = between(end - 2);
  if (order > 0 && std::abs(order - before) <= kSettled) return {order, ""};
  return {0,
          fmt::format("{:.2f}, then {:.2f} at the finest steps above rounding and reference: not "
                      "settled to {}",
                      before, order, kSettled)};
}

ReferenceMotion referenceMotion(const scene::Scene& scene, double duration) {
  ReferenceMotion out;
  TreeMotion<Real> motion(scene.mechanism);
  const bool canonical = motion.hasMomenta();
  const char* first = "runge_kutta_fehlberg78";
  const char* second = canonical ? "gauss_6" : "bulirsch_stoer8";
  const Converged one = converge(scene, first, duration), other = converge(scene, second, duration);
  out.error = one.y.empty() || other.y.empty() ? std::numeric_limits<double>::infinity()
                                               : apart(one.y, other.y);
  if (!(out.digits() >= kFewestDigits))
    throw std::runtime_error(fmt::format(
        "no reference: after {} s {}; {} decimal places are needed, allowed: a shorter --duration",
        duration, disagreement(first, second, one, other), kFewestDigits));
  out.y = one.y;
  out.by = fmt::format("{} and {}{} in long double", first, second,
                       canonical ? " of Hamilton's equations" : "");
  ended(motion, first, startOf<Real>(scene), duration, one.steps, [&](const std::vector<Real>& y) {
    keepWorse(&out.most_kinetic, static_cast<double>(motion.kinetic(y)));
  });
  if (const auto exact = ellipticPendulum(scene, duration))
    out.elliptic_error = apart(*exact, out.y);
  return out;
}

std::optional<std::vector<long double>> ellipticPendulum(const scene::Scene& scene, double time) {
  TreeMotion<Real> motion(scene.mechanism);
  const std::vector<Real> start = startOf<Real>(scene);
  const auto moving = scene.mechanism.movingLinks();
  if (motion.dof() != 1 || !motion.hasMomenta() || scene.mechanism.hasFriction() ||
      scene.mechanism.links[moving.front()].joint.kind != scene::JointKind::kRevolute)
    return std::nullopt;
  // g = -dL/dq at rest; a pendulum's is k sin(q - q_0), and then k^2 = g(0)^2 + g(pi/2)^2
  const Real quarter = std::acos(Real(0)), eps = std::numeric_limits<Real>::epsilon();
  const auto g = [&](Real q) { return -motion.pull({q, 0, 0})[0]; };
  const Real sine = g(quarter), cosine = g(0), k = std::hypot(sine, cosine),
             lowest = std::atan2(-cosine, sine), M = motion.momentum({0, 1, 0})[0];
  if (!(k > 0) || !(M > 0)) return std::nullopt;
  for (const Real q : {Real(1), Real(2), Real(4)})  // springs would be felt there
    if (!(std::abs(g(q) - k * std::sin(q - lowest)) <= 64 * eps * k)) return std::nullopt;
  // whole turns are kept: it swings about the lowest point that is next to its start
  const Real turn = 4 * quarter, q_0 = lowest + turn * std::round((start[0] - lowest) / turn);
  const Real w = std::sqrt(k / M), s = std::sin((start[0] - q_0) / 2), v = start[1] / (2 * w),
             modulus = std::hypot(s, v);
  if (!(modulus > 0) || !(modulus < 1)) return std::nullopt;
  // sin((q - q_0) / 2) = m sn(u), qd = 2 w m cn(u), u = u_0 + w t
  const Real u = boost::math::ellint_1(modulus, std::atan2(s, v)) + w * time;
  Real cn, dn;
  const Real sn = boost::math::jacobi_elliptic(modulus, u, &cn, &dn);
  return std::vector<Real>{q_0 + 2 * std::asin(modulus * sn), 2 * w * modulus * cn};
}

WorkPrecision measureWork(const scene::Scene& scene, const WorkOptions& options) {
  constexpr long kMostSteps = 1L << 22;
  requireTreated(scene, Command::kDrift);
  std::vector<std::string> methods;
  for (const std::string& method : options.methods)
    if (std::find(methods.begin(), methods.end(), method) == methods.end())
      methods.push_back(method);
  if (methods.empty())
    for (const Integrator& method : integrators()) methods.emplace_back(method.name);
  for (const std::string& method : methods) integratorNamed(method);
  WorkPrecision out;
  out.scene = scene.name;
  out.title = scene.title;
  out.duration = options.duration;
  if (options.progress) options.progress("reference");
  out.reference = referenceMotion(scene, options.duration);
  TreeMotion<double> motion(scene.mechanism);
  for (const std::string& method : methods) {
    if (options.progress) options.progress(method);
    WorkLine line;
    line.method = method;
    line.order = integratorNamed(method).order;
    if (integratorNamed(method).needs_momenta && !motion.hasMomenta()) {
      line.left_out = "knows only joints whose rates are derivatives of their positions";
      out.lines.push_back(line);
      continue;
    }
    for (long steps = kFirstSteps; steps <= kMostSteps; steps *= 2) {
      line.points.push_back(
          measuredPoint(scene, motion, method, out.reference, options.duration, steps));
      const WorkPoint& point = line.points.back();
      const bool ended_well = point.failure.empty();
      if (ended_well && point.error <= out.reference.error) break;
      if (ended_well && 2 * point.seconds > options.longest_run) break;
      // errors rise where steps do not follow yet, and where most of them is rounding
      const auto size = line.points.size();
      if (size > 2 && ended_well && line.points[size - 2].failure.empty() &&
          point.error > line.points[size - 2].error &&
          point.error < 2 * roundingOf(scene, method, options.duration, steps))
        break;
    }
    const ObservedOrder order = observedOrderOf(scene, line, out.reference, options.duration);
    line.observed_order = order.value;
    line.no_order = order.why_not;
    out.lines.push_back(line);
  }
  return out;
}

double convergedOrder(const scene::Scene& scene, const std::string& method, double duration) {
  constexpr long kMostSteps = 1L << 14;
  const ReferenceMotion reference = referenceMotion(scene, duration);
  TreeMotion<Real> motion(scene.mechanism);
  const std::vector<Real> start = startOf<Real>(scene);
  double order = 0, before = 0;
  for (long steps = kFirstSteps; steps <= kMostSteps; steps *= 2) {
    double error = 0;
    try {
      error =
          apart(placed(scene.mechanism, ended(motion, method, start, duration, steps, kNothing)),
                reference.y);
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error&) {  // a step too long for an implicit method
      continue;
    }
    if (!std::isfinite(error)) continue;
    if (!(error > kAboveRounding * reference.error)) break;
    const double now = before > 0 ? std::log2(before / error) : 0;
    const bool settled = order > 0 && std::abs(now - order) <= kSettled;
    before = error;
    order = now;
    if (settled) return order;
  }
  return 0;
}

}  // namespace dynwitness::crosscheck
