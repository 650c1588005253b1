// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/pendulum_period.hpp"

#include <cmath>
#include <functional>
#include <stdexcept>

#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {

double pendulumPeriodRatio(const scene::Mechanism& mechanism, double q_0, int steps) {
  // near the upright position rounding grows as fast as the motion: 64-bit mantissas keep it away
  using Real = long double;
  using Vector = std::vector<Real>;  // (q, qd)
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<Real>(mechanism));
  if (model.dof() != 1)
    throw std::invalid_argument("pendulumPeriodRatio: mechanism: expected 1 joint, got " +
                                std::to_string(model.dof()));
  recursive::Workspace<Real> ws(model);
  Vector qdd(1);
  const Vector at_rest(1, 0);

  const auto motion = [&](const Vector& y, Vector& rate, Real) {
    recursive::forwardDynamics(model, {scene::jointPosition(y[0])}, {y[1]}, at_rest, ws, qdd);
    rate[0] = y[1];
    rate[1] = qdd[0];
  };
  Vector g_at_right_angle(1), M(1);
  const Real quarter_turn = std::acos(Real(0));
  const std::vector<scene::JointPosition<Real>> right_angle = {{quarter_turn, 0, 1}};
  recursive::inverseDynamics(model, right_angle, at_rest, at_rest, ws, g_at_right_angle,
                             recursive::Terms::potential());
  recursive::inverseDynamics(model, right_angle, at_rest, {Real(1)}, ws, M,
                             recursive::Terms::none());
  const Real T_0 = 4 * quarter_turn * std::sqrt(M[0] / g_at_right_angle[0]);

  // step until the velocity turns, then bisect the length of the last step
  boost::numeric::odeint::runge_kutta_fehlberg78<Vector, Real> stepper;
  const Real step = T_0 / steps;
  Vector y = {q_0, 0}, next = y;
  Real t = 0;
  for (;; t += step, y = next) {
    next = y;
    stepper.do_step(std::ref(motion), next, t, step);
    if (next[1] > 0) break;  // it starts downwards, qd < 0
    if (t > 100 * T_0) throw std::invalid_argument("pendulumPeriodRatio: no oscillation");
  }
  Real low = 0, high = step;
  for (int k = 0; k < 64; ++k) {
    const Real middle = (low + high) / 2;
    next = y;
    stepper.do_step(std::ref(motion), next, t, middle);
    (next[1] > 0 ? high : low) = middle;
  }
  return static_cast<double>(2 * (t + low) / T_0);
}

}  // namespace dynwitness::crosscheck
