# SPDX-License-Identifier: GPL-3.0-or-later
# Two computations disagree. Which term is wrong? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def wrong_terms(tau, robot):
    n, rng, found = robot.n, np.random.default_rng(5), set()
    zero = np.zeros(n)
    for _ in range(5):
        q, qd = rng.uniform(-2, 2, (2, n))
        g, limit = tau(q, zero, zero), 1e-11 * (1 + np.abs(robot.g(q)).max() + np.abs(robot.c(q, qd)).max())
        columns = np.column_stack([tau(q, zero, e) - g for e in np.eye(n)])
        parts = {"g": g - robot.g(q), "c": tau(q, qd, zero) - g - robot.c(q, qd), "M": columns - robot.M(q)}
        found |= {name for name, error in parts.items() if np.abs(error).max() > limit}
    return found

# %% exercise-2
calls = 8  # one at rest, one with qd, and one for each column
