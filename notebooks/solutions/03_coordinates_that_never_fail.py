# SPDX-License-Identifier: GPL-3.0-or-later
# Which coordinates of a turning body never fail? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def product(A, B):
    w = A[0] * B[0] - A[1:] @ B[1:]
    return np.append(w, A[0] * B[1:] + B[0] * A[1:] + np.cross(A[1:], B[1:]))

# %% exercise-2
def position_rates(q, qd):
    Q = q[3:7]
    return np.concatenate([rotation(Q) @ qd[:3], E(Q) @ qd[3:6] / 2, qd[6:]])

# %% exercise-3
# zeta = exp(i k t): -A k^2 + C w k - m g l = 0 has two real roots k when (C w)^2 > 4 A m g l
least_spin = 2 * np.sqrt(0.0058 * 0.4905) / 0.0004
