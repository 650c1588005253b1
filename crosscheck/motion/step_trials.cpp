// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/step_trials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/tree_motion.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr long kMostSteps = 1L << 21, kMostForEnd = 1L << 19;

/// A method's ends of one motion, and what they cost.
class Ends {
 public:
  Ends(const scene::Scene& scene, std::string method, double duration)
      : scene_(scene), method_(std::move(method)), duration_(duration), motion_(scene.mechanism) {}

  /// As placed() has it; empty: an implicit step has no solution.
  std::vector<long double> after(long steps, const std::vector<long double>& like) {
    std::vector<double> y = startOf<double>(scene_);
    const auto stepper = stepsOf<double>(method_, motion_);
    const double h = duration_ / static_cast<double>(steps);
    const long before = motion_.calls;
    bool is_solved = true;
    try {
      for (long k = 0; k < steps; ++k) stepper->step(&y, static_cast<double>(k) * h, h);
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error&) {
      is_solved = false;
    }
    calls_of_last = motion_.calls - before;
    if (!is_solved) return {};
    return placed(scene_.mechanism, y, like);
  }
  /// Infinity: it does not arrive.
  double error(long steps, const KnownEnd& end) {
    const std::vector<long double> there = after(steps, end.y);
    if (there.empty()) return kAny;
    const auto gap = static_cast<double>(largestGap(there, end.y, there.size()));
    return std::isfinite(gap) ? gap : kAny;
  }
  long calls() const { return motion_.calls; }

  long calls_of_last = 0;

 private:
  const scene::Scene& scene_;
  std::string method_;
  double duration_;
  TreeMotion<double> motion_;
};

long scaled(long steps, double by) {
  return static_cast<long>(std::ceil(static_cast<double>(steps) * by));
}

}  // namespace

StepRun runWithStep(const scene::Scene& scene, const std::string& method, double duration,
                    double step, double most_kinetic) {
  TreeMotion<double> motion(scene.mechanism);
  std::vector<double> y = startOf<double>(scene);
  const double E_0 = motion.energy(y), scale = most_kinetic > 0 ? most_kinetic : 1;
  const long steps = std::max(1L, std::lround(duration / step));
  const auto stepper = stepsOf<double>(method, motion);
  StepRun out;
  motion.calls = 0;
  try {
    for (long k = 0; k < steps && out.gained < kAny; ++k) {
      stepper->step(&y, static_cast<double>(k) * step, step);
      const double gained = (motion.energy(y) - E_0) / scale;
      out.gained = std::isfinite(gained) ? std::max(out.gained, gained) : kAny;
    }
  } catch (const scene::InputError&) {
    throw;
  } catch (const std::runtime_error&) {
    out.gained = kAny;
    out.is_unsolved = true;
  }
  out.calls = motion.calls;
  return out;
}

TriedStep largestStepTried(const scene::Scene& scene, const std::string& method, double duration,
                           double first, double most_kinetic) {
  constexpr double kGrowth = 1.05;
  constexpr int kInARow = 6, kBisections = 2;
  TriedStep out;
  const auto holds = [&](double h) {
    const StepRun run = runWithStep(scene, method, duration, h, most_kinetic);
    ++out.runs;
    out.calls += run.calls;
    if (!run.holds()) out.beyond = h, out.is_unsolved = run.is_unsolved;
    return run.holds();
  };
  double start = std::min(first, duration) / 2;
  for (;; start /= 2) {
    if (duration / start > static_cast<double>(kMostSteps)) return out;
    const double known_to_fail = out.beyond > 0 ? out.beyond : kAny;
    int in_a_row = 0;
    for (double h = start; h <= duration && h < known_to_fail && holds(h); h *= kGrowth) {
      out.step = h;
      ++in_a_row;
    }
    if (in_a_row >= kInARow) break;
    out.step = 0;
  }
  if (out.beyond == 0) {
    out.step = kAny;
    return out;
  }
  for (int k = 0; k < kBisections; ++k)
    if (const double middle = (out.step + out.beyond) / 2; holds(middle)) out.step = middle;
  return out;
}

KnownEnd knownEnd(const scene::Scene& scene, double duration, double accuracy) {
  constexpr long kFewest = 64, kMost = 1L << 16;
  constexpr double kFiner = 10;
  using Real = long double;  // a wild motion makes much of a double's rounding
  TreeMotion<Real> motion(scene.mechanism);
  KnownEnd out;
  for (long steps = kFewest; steps <= kMost; steps *= 2) {
    std::vector<Real> y = startOf<Real>(scene);
    const auto stepper = stepsOf<Real>("runge_kutta_fehlberg78", motion);
    const Real h = Real(duration) / static_cast<Real>(steps);
    for (long k = 0; k < steps; ++k) stepper->step(&y, static_cast<Real>(k) * h, h);
    const std::vector<Real> now = placed(scene.mechanism, y, out.y);
    const bool is_first = out.y.empty();
    if (!is_first) out.error = static_cast<double>(largestGap(now, out.y, now.size()));
    out.y = now;
    if (!is_first && out.error < accuracy / kFiner) return out;
  }
  throw std::runtime_error(
      fmt::format("the end of {} s is not known to {:.3g}: {} and {} steps of "
                  "runge_kutta_fehlberg78 differ by {:.3g}, allowed: a shorter --duration or a "
                  "larger --advise",
                  duration, accuracy / kFiner, kMost / 2, kMost, out.error));
}

AccurateStep accurateStep(const scene::Scene& scene, const std::string& method, double duration,
                          double accuracy, double largest, const KnownEnd& end) {
  constexpr double kTenth = 1.1, kQuarter = 1.25, kSurely = 1.02, kMostAtOnce = 64;
  const double order = integratorNamed(method).order;
  Ends ends(scene, method, duration);
  AccurateStep out;
  const auto found = [&](long steps, double calls) {
    out.step = std::min(duration / static_cast<double>(steps), largest);
    out.calls = calls;
  };
  long short_of = 0,
       steps = std::max(1L, static_cast<long>(std::ceil(duration / std::min(largest, duration))));
  while (true) {
    const double error = ends.error(steps, end);
    const long calls = ends.calls_of_last;
    if (error <= accuracy && ends.error(scaled(steps, kQuarter), end) <= accuracy) {
      found(steps, static_cast<double>(calls));
      break;
    }
    short_of = steps;
    // far from its order an error says nothing: one doubling at a time
    const double wanted = kSurely * std::pow(error / accuracy, 1 / order);
    const long next = scaled(steps, error < 1 ? std::clamp(wanted, kTenth, kMostAtOnce) : 2.0);
    if (next > kMostForEnd) {
      if (error < 1) {
        out.is_predicted = true;
        found(scaled(steps, wanted), static_cast<double>(calls) * wanted);
      } else {
        out.why = fmt::format("its error is {:.3g} with {} steps", error, steps);
      }
      break;
    }
    steps = next;
  }
  while (!out.is_predicted && out.why.empty() && short_of > 0 &&
         static_cast<double>(steps) > kTenth * static_cast<double>(short_of)) {
    const long middle =
        std::lround(std::sqrt(static_cast<double>(steps) * static_cast<double>(short_of)));
    if (middle == steps || middle == short_of) break;
    if (ends.error(middle, end) <= accuracy) {
      steps = middle;
      found(steps, static_cast<double>(ends.calls_of_last));
    } else {
      short_of = middle;
    }
  }
  out.tried_calls = ends.calls();
  return out;
}

}  // namespace dynwitness::crosscheck
