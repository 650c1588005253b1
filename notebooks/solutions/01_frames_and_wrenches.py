# SPDX-License-Identifier: GPL-3.0-or-later
# What does a push on the hand look like at the elbow? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def wrench_in_parent(R, p, f, m):
    force = R @ f
    return force, R @ m + np.cross(p, force)

# %% exercise-2
import numpy as np
from by_hand import pose

def jacobian(bodies, q, k, at):
    J = np.zeros((6, len(q)))
    R, p = np.eye(3), np.array(at, float)  # of the point, seen from the link that the loop has come to
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

# %% exercise-3
singular = np.array([0.3, -0.7, 1.1, 0.4, 0.0, 0.2])
J_own = np.array([joint_forces(bodies, singular, unit) for unit in np.eye(6)]).T  # tau = J_own F
silent = np.linalg.svd(J_own)[2][-1]
