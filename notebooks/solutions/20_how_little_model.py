# SPDX-License-Identifier: GPL-3.0-or-later
# How little model does a robot need? Solutions, each in the place of the exercise with its id.

# %% exercise-1
trial = {"mass of link_2": (1, dict(mass=1.05 * bodies[1].mass)), "com of link_2": (1, dict(com=bodies[1].com * [1.05, 1, 1])), "mass of link_3": (2, dict(mass=1.05 * bodies[2].mass))}
found = {}
for name, (k, change) in trial.items():
    model = [b._replace(**change) if i == k else b for i, b in enumerate(bodies)]
    found[name] = np.abs(np.array([tau(model, *x) for x in states]) - full)[:, 1].max()
culprit = max(found, key=found.get)
worst = found[culprit]

# %% exercise-2
rest = full - np.array([arm.g(x[0]) for x in states])
m = (states[:, 2] * rest).sum(axis=0) / (states[:, 2] ** 2).sum(axis=0)

# %% exercise-3
c_largest = max(abs(arm.c(x[0], x[1])[2]) for x in states)  # c is quadratic in the rates
s = np.floor(100 * np.sqrt(0.05 * largest[2] / c_largest)) / 100
