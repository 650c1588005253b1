// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/step_advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/tree_motion.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
using Vector = std::vector<double>;
using Complex = std::complex<double>;
constexpr double kAny = std::numeric_limits<double>::infinity();

std::vector<Complex> eigenvaluesAt(TreeMotion<double>& motion, const Vector& y, double time) {
  const auto columns = columnsOfJacobian(motion, y, time);
  const auto size = static_cast<Eigen::Index>(y.size()) - 1;  // work feeds nothing back
  Eigen::MatrixXd J(size, size);
  for (Eigen::Index j = 0; j < size; ++j)
    for (Eigen::Index i = 0; i < size; ++i) J(i, j) = columns[j][i];
  std::vector<Complex> out;
  if (!J.allFinite())
    throw std::runtime_error(
        fmt::format("df/dy is not finite at t = {:.3g} s of the motion: no step can be advised, "
                    "allowed: a shorter --duration",
                    time));
  const double least = std::cbrt(std::numeric_limits<double>::epsilon());  // of differences
  const Eigen::VectorXcd all = J.eigenvalues();
  const double largest = all.cwiseAbs().maxCoeff();
  for (const Complex& lambda : all)
    if (lambda.imag() >= 0 && std::abs(lambda) > least * largest) out.push_back(lambda);
  return out;
}

/// Without the growth that is the motion's own.
Complex settled(const Complex& lambda) {
  return {std::min(lambda.real(), 0.0), lambda.imag()};
}

/// log |R(h lambda)|, zero where rounding is all that it grows by.
double growth(const std::string& method, const Complex& lambda, double h) {
  const Complex z = h * settled(lambda);
  if (z == Complex(0)) return 0;
  const double size = amplification(method, z.real(), z.imag());
  return size > 1 + 1e-12 ? std::log(size) : 0;
}

struct Growth {
  double all = 0, most = 0;  ///< along the motion; in one step
  Complex lambda;
  double time = 0;
};
Growth growthAlong(const SpectrumAlong& spectrum, const std::string& method, double h) {
  Growth out;
  for (const SpectrumAlong::Moment& moment : spectrum.moments) {
    double here = 0;
    for (const Complex& lambda : moment.fastest) {
      const double now = growth(method, lambda, h);
      here = std::max(here, now);
      if (now > out.most) out = {out.all, now, lambda, moment.time};
    }
    out.all += here * moment.duration / h;
  }
  return out;
}

bool growsAlong(const SpectrumAlong& spectrum, const std::string& method, double h) {
  return !(2 * growthAlong(spectrum, method, h).all <= std::log(2.0));
}

/// Whether a method leaves the motion by what it gains, at steps far below its eigenvalues' limits.
bool leavesMotion(const Integrator& method) {
  return !method.remembers &&
         (method.imaginary_limit == 0 || method.symplectic == Symplectic::kWhereMIsConstant);
}

double durationOf(const SpectrumAlong& spectrum) {
  return spectrum.moments.back().time + spectrum.moments.back().duration;
}
double fastestOf(const SpectrumAlong& spectrum) {
  double fastest = 0;
  for (const auto& moment : spectrum.moments)
    for (const Complex& lambda : moment.fastest) fastest = std::max(fastest, std::abs(lambda));
  return fastest;
}

}  // namespace

