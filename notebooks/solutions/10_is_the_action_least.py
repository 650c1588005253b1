# SPDX-License-Identifier: GPL-3.0-or-later
# Nature takes the path of least action. Does it? Solutions, each in the place of the exercise with its id.

# %% exercise-1
path = motion(2.0, 400)
sizes, directions = np.linalg.eigh(second_variation(path, 0.005))
lower, higher = path.copy(), path.copy()
lower[1:-1] += 0.04 * directions[:, 0] / np.abs(directions[:, 0]).max()
higher[1:-1] += 0.04 * directions[:, 4] / np.abs(directions[:, 4]).max()

# %% exercise-2
def next_position(scene, before, now, h):
    def slope(a, b):
        """d/d(end) and d/d(start) of the summand of a and b."""
        middle, rate = (a + b) / 2, (b - a) / h
        p = scene.M(middle) @ rate
        # dL/dq at the midpoint: dT/dq = (dM/dt) qd - c, and dM/dt qd is the derivative of M along qd
        e = 1e-6
        M_rate = (scene.M(middle + e * rate) - scene.M(middle - e * rate)) / (2 * e)
        force = M_rate @ rate - scene.c(middle, rate) - scene.g(middle)
        return p + h / 2 * force, -p + h / 2 * force

    given = slope(before, now)[0]
    after = 2 * now - before
    for _ in range(20):
        residual = given + slope(now, after)[1]
        after = after + h * np.linalg.solve(scene.M((now + after) / 2), residual)
    return after

# %% exercise-3
def varied(path, eta, h, tau):
    middle, rate = (path[1:] + path[:-1]) / 2, np.diff(path) / h
    between, eta_rate = (eta[1:] + eta[:-1]) / 2, np.diff(eta) / h
    return np.sum(h * (I * rate * eta_rate - weight * np.sin(middle) * between + tau * between))
