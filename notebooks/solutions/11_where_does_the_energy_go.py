# SPDX-License-Identifier: GPL-3.0-or-later
# Where does the energy go? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def worst_energy_error(robot, q, duration, steps):
    h, qd, zero, energy = duration / steps, np.zeros(robot.n), np.zeros(robot.n), []
    for _ in range(steps + 1):
        energy.append(robot.kinetic(q, qd) + robot.potential(q))
        a = qd, robot.fd(q, qd, zero)
        b = qd + h / 2 * a[1], robot.fd(q + h / 2 * a[0], qd + h / 2 * a[1], zero)
        c = qd + h / 2 * b[1], robot.fd(q + h / 2 * b[0], qd + h / 2 * b[1], zero)
        d = qd + h * c[1], robot.fd(q + h * c[0], qd + h * c[1], zero)
        q, qd = (x + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]) for i, x in enumerate((q, qd)))
    return np.abs(np.array(energy) - energy[0]).max()

# %% exercise-2
it_drifts = bool(error[5000:].max() > np.sqrt(2) * error[:5000].max())  # from a simulation as the check has it
