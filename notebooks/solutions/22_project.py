# SPDX-License-Identifier: GPL-3.0-or-later
# The end of term: can you make an engine that nobody can fault? Solutions, each in the place of the exercise with its id.

# %% exercise-1
import numpy as np
from by_hand import cross, inertia, mass_matrix, pose, transform

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

def qdd(bodies, q, qd, tau, gravity):
    n = len(bodies)
    X, V, slip = [transform(*pose(b, q)) for b in bodies], [], []
    for k, b in enumerate(bodies):
        joint = b.S * qd[b.q] if b.q >= 0 else np.zeros(6)
        V.append(X[k] @ (V[b.parent] if b.parent >= 0 else np.zeros(6)) + joint)
        slip.append(cross(V[k]) @ joint)
    M_A = [inertia(b) for b in bodies]
    p_A = [-cross(V[k]).T @ M_A[k] @ V[k] for k in range(n)]
    U, D, u = [None] * n, [None] * n, [None] * n
    for k in reversed(range(n)):
        b = bodies[k]
        passed, bias = M_A[k], p_A[k]
        if b.q >= 0:
            U[k] = M_A[k] @ b.S
            D[k] = b.rotor + b.S @ U[k]
            u[k] = tau[b.q] - b.spring * (q[b.q] - b.rest) - b.S @ p_A[k]
            passed = M_A[k] - np.outer(U[k], U[k]) / D[k]
            bias = p_A[k] + passed @ slip[k] + U[k] * u[k] / D[k]
        if b.parent >= 0:  # a sum over all branches
            M_A[b.parent] = M_A[b.parent] + X[k].T @ passed @ X[k]
            p_A[b.parent] = p_A[b.parent] + X[k].T @ bias
    A, result = [], np.zeros(len(q))
    for k, b in enumerate(bodies):
        there = X[k] @ (A[b.parent] if b.parent >= 0 else np.append(-gravity, np.zeros(3))) + slip[k]
        if b.q >= 0:
            result[b.q] = (u[k] - U[k] @ there) / D[k]
            there = there + b.S * result[b.q]
        A.append(there)
    return result

def jacobian(bodies, q, k, at):
    J = np.zeros((6, len(q)))
    R, p = np.eye(3), np.array(at, float)  # of the point, seen from the link that the loop has come to
    axes = np.eye(3)  # of body k in those of that link
    columns = []
    while k >= 0:
        b = bodies[k]
        columns.append((b.q, np.concatenate([b.S[:3] + np.cross(b.S[3:], p), b.S[3:]])))
        R, origin = pose(b, q)
        p, k = origin + R @ p, b.parent
        columns = [(j, np.concatenate([R @ c[:3], R @ c[3:]])) for j, c in columns]
    for j, column in columns:
        if j >= 0:
            J[:, j] = column
    return J

def M(bodies, q):
    return mass_matrix(bodies, q)

def c(bodies, q, qd):
    zero = np.zeros(len(q))
    return tau(bodies, q, qd, zero, np.zeros(3)) - tau(bodies, q, zero, zero, np.zeros(3))

def g(bodies, q, gravity):
    return tau(bodies, q, np.zeros(len(q)), np.zeros(len(q)), gravity)

def kinetic(bodies, q, qd):
    return qd @ mass_matrix(bodies, q) @ qd / 2
