#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Adapters of data/engines/ are right about scenes that they can hold, and a planted mistake is seen through
them. Usage: test_adapters.py DYNWITNESS WHICH, WHICH being generated_c, sympy or octave. Exit status 77: what it
needs is not there."""
import json
import os
import shutil
import subprocess
import sys
import tempfile

PROGRAM, WHICH = sys.argv[1:]
ENGINES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "data", "engines")


def checked(scene, engine):
    done = subprocess.run([PROGRAM, "check", scene, "--engine", engine, "--engine-seconds", "120",
                           "--engine-memory", "100", "--format", "json"], capture_output=True, text=True)
    return done.returncode, json.loads(done.stdout) if done.stdout else done.stderr


def require_right(scene, engine, quantities):
    status, said = checked(scene, engine)
    assert status == 0, (scene, status, said)
    right = {q["quantity"] for q in said["quantities"] if q["verdict"] == "right"}
    assert right == set(quantities), (scene, right)


def skip(reason):
    print("skipped: " + reason)
    sys.exit(77)


def compiled(folder, scene, code):
    source, program = os.path.join(folder, scene + ".c"), os.path.join(folder, scene)
    with open(source, "w") as file:
        file.write(code)
    subprocess.run([os.environ.get("CXX") or "c++", "-std=c++17", "-O0", "-Wall", "-Wextra", "-Werror", "-I", ENGINES,
                    "-include", source, "-DSCENE=" + scene, "-o", program,
                    os.path.join(ENGINES, "generated_c.cpp")], check=True)
    return program


def generated_c():
    if not shutil.which(os.environ.get("CXX") or "c++"):
        skip("no C++ compiler")
    with tempfile.TemporaryDirectory() as folder:
        def derived(scene):
            return subprocess.run([PROGRAM, "derive", scene, "--format", "c"], check=True, capture_output=True,
                                  text=True).stdout

        require_right("puma_560", compiled(folder, "puma_560", derived("puma_560")), ["M", "c", "g", "tau"])
        # friction is not in the generated function
        require_right("puma_560_friction", compiled(folder, "puma_560_friction", derived("puma_560_friction")),
                      ["M", "c", "g"])
        right = derived("double_pendulum")
        program = compiled(folder, "double_pendulum", right)
        require_right("double_pendulum", program, ["M", "c", "g", "tau"])
        status, said = checked("acrobot", program)
        assert status == 2 and "it was generated for double_pendulum" in said, said
        assert "{9.81," in right
        status, said = checked("double_pendulum",
                               compiled(folder, "double_pendulum", right.replace("{9.81,", "{-9.81,")))
        assert status == 1 and "gravity" in said["findings"][0]["sentence"], said


def sympy():
    if subprocess.run(["/usr/bin/python3", "-c", "import sympy"], capture_output=True).returncode != 0:
        skip("no python3-sympy")
    engine = "/usr/bin/python3 " + os.path.join(ENGINES, "sympy_engine.py")
    for scene in ("furuta_pendulum", "cart_pole"):
        require_right(scene, engine, ["M", "c", "g", "tau", "potential"])
    status, said = checked("heavy_top", engine)
    assert status == 2 and "it knows fixed, revolute, prismatic" in said, said


def octave():
    if not shutil.which("octave-cli"):
        skip("no octave-cli")
    engine = "octave-cli -q " + os.path.join(ENGINES, "double_pendulum.m")
    require_right("double_pendulum", engine, ["M", "c", "g", "tau", "qdd", "kinetic"])
    status, said = checked("acrobot", engine)
    assert status == 1, said


{"generated_c": generated_c, "sympy": sympy, "octave": octave}[WHICH]()
print("right: " + WHICH)
