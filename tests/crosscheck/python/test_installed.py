#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""pip installs the module into an environment of its own, without a network, and it works from there.

    test_installed.py PROGRAM BUILD

Ends with 77, which ctest takes for skipped, where venv, pip, setuptools, wheel or numpy are missing.
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PROGRAM, BUILD = sys.argv[1:3]

for needed in ("setuptools", "pip", "wheel", "venv", "ensurepip", "numpy"):
    if subprocess.run([sys.executable, "-c", f"import {needed}"], capture_output=True).returncode:
        print(f"skipped: no {needed}")
        sys.exit(77)

CODE = """
import numpy as np, dynwitness as dw
assert "env" in dw.__file__, dw.__file__
arm = dw.load("double_pendulum")
assert arm.M([0, 0]).shape == (2, 2)
assert "<svg" in arm._repr_html_()
dw.testing.assert_engine(arm.id, arm)
try:
    dw.testing.assert_engine(lambda q, qd, qdd: -arm.id(q, qd, qdd), arm)
except AssertionError as error:
    assert "WRONG" in str(error), error
else:
    raise SystemExit("a wrong engine passes")
print(dw.__version__)
"""

with tempfile.TemporaryDirectory() as folder:
    env = Path(folder) / "env"
    before = set((ROOT / "crosscheck" / "python").rglob("*"))
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", env], check=True)
    subprocess.run([env / "bin" / "pip", "install", "--no-build-isolation", "--no-index", "--no-deps",
                    "--disable-pip-version-check", ROOT / "crosscheck" / "python"], check=True,
                   env={**os.environ, "DYNWITNESS_BUILD": BUILD})
    said = subprocess.run([env / "bin" / "python", "-c", CODE], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "DYNWITNESS_PROGRAM": PROGRAM})
    assert said.returncode == 0, said.stderr
    beside = {path for path in set((ROOT / "crosscheck" / "python").rglob("*")) - before
              if "__pycache__" not in path.parts}
    assert not beside, f"left beside the sources: {beside}"
    print("installed and used:", said.stdout.strip())
