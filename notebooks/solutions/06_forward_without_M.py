# SPDX-License-Identifier: GPL-3.0-or-later
# Can a robot be moved without its mass matrix? Solutions, each in the place of the exercise with its id.

# %% exercise-1
import numpy as np
from by_hand import cross, inertia, pose, transform

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

# %% exercise-2
pose_asked = np.array([0, -0.6, 0, -2.2, 0, 1.6, 0.8])

def felt(d_4):
    changed = [b._replace(rotor=d_4) if k == 3 else b for k, b in enumerate(bodies)]
    return articulated_body(changed, pose_asked, np.zeros(7), np.zeros(7), GRAVITY)[1][1]

ratio = 1
while (felt(ratio**2 * 1e-4) - felt(0.0)) / (felt(1e12) - felt(0.0)) < 0.99:
    ratio += 1

# %% exercise-3
def hybrid(q, qd, tau, qdd_2):
    M, bias = arm.M(q), arm.c(q, qd) + arm.g(q)
    free = [0, 2, 3, 4, 5, 6]
    result = np.zeros(7)
    result[1] = qdd_2
    result[free] = np.linalg.solve(M[np.ix_(free, free)], tau[free] - bias[free] - M[free, 1] * qdd_2)
    return result, M[1] @ result + bias[1]
