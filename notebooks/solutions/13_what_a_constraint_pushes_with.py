# SPDX-License-Identifier: GPL-3.0-or-later
# What does a constraint push with? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def on_a_rail(q, qd, tau):
    rows = [0, 2, 3, 4, 5]
    J, J_rate = arm.jacobian("link_6", q, AT)[rows], arm.jacobian_rate("link_6", q, qd, AT)[rows]
    M = arm.M(q)
    free = np.linalg.solve(M, tau - arm.c(q, qd) - arm.g(q))
    across = np.linalg.solve(M, J.T)
    forces = -np.linalg.solve(J @ across, J @ free + J_rate @ qd)
    return free + across @ forces, forces

# %% exercise-2
def projection(M, J):
    L = np.linalg.cholesky(M)  # in coordinates y = L'q the metric is a unit matrix
    B = np.linalg.solve(L, J.T).T
    return np.linalg.solve(L.T, (np.eye(len(M)) - np.linalg.pinv(B, rcond=1e-10) @ B) @ L.T)

# %% exercise-3
def one_sided(q, qd, tau):
    qdd, force = constrained(q, qd, tau)
    if force >= 0:
        return qdd, force
    return arm.fd(q, qd, tau), 0.0
