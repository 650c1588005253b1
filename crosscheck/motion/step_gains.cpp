// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/step_gains.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
using Vector = std::vector<double>;
constexpr double kAny = std::numeric_limits<double>::infinity();

}  // namespace

bool isAStable(const Integrator& method) {
  return std::isinf(method.imaginary_limit) && std::isinf(method.real_limit);
}

StepGain gainAlong(TreeMotion<double>& motion, const StatesAlong& along, const std::string& method,
                   double h, double enough) {
  const bool is_symmetric = integratorNamed(method).symplectic == Symplectic::kYes;
  // an implicit one goes on from its last step's solution as a first guess, as a run does; others
  // may keep a slope, which is not that of the next state
  const bool keeps = isAStable(integratorNamed(method));
  const auto forward = stepsOf<double>(method, motion), back = stepsOf<double>(method, motion);
  const auto energyAfter = [&](Steps<double>& steps, Vector y, double step) {
    if (!keeps) steps.forget();
    steps.step(&y, 0, step);
    return motion.energy(y);
  };
  const auto every = std::max<std::size_t>(1, std::lround(h / along.apart));
  double sum = 0;
  StepGain out;
  for (std::size_t k = 0; k < along.states.size(); k += every) {
    const Vector& state = along.states[k];
    double gained = 0;
    try {
      gained = is_symmetric ? (energyAfter(*forward, state, h) - energyAfter(*back, state, -h)) / 2
                            : energyAfter(*forward, state, h) - motion.energy(state);
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error&) {
      return {kAny, true};
    }
    sum += gained * along.apart * static_cast<double>(every) / h;
    out.gained = std::isfinite(sum) ? std::max(out.gained, sum) : kAny;
    if (out.gained > enough) break;
  }
  return out;
}

StepGain gainOfModified(TreeMotion<double>& motion, const Vector& start, const std::string& method,
                        double duration, double h, double enough) {
  constexpr double kStepError = 1e-4;  // of the state a step, beside gains as large as all energy
  constexpr int kMostSteps = 1 << 16;
  const auto step = stepsOf<double>(method, motion),
             exact = stepsOf<double>("runge_kutta_dopri5", motion);
  const auto beside = [&](const Vector& y, double time) {
    Vector d = y;
    exact->step(&d, time, -h / 2);
    step->step(&d, time - h / 2, h);
    exact->forget();  // it keeps the slope at the end of its last step
    exact->step(&d, time + h / 2, -h / 2);
    exact->forget();
    for (std::size_t i = 0; i < y.size(); ++i) d[i] -= y[i];
    return d;
  };
  const auto rate = [&](const Vector& y, Vector& out, double time) {
    motion.rate(y, time, &out);
    const Vector d = beside(y, time);
    Vector moved = y;
    for (std::size_t i = 0; i < y.size(); ++i) moved[i] += d[i];
    const Vector again = beside(moved, time);
    for (std::size_t i = 0; i < y.size(); ++i) out[i] += (3 * d[i] - again[i]) / (2 * h);
  };
  auto stepper =
      odeint::make_controlled(kStepError, kStepError, odeint::runge_kutta_dopri5<Vector>());
  const double E_0 = motion.energy(start);
  Vector y = start;
  StepGain out;
  double time = 0, next = std::min(h, duration);
  for (int k = 0; k < kMostSteps && time < duration && out.gained <= enough; ++k) {
    next = std::min(next, duration - time);
    if (stepper.try_step(rate, y, time, next) != odeint::success) {
      if (!(next > duration * std::numeric_limits<double>::epsilon())) return {kAny, false};
      continue;
    }
    const double gained = motion.energy(y) - E_0;
    out.gained = std::isfinite(gained) ? std::max(out.gained, gained) : kAny;
  }
  if (time < duration && out.gained <= enough) return {kAny, false};  // not followed to its end
  return out;
}

}  // namespace dynwitness::crosscheck
