# SPDX-License-Identifier: GPL-3.0-or-later
# Inverse dynamics: two sweeps, or one matrix? Solutions, each in the place of the exercise with its id.

# %% exercise-1
import numpy as np
from by_hand import pose

def tau(bodies, q, qd, qdd, gravity):
    motion, need, places = [], [], []
    for b in bodies:
        R, p = pose(b, q)
        w, wd, v, a = motion[b.parent] if b.parent >= 0 else (np.zeros(3), np.zeros(3), np.zeros(3), -gravity)
        rate, more = (qd[b.q], qdd[b.q]) if b.q >= 0 else (0.0, 0.0)
        axis, slide = b.S[3:], b.S[:3]
        # of the point of the parent that the link's origin is at, in the link's axes; a is the point's own acceleration
        v_p = R.T @ (v + np.cross(w, p))
        a_p = R.T @ (a + np.cross(wd, p) + np.cross(w, np.cross(w, p)))
        w_p, wd_p = R.T @ w, R.T @ wd
        w_new, slip = w_p + axis * rate, slide * rate
        wd_new = wd_p + axis * more + np.cross(w_p, axis * rate)
        # the origin slips over the parent by S: Coriolis' term, and its own turning about the joint
        a_new = a_p + slide * more + 2 * np.cross(w_p, slip) + np.cross(axis * rate, slip)
        motion.append((w_new, wd_new, v_p + slip, a_new))
        places.append((R, p))
        a_com = a_new + np.cross(wd_new, b.com) + np.cross(w_new, np.cross(w_new, b.com))
        f = b.mass * a_com
        need.append([f, b.inertia @ wd_new + np.cross(w_new, b.inertia @ w_new) + np.cross(b.com, f)])
    tau = np.zeros(len(q))
    for k in reversed(range(len(bodies))):
        b, (f, m), (R, p) = bodies[k], need[k], places[k]
        if b.q >= 0:
            tau[b.q] = b.S[:3] @ f + b.S[3:] @ m + b.rotor * qdd[b.q] + b.spring * (q[b.q] - b.rest)
        if b.parent >= 0:
            need[b.parent][0] = need[b.parent][0] + R @ f
            need[b.parent][1] = need[b.parent][1] + R @ m + np.cross(p, R @ f)
    return tau

# %% exercise-2
from by_hand import inertia, transform

def M(bodies, q):
    X, M_C = [transform(*pose(b, q)) for b in bodies], [inertia(b) for b in bodies]
    for k in reversed(range(len(bodies))):
        if bodies[k].parent >= 0:
            M_C[bodies[k].parent] = M_C[bodies[k].parent] + X[k].T @ M_C[k] @ X[k]
    result = np.zeros((len(q), len(q)))
    for k, b in enumerate(bodies):
        if b.q < 0:
            continue
        force, j = M_C[k] @ b.S, k
        result[b.q, b.q] = b.S @ force + b.rotor
        while bodies[j].parent >= 0:
            force, j = X[j].T @ force, bodies[j].parent
            if bodies[j].q >= 0:
                result[b.q, bodies[j].q] = result[bodies[j].q, b.q] = bodies[j].S @ force
    return result

def c(bodies, q, qd):
    zero = np.zeros(len(q))
    return tau(bodies, q, qd, zero, np.zeros(3)) - tau(bodies, q, zero, zero, np.zeros(3))  # without springs

def g(bodies, q, gravity):
    return tau(bodies, q, np.zeros(len(q)), np.zeros(len(q)), gravity)

# %% exercise-3
# the slide moves along the axes of all turns: no turn moves it, and it turns nothing
always_zero = {(1, 3), (2, 3), (3, 4)}
