# SPDX-License-Identifier: GPL-3.0-or-later
# Can one motor hold two links upright? Solutions, each in the place of the exercise with its id.

# %% exercise-1
B_1 = np.concatenate([[0, 0], np.linalg.solve(M, [1, 0])])
shoulder_rank = np.linalg.matrix_rank(np.column_stack([np.linalg.matrix_power(A, j) @ B_1 for j in range(4)]))
shoulder_gains = optimal_gains(A, B_1, np.diag([1.0, 1, 0.1, 0.1]), 0.01)

# %% exercise-2
def law(q, qd, goal, kp=100.0, kd=20.0):
    return right.g(q) + kp * (goal - q) - kd * qd

def energy_rate(qd, kd=20.0):
    return -kd * qd @ qd

# %% exercise-3
puma, at = dw.load("puma_560"), np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0])
K_puma = np.column_stack([(puma.g(at + 1e-5 * e) - puma.g(at - 1e-5 * e)) / 2e-5 for e in np.eye(6)])
squares = np.linalg.eigvals(np.linalg.solve(puma.M(at), -K_puma))  # of the modes
growing = int((np.sqrt(squares.astype(complex)).real > 1e-6).sum())
