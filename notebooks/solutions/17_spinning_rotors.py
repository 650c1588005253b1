# SPDX-License-Identifier: GPL-3.0-or-later
# What does a fast little rotor do to a slow arm? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def extra_tau(q, qd, qdd):
    h, result = 1e-6, np.zeros(4)

    def momenta(q, qd):
        """For each joint: W (3, 4) of the carrier, h (3,) world axes, and a . omega."""
        out = []
        for i, (b, (J, n)) in enumerate(zip([b for b in bodies if b.q >= 0], rotors)):
            name = bodies[b.parent].name if b.parent >= 0 else None
            W = plain.jacobian(name, q)[3:] if name else np.zeros((3, 4))
            axis = plain.rotation(b.name, q) @ b.S[3:]
            out.append((W, n * J * qd[i] * axis, axis @ (W @ qd)))
        return out

    ahead, back = (momenta(q + s * h * qd + h * h / 2 * qdd, qd + s * h * qdd) for s in (1, -1))
    for i, ((W, _, _), plus, minus) in enumerate(zip(momenta(q, qd), ahead, back)):
        J, n = rotors[i]
        result += W.T @ (plus[1] - minus[1]) / (2 * h)
        result[i] += n * J * (plus[2] - minus[2]) / (2 * h)
    return result

# %% exercise-2
changes = {"others"}  # n^2 does not see the sign, the coupling n J does

# %% exercise-3
x, steps = np.zeros(satellite.nq), 400
x[3] = 1.0
for _ in range(steps):
    M, r = satellite.M(x), np.zeros(satellite.n)
    r[-1] = 0.2
    r[:6] = -np.linalg.solve(M[:6, :6], M[:6, 6:] @ r[6:])
    R, w, v = satellite.rotation(satellite.links[1], x), x[3], x[4:7]
    x = x + np.concatenate([R @ r[:3], [-v @ r[3:6] / 2], (w * r[3:6] + np.cross(v, r[3:6])) / 2, r[6:]]) / steps
hull = x[3:7] / np.linalg.norm(x[3:7])
