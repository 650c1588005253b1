# SPDX-License-Identifier: GPL-3.0-or-later
# What is a straight line for a robot? Solutions, each in the place of the exercise with its id.

# %% exercise-1
cart_bodies = dw.bodies("cart_pole")
def K_of(q2, h=1e-4):
    m = lambda x: mass_matrix(cart_bodies, np.array([0.0, x]))
    E_rate = lambda x: mass_matrix(cart_bodies, np.array([0.0, x + 1e-30j])).imag[0, 0] / 1e-30
    inner = lambda x: E_rate(x) / np.sqrt(np.linalg.det(m(x)))
    return -(inner(q2 + h) - inner(q2 - h)) / (2 * h) / (2 * np.sqrt(np.linalg.det(m(q2))))
largest_K = max(abs(K_of(a)) for a in (0.0, 0.3, 0.7, 1.2, 2.0))  # E is constant: flat

# %% exercise-2
def kept(steps):
    weightless = dw.from_text(dw.SceneText.read("puma_560").swap("gravity = [0, 0, -9.81]", "gravity = [0, 0, 0]"))
    q, qd, h = np.array([0.3, -0.7, 2.3, 0.4, -0.9, 0.2]), np.array([0.5, -0.4, 0.3, 0.4, 0.2, -0.3]), 1.0 / steps
    f = lambda q, v: (v, weightless.fd(q, v, np.zeros(6)))
    start = (weightless.M(q) @ qd)[0], weightless.kinetic(q, qd)
    worst = [0.0, 0.0]
    for _ in range(steps):
        a = f(q, qd)
        b = f(q + h / 2 * a[0], qd + h / 2 * a[1])
        c = f(q + h / 2 * b[0], qd + h / 2 * b[1])
        d = f(q + h * c[0], qd + h * c[1])
        q, qd = (x + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]) for i, x in enumerate((q, qd)))
        now = (weightless.M(q) @ qd)[0], weightless.kinetic(q, qd)
        worst = [max(w, abs(n / s - 1)) for w, n, s in zip(worst, now, start)]
    return tuple(worst)

# %% exercise-3
def plane_curvature(bodies, q, i, j):
    n, h = len(q), 1e-4
    def D(q):
        return np.array([mass_matrix(bodies, q + 1e-30j * e).imag / 1e-30 for e in np.eye(n)])
    DD = np.array([(D(q + h * e) - D(q - h * e)) / (2 * h) for e in np.eye(n)])  # [a, b] second derivatives
    G, inverse = D(q), np.linalg.inv(mass_matrix(bodies, q))
    Gamma = (np.einsum("kij->ijk", G) + np.einsum("jik->ijk", G) - np.einsum("ijk->ijk", G)) / 2
    m = mass_matrix(bodies, q)
    R = DD[i, j][i, j] - (DD[i, i][j, j] + DD[j, j][i, i]) / 2  # = R_ijij up to the products
    R += Gamma[:, i, j] @ inverse @ Gamma[:, i, j] - Gamma[:, i, i] @ inverse @ Gamma[:, j, j]
    return R / (m[i, i] * m[j, j] - m[i, j] ** 2)
