# SPDX-License-Identifier: GPL-3.0-or-later
"""For tests: is a Python function the dynamics of a scene? Works with pytest and without."""
from . import program


def assert_engine(fn, scene, *, states=10, seed=1):
    """Raises AssertionError with the diagnosis of `dynwitness check` where a function is not the scene's.

    Arguments as those of dynwitness.check(): a function fn(q, qd, qdd) that gives tau, or a dictionary of
    functions. An answer of another shape is a wrong answer.
    """
    try:
        report = program.check(fn, scene, states=states, seed=seed)
    except ValueError as error:
        if ": expected shape" in str(error):
            raise AssertionError(str(error)) from None
        raise
    if not report.right:
        raise AssertionError(f"not the dynamics of this scene:\n{report}")
