# SPDX-License-Identifier: GPL-3.0-or-later
# A blow lasts a millisecond. What does the robot do? Solutions, each in the place of the exercise with its id.

# %% exercise-1
sizes, directions = np.linalg.eigh(J @ np.linalg.solve(arm.M(q), J.T))
normal, least_blow = directions[:, -1], 1 / sizes[-1]

# %% exercise-2
row = np.array([1.0, 0, 0]) @ J
m = 1 / (row @ np.linalg.solve(arm.M(q), row))
blow = (1 + 0.8) * 3.0 / (1 / 0.4 + 1 / m)
ball_after, hand_after = -3.0 + blow / 0.4, -blow / m

# %% exercise-3
J_3 = arm.jacobian("link_3", q)[:3]
answers = np.linalg.solve(arm.M(q), J_3.T)  # of blows along x, y, z
plane = np.linalg.svd(answers[:1])[2][1:]  # directions that joint 1 does not answer
silent = plane[np.argmax(np.abs(plane @ answers[1]))]