SpectrumAlong spectrumAlong(const scene::Scene& scene, double duration) {
  constexpr int kMoments = 200;
  constexpr double kStepError = 1e-8;
  constexpr int kMostSteps = 1000000;
  // The energy of an oscillation swings at twice its angle: half a radian apart a period of it has
  // 2 pi states, and sums over states apart equally are the integrals of its harmonics up to the
  // fifth. More than 20 a moment, 4000 in all, are not kept: then what is fastest is undersampled,
  // and the spectrum, which needs no samples within a period, decides.
  constexpr double kRadians = 0.5, kMostParts = 20;
  TreeMotion<double> motion(scene.mechanism);
  Vector y = startOf<double>(scene);
  const auto rate = [&](const Vector& at, Vector& out, double t) { motion.rate(at, t, &out); };
  auto stepper =
      odeint::make_controlled(kStepError, kStepError, odeint::runge_kutta_dopri5<Vector>());
  SpectrumAlong out;
  out.most_kinetic = motion.kinetic(y);
  double time = 0, step = duration / kMoments / 10;
  int steps = 0;
  const auto follow = [&](double next) {
    while (time < next) {
      if (++steps > kMostSteps)
        throw std::runtime_error(
            fmt::format("{} steps that adapt and only {:.3g} of {:.3g} s done: no step can be "
                        "advised, allowed: a shorter --duration",
                        kMostSteps, time, duration));
      double h = std::min(step, next - time);
      const bool cut = h < step;
      const bool taken = stepper.try_step(rate, y, time, h) == odeint::success;
      if (!cut || !taken) step = h;
      if (taken) keepWorse(&out.most_kinetic, motion.kinetic(y));
      if (next - time <= next * std::numeric_limits<double>::epsilon()) time = next;
    }
  };
  const double each = duration / kMoments;
  int parts = 0;  // of a moment, by the eigenvalues of the start
  for (int k = 0; k < kMoments; ++k) {
    const double here = each * k;
    out.moments.push_back({here, each, eigenvaluesAt(motion, y, here)});
    if (parts == 0)
      parts = static_cast<int>(
          std::clamp(std::ceil(each * fastestOf(out) / kRadians), 1.0, kMostParts));
    for (int part = 0; part < parts; ++part) {
      out.along.states.push_back(y);
      follow(here + each * (part + 1) / parts);
    }
  }
  out.along.apart = each / parts;
  return out;
}

double stabilityLimit(const std::string& method, Complex lambda) {
  constexpr double kFarthest = 1e6, kFiner = 1.05, kNearest = 1e-3;
  const Complex direction = settled(lambda) / std::abs(settled(lambda));
  if (!(std::abs(settled(lambda)) > 0)) return kAny;
  double held = 0;
  for (double r = kNearest; r < kFarthest; r *= kFiner) {
    if (growth(method, direction, r) == 0) {
      held = r;
      continue;
    }
    if (held == 0) return 0;
    double broken = r;
    for (int k = 0; k < 40; ++k) {
      const double middle = (held + broken) / 2;
      (growth(method, direction, middle) == 0 ? held : broken) = middle;
    }
    return held;
  }
  return kAny;
}

StableStep largestStableStep(const scene::Scene& scene, const SpectrumAlong& spectrum,
                             const std::string& method) {
  const double duration = durationOf(spectrum), fastest = fastestOf(spectrum);
  StableStep out;
  const Integrator& known = integratorNamed(method);
  if (fastest == 0) {
    out.step = kAny;
    return out;
  }
  TreeMotion<double> motion(scene.mechanism);
  const bool has_region = known.imaginary_limit > 0 || known.remembers,
             is_limited = !isAStable(known);
  const double enough = spectrum.most_kinetic;
  const auto grows = [&](double h) {
    return has_region && is_limited && growsAlong(spectrum, method, h);
  };
  const auto gain = [&](double h) -> StepGain {
    if (known.remembers) return {};
    if (!leavesMotion(known)) return gainAlong(motion, spectrum.along, method, h, enough);
    return gainOfModified(motion, spectrum.along.states.front(), method, duration, h, enough);
  };
  const auto doubles = [&](double h) { return grows(h) || gain(h).gained > enough; };
  // from below: regions of stability may have islands beyond their first border; what a modified
  // equation gains rises with h, and costs more to ask
  const double kFiner = leavesMotion(known) ? 2 : 1.1;
  double held = 0, broken = 0, h = 0;
  for (const double share : {0.05, 1e-3, 1e-8}) {
    h = std::min(share / fastest, duration);
    if (!doubles(h)) break;
  }
  for (; h <= duration && broken == 0; h *= kFiner) (doubles(h) ? broken : held) = h;
  if (broken == 0) {
    out.step = kAny;
    return out;
  }
  // two digits are told: from a factor of 2 on, 7 leave 2^-7 of h (0.8 %), where each is a run of
  // the modified equation; from a tenth on, 30 leave 1e-10
  const int bisections = leavesMotion(known) ? 7 : 30;
  for (int k = 0; k < bisections; ++k) {
    const double middle = (held + broken) / 2;
    (doubles(middle) ? broken : held) = middle;
  }
  const Growth there = growthAlong(spectrum, method, broken);
  out.step = held;
  out.by_spectrum = grows(broken);
  out.is_unsolved = !out.by_spectrum && gain(broken).is_unsolved;
  out.lambda = there.lambda;
  out.time = there.time;
  out.limit = stabilityLimit(method, there.lambda);
  return out;
}

