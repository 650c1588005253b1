# SPDX-License-Identifier: GPL-3.0-or-later
# What does a link feel of another one that hangs on a free joint? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def passed_outward(P):
    return P.T

# %% exercise-2
def projection_of_many(M, Z):
    return np.eye(6) - M @ Z @ np.linalg.inv(Z.T @ M @ Z) @ Z.T

# %% exercise-3
puma, where = dw.load("puma_560"), np.array([0.3, -0.7, 1.1, 0.4, -0.9, 0.2])
J = puma.jacobian("link_6", where)[:3]
mobility = J @ np.linalg.inv(puma.M(where)) @ J.T
sizes, directions = np.linalg.eigh(mobility)
lightest, felt_mass = directions[:, -1], 1 / sizes[-1]
