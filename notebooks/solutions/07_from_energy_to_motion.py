# SPDX-License-Identifier: GPL-3.0-or-later
# Where do M, c and g come from? Solutions, each in the place of the exercise with its id.

# %% exercise-1
answers = [
    "M12 = m2*l2^2/3 + m2*l1*l2*cos(q2)/2",
    "c2 = m2*l1*l2*sin(q2)*qd1^2/2",
    "g1 = (m1/2 + m2)*g*l1*sin(q1) + m2*g*l2*sin(q1 + q2)/2",
]

# %% exercise-2
# not on 1: turning all of it changes no inertia; not on 6: the last link is alike about its axis
depends = {2, 3, 4, 5}
