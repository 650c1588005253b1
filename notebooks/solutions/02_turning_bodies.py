# SPDX-License-Identifier: GPL-3.0-or-later
# Why does a thrown book tumble about one axis, and about the others not? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def moved(M, X):
    back = np.linalg.inv(X)
    return back.T @ M @ back

def centre_of_mass(M):
    first_moment = M[3:, :3]  # m [c]x
    return np.array([first_moment[2, 1], first_moment[0, 2], first_moment[1, 0]]) / M[0, 0]

# %% exercise-2
import numpy as np
from by_hand import inertia, pose, transform

def kinetic(bodies, q, qd):
    V, T = [], 0.0
    for b in bodies:
        before = V[b.parent] if b.parent >= 0 else np.zeros(6)
        rate = qd[b.q] if b.q >= 0 else 0.0
        V.append(transform(*pose(b, q)) @ before + b.S * rate)
        T += V[-1] @ inertia(b) @ V[-1] / 2 + b.rotor * rate**2 / 2
    return T

def momentum(bodies, q, qd):
    V, places, total = [], [], np.zeros(6)
    for b in bodies:
        before = V[b.parent] if b.parent >= 0 else np.zeros(6)
        R_parent, p_parent = places[b.parent] if b.parent >= 0 else (np.eye(3), np.zeros(3))
        R, p = pose(b, q)
        places.append((R_parent @ R, p_parent + R_parent @ p))
        V.append(transform(R, p) @ before + b.S * (qd[b.q] if b.q >= 0 else 0.0))
        total += transform(*places[-1]).T @ inertia(b) @ V[-1]  # momentum moves as a wrench
    return total

# %% exercise-3
w = np.array([0.01, 6.01, 0.01])
twice_T, L_squared = w @ I @ w, (I @ w) @ (I @ w)
# at the largest wz the rate about x or y is zero; both ellipsoids together leave one of the two
candidates = []
for k in (0, 1):
    A = np.array([[I[k, k], I[2, 2]], [I[k, k] ** 2, I[2, 2] ** 2]])
    squares = np.linalg.solve(A, [twice_T, L_squared])
    if squares.min() >= 0:
        candidates.append(np.sqrt(squares[1]))
largest_wz = max(candidates)
