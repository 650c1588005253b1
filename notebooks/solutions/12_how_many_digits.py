# SPDX-License-Identifier: GPL-3.0-or-later
# How many of these digits are true? Solutions, each in the place of the exercise with its id.

# %% exercise-1
best_h, digits_left = 1e-5, 10  # error h^2 of the difference, eps / h of the rounding: equal at h = eps^(1/3)

# %% exercise-2
import numpy as np
from by_hand import pose

def potential(bodies, q):
    V, places = 0.0 * q[0], []
    for b in bodies:
        R, p = pose(b, q)
        if b.parent >= 0:
            R_parent, p_parent = places[b.parent]
            R, p = R_parent @ R, p_parent + R_parent @ p
        places.append((R, p))
        V = V - b.mass * bodies.gravity @ (p + R @ b.com)
    return V
