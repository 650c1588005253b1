# SPDX-License-Identifier: GPL-3.0-or-later
# Which masses and inertias can a robot's motion tell? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def base_count(robot, states=200):
    q, qd, qdd = np.random.default_rng(3).uniform(-2, 2, (3, states, robot.n))
    Y = robot.regressor(q, qd, qdd).reshape(states * robot.n, -1)
    norms = np.linalg.norm(Y, axis=0)
    kept = norms > 1e-10 * norms.max()  # a column of roundings, scaled to length 1, would count
    sizes = np.linalg.svd(Y[:, kept] / norms[kept])[1]
    # what rounding leaves of a zero; the smallest that is none is larger by orders
    return int((sizes > 1e3 * max(Y.shape) * np.finfo(float).eps * sizes[0]).sum())

# %% exercise-2
panda = dw.load("franka_panda")
q = np.random.default_rng(4).uniform(-2, 2, (200, 7))
sizes = np.linalg.svd(panda.regressor(q, 0 * q, 0 * q).reshape(1400, -1))[1]
standing = int((sizes > 1e-9 * sizes[0]).sum())
