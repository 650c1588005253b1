# SPDX-License-Identifier: GPL-3.0-or-later
# Newton-Euler adds forces, Lagrange differentiates energies. Why do they agree? Solutions, each in the place of the exercise with its id.

# %% exercise-1
import numpy as np
import by_hand

def c(bodies, q, qd):
    h = 1e-30
    D = np.array([by_hand.mass_matrix(bodies, q + 1j * h * e).imag / h for e in np.eye(len(q))])
    return np.einsum("kij,j,k->i", D, qd, qd) - np.einsum("ijk,j,k->i", D, qd, qd) / 2

# %% exercise-2
def two_matrices(q, qd):
    D = dM(q)
    first = (np.einsum("kij,k->ij", D, qd) + np.einsum("jik,k->ij", D, qd) - np.einsum("ijk,k->ij", D, qd)) / 2
    across = np.array([qd[1], -qd[0], 0, 0, 0, 0])  # no power: across @ qd = 0
    return first, first + np.outer(np.ones(6), across)

# %% exercise-3
M = arm.M(q)
change = np.zeros(6)
change[1], change[2] = M[0, 2], -M[0, 1]  # row 1 of M does not see it
change *= 100 / np.linalg.norm(change)
first_qdd, second_qdd = np.zeros(6), change
