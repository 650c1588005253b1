# SPDX-License-Identifier: Apache-2.0
"""The double pendulum of data/scenes/double_pendulum.toml, by hand: two uniform rods, q2 relative."""
from math import cos, sin

import dynwitness_engine

g0, m1, m2, l1, l2 = 9.81, 1.0, 0.8, 0.5, 0.4
r1, r2 = l1 / 2, l2 / 2                            # to the centres of mass
I1, I2 = m1 * l1 * l1 / 12, m2 * l2 * l2 / 12      # about them


def M(q):
    m12 = I2 + m2 * (r2 * r2 + l1 * r2 * cos(q[1]))
    m22 = I2 + m2 * r2 * r2
    return [[I1 + m1 * r1 * r1 + m2 * l1 * l1 + m22 + 2 * m2 * l1 * r2 * cos(q[1]), m12], [m12, m22]]


def c(q, qd):
    h = m2 * l1 * r2 * sin(q[1])
    return [-h * (2 * qd[0] + qd[1]) * qd[1], h * qd[0] * qd[0]]


def g(q):
    g2 = m2 * r2 * g0 * sin(q[0] + q[1])
    return [(m1 * r1 + m2 * l1) * g0 * sin(q[0]) + g2, g2]


def tau(q, qd, qdd):
    (m11, m12), (_, m22) = M(q)
    bias = [a + b for a, b in zip(c(q, qd), g(q))]
    return [m11 * qdd[0] + m12 * qdd[1] + bias[0], m12 * qdd[0] + m22 * qdd[1] + bias[1]]


def qdd(q, qd, tau):
    (m11, m12), (_, m22) = M(q)
    b1, b2 = [t - a - b for t, a, b in zip(tau, c(q, qd), g(q))]
    det = m11 * m22 - m12 * m12
    return [(m22 * b1 - m12 * b2) / det, (m11 * b2 - m12 * b1) / det]


def potential(q):
    return -(m1 * r1 + m2 * l1) * g0 * cos(q[0]) - m2 * r2 * g0 * cos(q[0] + q[1])


dynwitness_engine.testify(
    lambda scene: {"M": M, "c": c, "g": g, "tau": tau, "qdd": qdd, "potential": potential},
    name="double_pendulum_by_hand", version="1")
