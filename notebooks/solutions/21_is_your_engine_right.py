# SPDX-License-Identifier: GPL-3.0-or-later
# Is your own dynamics code right? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def wrong_robot(q, qd, qdd):
    return engine(q, qd, qdd, steiner=10)  # heavier about its centres, as heavy at rest

# %% exercise-2
guilty_link, factor = "link_3", 1.0625  # what the diagnosis says of its mass

# %% exercise-3
def lazy(q, qd, qdd):
    return engine(q, 0 * qd, qdd)  # velocity products left out
