# SPDX-License-Identifier: GPL-3.0-or-later
"""What the notebooks build by hand, for the notebooks that go on from there. Six-vectors are (linear, angular); a
`body` is one of dw.bodies(scene); everything of a link is at its origin and in its axes."""
import numpy as np


def skew(r):
    """(3, 3) with skew(r) @ x = r x x."""
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])


def pose(body, q):
    """R (3, 3), link to parent axes, and p (3,) [m], the link's origin in the parent, at all joint positions q."""
    if body.q < 0:
        return body.R0, body.p0
    v, w, x = body.S[:3], skew(body.S[3:]), q[body.q]
    turn = np.eye(3) + np.sin(x) * w + (1 - np.cos(x)) * w @ w
    shift = (x * np.eye(3) + (1 - np.cos(x)) * w + (x - np.sin(x)) * w @ w) @ v
    return body.R0 @ turn, body.p0 + body.R0 @ shift


def transform(R, p):
    """X (6, 6): velocity (v, w) at the parent's origin in its axes -> at the link's origin in its axes. Forces go the
    other way, by X.T."""
    return np.block([[R.T, -R.T @ skew(p)], [np.zeros((3, 3)), R.T]])


def inertia(body):
    """(6, 6) mass matrix of a link about its origin."""
    m, c = body.mass, skew(body.com)
    return np.block([[m * np.eye(3), -m * c], [m * c, body.inertia - m * c @ c]])


def cross(V):
    """(6, 6): how vectors that are carried along by V change; its negative transpose does it for forces."""
    v, w = skew(V[:3]), skew(V[3:])
    return np.block([[w, v], [np.zeros((3, 3)), w]])


def mass_matrix(bodies, q):
    """(n, n), the sum of J' M J over the links; takes complex q, for derivatives by an imaginary step."""
    n = len(q)
    J, total = [], np.diag([sum(b.rotor for b in bodies if b.q == i) for i in range(n)]).astype(float)
    for b in bodies:
        mine = transform(*pose(b, q)) @ (J[b.parent] if b.parent >= 0 else np.zeros((6, n)))
        if b.q >= 0:
            mine[:, b.q] = mine[:, b.q] + b.S
        J.append(mine)
        total = total + mine.T @ inertia(b) @ mine
    return total
