# SPDX-License-Identifier: GPL-3.0-or-later
"""Dynamics of robots and other mechanisms, computed in process, and witnessed by the program.

    import dynwitness as dw
    arm = dw.load("franka_panda")             # or a TOML, URDF or MJCF file; dw.from_text(text)
    arm.M([0] * 7)                            # (7, 7) [kg m^2]
    arm.id(q, qd, qdd)                        # (7,), or (N, 7) of batches (N, 7) [N m]
    dw.crosscheck(arm)["verdict"]             # what `dynwitness crosscheck` says
    dw.testing.assert_engine(fn, arm)         # is fn(q, qd, qdd) the arm's tau? if not: where, why

`./dynwitness python` builds what computes in process and says how to import it, and so does
`pip install --no-build-isolation ./crosscheck/python`. Without it the functions that run the program are there, and load() says so. SI units; needs numpy.
"""
import os
from pathlib import Path

from . import program
from .bodies import Bodies, Body, bodies
from .program import (Drawing, Maths, Picture, ProgramFailed, Report, SceneText, Step, Table, audit, chart, check,
                      crosscheck, derive, drift, evaluate, growth, parameters, plot, python_function, run,
                      show, simulate, ulps)

# what was compiled stands in the folder of the build
_BUILT = os.environ.get("DYNWITNESS_PYTHON_BUILD") or str(program.ROOT / "build" / "python" / "dynwitness")
__path__.append(str(Path(_BUILT)))

try:
    from ._core import InputError, Scene, __version__, from_text, load
    Scene._repr_html_ = program.scene_html  # notebooks show what it is and what it looks like
except ModuleNotFoundError:  # one that is there and does not load raises
    def load(name):
        raise ImportError("dynwitness in process is not built: ./dynwitness python builds it, for "
                          "/usr/bin/python3")

    from_text = load

from . import testing
