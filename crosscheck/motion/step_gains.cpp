// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/step_gains.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "crosscheck/motion/integrators.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
using Vector = std::vector<double>;
constexpr double kAny = std::numeric_limits<double>::infinity();

}  // namespace

StepGain gainAlong(TreeMotion<double>& motion, const StatesAlong& along, const std::string& method,
                   double h, double enough) {
  const bool is_symmetric = integratorNamed(method).symplectic == Symplectic::kYes;
  const auto stepper = stepsOf<double>(method, motion);
  const auto energyAfter = [&](Vector y, double step) {
    stepper->forget();
    stepper->step(&y, 0, step);
    return motion.energy(y);
  };
  double sum = 0;
  StepGain out;
  for (const Vector& state : along.states) {
    double gained = 0;
    try {
      gained = is_symmetric ? (energyAfter(state, h) - energyAfter(state, -h)) / 2
                            : energyAfter(state, h) - motion.energy(state);
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error&) {
      return {kAny, true};
    }
    sum += gained * along.apart / h;
    out.gained = std::isfinite(sum) ? std::max(out.gained, sum) : kAny;
    if (out.gained > enough) break;
  }
  return out;
}

StepGain gainOfModified(TreeMotion<double>& motion, const Vector& start, const std::string& method,
                        double duration, double h, double enough) {
  constexpr double kStepError = 1e-5;  // of a gain that is compared with all of the energy
  constexpr int kMostSteps = 1 << 16;
  const auto step = stepsOf<double>(method, motion),
             exact = stepsOf<double>("runge_kutta_fehlberg78", motion);
  const auto rate = [&](const Vector& y, Vector& out, double time) {
    Vector again = y;
    motion.rate(y, time, &out);
    exact->step(&again, time, -h);
    step->step(&again, time - h, h);
    for (std::size_t i = 0; i < y.size(); ++i) out[i] += (again[i] - y[i]) / h;
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
  return out;
}

}  // namespace dynwitness::crosscheck
