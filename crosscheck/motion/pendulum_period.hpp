// SPDX-License-Identifier: GPL-3.0-or-later
// The period of a one-joint pendulum, by simulation.
#pragma once

#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/** T / T_0 of the oscillation that starts at rest at angle q_0 [rad], 0 < q_0 < pi, about the
    hanging position q = 0: twice the time until qd is zero again, over
    T_0 = 2 pi sqrt(M / g(pi/2)), the period of small oscillations of a body whose gravity torque is
    g(pi/2) sin q. Integrated by the Runge-Kutta-Fehlberg 7(8) steps of Boost.odeint, T_0 / steps
    each.
    @throws std::invalid_argument when the mechanism has not exactly one joint */
double pendulumPeriodRatio(const scene::Mechanism& mechanism, double q_0, int steps);

}  // namespace dynwitness::crosscheck