StepAdvice adviseStep(const scene::Scene& scene, const SpectrumAlong& spectrum,
                      const std::string& method) {
  StepAdvice out;
  out.predicted = largestStableStep(scene, spectrum, method);
  const double duration = durationOf(spectrum), fastest = fastestOf(spectrum);
  const double first = std::isfinite(out.predicted.step) ? out.predicted.step
                       : fastest > 0                     ? 1 / fastest
                                                         : duration;
  out.tried = largestStepTried(scene, method, duration, first, spectrum.most_kinetic);
  return out;
}

std::string roundedDown(double h, int digits) {
  if (!(h > 0) || std::isinf(h)) return fmt::format("{}", h);
  const double unit = std::pow(10, std::floor(std::log10(h)) + 1 - digits);
  return fmt::format("{:.{}g}", std::floor(h / unit) * unit, digits);
}

std::string lossText(const TriedStep& tried) {
  return tried.is_unsolved ? "no solution of an implicit step is found" : "runs gain energy";
}

namespace {

/// "0.04 s (measured; predicted 0.041 s)"
std::string allowedText(const StepAdvice& advice) {
  const double predicted = advice.predicted.step, tried = advice.tried.step;
  const std::string before = std::isinf(predicted) ? "any" : roundedDown(predicted, 2) + " s";
  if (tried == 0) return fmt::format("{} (predicted; no run holds)", before);
  return fmt::format("{} (measured; predicted {})",
                     std::isinf(tried) ? "any" : roundedDown(tried, 2) + " s", before);
}

/// ", or implicit_midpoint with h = 0.05 s (measured)" where a run of it holds.
std::string alternativeText(const scene::Scene& scene, const std::string& method, double duration,
                            double step, double most_kinetic) {
  const char* const other = "implicit_midpoint";
  if (method == other || !runWithStep(scene, other, duration, step, most_kinetic).holds())
    return "";
  return fmt::format(", or {} with h = {:.3g} s (measured)", other, step);
}

}  // namespace

std::string adviceAfterFailure(const scene::Scene& scene, const std::string& method,
                               double duration, double step, double when) {
  const std::string what =
      when < 0
          ? "the motion left the numbers"
          : fmt::format("energy error reached half of the largest kinetic energy at t = {:.3g} s",
                        when);
  SpectrumAlong spectrum;
  try {
    spectrum = spectrumAlong(scene, duration);
  } catch (const scene::InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    return fmt::format("{}: {}", what, error.what());
  }
  const StepAdvice advice = adviseStep(scene, spectrum, method);
  const StableStep& predicted = advice.predicted;
  const std::string allowed = allowedText(advice);
  if (step <= predicted.step && step <= advice.tried.step)
    return fmt::format(
        "{}: {} with h = {:.3g} s is too coarse here, not unstable{}: allowed: shorter steps", what,
        method, step,
        std::isinf(advice.tried.step) ? std::string() : " (stability would allow " + allowed + ")");
  const std::string other = alternativeText(scene, method, duration, step, spectrum.most_kinetic);
  if (step <= predicted.step)
    return fmt::format(
        "{}: {} with h = {:.3g} s does not hold here, which its spectrum does not show ({}): h <= {}{}",
        what, method, step, lossText(advice.tried), allowed, other);
  if (!predicted.by_spectrum)
    return fmt::format(
        "{}: {} with h = {:.3g} s is unstable here ({}): h <= {}{}", what, method, step,
        predicted.is_unsolved ? "from a state of the motion such a step has no solution"
                              : "single steps along the motion add to its energy",
        allowed, other);
  const Growth there = growthAlong(spectrum, method, step);
  return fmt::format(
      "{}: {} with h = {:.3g} s is unstable here (h |lambda| = {:.3g} at t = {:.3g} s, limit "
      "{:.3g}): h <= {}{}",
      what, method, step, step * std::abs(there.lambda), there.time,
      stabilityLimit(method, there.lambda), allowed, other);
}

}  // namespace dynwitness::crosscheck
