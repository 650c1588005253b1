# SPDX-License-Identifier: GPL-3.0-or-later
# A mechanism in a pose where it could go two ways. What do the equations say? Solutions, each in the place of the exercise with its id.

# %% exercise-1
def can_lie_in_a_line(a, b, c, d):
    # Grashof's equality, or one bar as long as all others
    longest, shortest = max(a, b, c, d), min(a, b, c, d)
    total = a + b + c + d
    return bool(abs(2 * (longest + shortest) - total) < 1e-12 or abs(2 * longest - total) < 1e-12)

# %% exercise-2
singular = np.array([0.3, -0.7, 1.1, 0.4, 1.0, 0.2])
# the elbow stretched: joints 2 and 3 and the wrist's centre in one plane. Its determinant changes sign there.
puma = dw.load("puma_560")
sign = lambda q3: np.linalg.det(puma.jacobian("link_6", np.concatenate([singular[:2], [q3], singular[3:]])))
grid = np.linspace(-3, 3, 601)
k = next(k for k in range(600) if sign(grid[k]) * sign(grid[k + 1]) < 0)
low, high = grid[k], grid[k + 1]
for _ in range(60):
    middle = (low + high) / 2
    low, high = (low, middle) if sign(low) * sign(middle) <= 0 else (middle, high)
singular[2] = low
