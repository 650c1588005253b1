# SPDX-License-Identifier: GPL-3.0-or-later
"""For tests: is a Python function the dynamics of a scene? Works with pytest and without."""
import numpy as np

from . import program

# of what each quantity is a function, in the order of its arguments
ARGUMENTS = {"tau": ("q", "qd", "qdd"), "M": ("q",), "c": ("q", "qd"), "g": ("q",)}


def _columns(quantity, n):
    """Names as `dynwitness evaluate` has them."""
    if quantity != "M":
        return [f"{quantity}{i + 1}" for i in range(n)]
    return [f"M{i + 1}{'_' if n > 9 else ''}{j + 1}" for i in range(n) for j in range(n)]


def _states(scene, states, seed):
    """Random positions within a turn, unit quaternions where there are any, and rates."""
    if scene.nq != scene.n:
        raise ValueError(f"scene: {scene.name} has {scene.nq} positions for {scene.n} rates, allowed: "
                         "joints whose rates are derivatives of their positions")
    draw = np.random.default_rng(seed)
    return {name: draw.uniform(-3, 3, (states, scene.n)) for name in ("q", "qd", "qdd")}


def assert_engine(fn, scene, *, states=10, seed=1):
    """Raises AssertionError with the diagnosis of `dynwitness check` where a function is not the scene's.

    fn: a function fn(q, qd, qdd) that gives tau, or a dictionary of functions: {"tau": fn(q, qd, qdd),
        "M": fn(q), "c": fn(q, qd), "g": fn(q)}. Called with one state at a time, arrays of shape (n,)
        [rad, rad/s, rad/s^2; m for slides]; M has shape (n, n), the others (n,) [N m, N].
    scene: a Scene, or what load() takes. Rates have to be derivatives of positions.
    states: how many random states, at most 10. seed: of these.

    Each answer is judged by what an algorithm of its kind may lose in rounding; where it is wrong, the
    message says at which joints and in which term, and which mistake would have answered the same.
    """
    from . import load
    scene = scene if hasattr(scene, "toml") else load(str(scene))
    functions = fn if isinstance(fn, dict) else {"tau": fn}
    unknown = [name for name in functions if name not in ARGUMENTS]
    if unknown or not functions:
        raise ValueError(f"fn: {', '.join(map(str, unknown)) or 'no quantity'}, allowed: {', '.join(ARGUMENTS)}")
    if not 1 <= states <= 10:
        raise ValueError(f"states: {states}, allowed: 1 to 10")
    given = _states(scene, states, seed)
    names = [f"{part}{i + 1}" for part in given for i in range(scene.n)]
    blocks = list(given.values())
    for quantity, function in functions.items():
        shape = (scene.n, scene.n) if quantity == "M" else (scene.n,)
        rows = []
        for k in range(states):
            answer = np.asarray(function(*(given[part][k].copy() for part in ARGUMENTS[quantity])), float)
            if answer.shape != shape:
                raise AssertionError(f"{quantity}: expected shape {shape}, got {answer.shape}")
            rows.append(answer.ravel())
        names += _columns(quantity, scene.n)
        blocks.append(np.array(rows))
    lines = [",".join(names)]
    lines += [",".join(repr(float(x)) for x in row) for row in np.hstack(blocks)]
    with program._Files() as files:
        (files.path / "answers.csv").write_text("\n".join(lines) + "\n")
        try:
            program.run("check", files.scene(scene), "--answers", files.path / "answers.csv", "-o",
                        files.path / "report.txt", agreed_only=True)
        except program.ProgramFailed as failed:
            if failed.status != 1:
                raise
            raise AssertionError("not the dynamics of this scene:\n" +
                                 (files.path / "report.txt").read_text()) from None
