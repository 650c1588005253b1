#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`derive --format sympy` is Python that SymPy executes, and what it gives are SymPy's own objects: numbers can be
put in, they can be differentiated, and lambdify makes functions of them. Values are held to those of `evaluate` (the
sweeps of recursive/), c to the Christoffel symbols of M, dM/dq and dtau/dqdd by SymPy's derivatives.
Usage: test_sympy.py DYNWITNESS. Exit status 77: no SymPy is there."""
import json
import random
import subprocess
import sys
import tempfile

try:
    import sympy
except ImportError:
    print("test_sympy: skipped: no python3-sympy (Debian: apt install python3-sympy)")
    sys.exit(77)

PROGRAM = sys.argv[1]
# followers, quaternions, friction, wrenches, springs, rotors, fixed angles that are no quarter turns; one joint
SCENES = ["simple_pendulum", "double_pendulum", "cart_pole", "elastic_pendulum", "gripper", "heavy_top", "scara",
          "puck_on_slope", "differential_wrist", "puma_560_friction", "franka_panda"]
# a double's last digits, after some hundred operations
CLOSE = 1e-11


def program(*words):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


def close(found, expected, size, what):
    assert abs(found - expected) <= CLOSE * max(1, size), (what, found, expected)


def module_of(scene):
    names = {}
    exec(compile(program("derive", scene, "--format", "sympy"), scene, "exec"), names)
    return names


def at_evaluated_states(scene, made):
    q, qd, qdd = (list(made[k]) for k in ("q", "qd", "qdd"))
    n = len(qd)
    assert made["M"].shape == (n, n) and all(made[k].shape == (n, 1) for k in ("c", "g", "Q", "tau"))
    values = [made[k].subs(made["VALUES"]) for k in ("M", "c", "g", "tau")]
    function = sympy.lambdify(q + qd + qdd, values, "mpmath", cse=True)
    rows = program("evaluate", scene, "--random", "5", "--seed", "4", "--quantity", "M,c,g,tau", "--format", "json")
    rows = [json.loads(line) for line in rows.splitlines()]
    assert len(rows) == 5
    for row in rows:
        found = function(*[row[str(s)] for s in q + qd + qdd])
        for letter, matrix in zip(("M", "c", "g", "tau"), found):
            expected = {(i, j): row["M%d%d" % (i + 1, j + 1) if letter == "M" else "%s%d" % (letter, i + 1)]
                        for i in range(n) for j in range(n if letter == "M" else 1)}
            size = max(map(abs, expected.values()))
            for (i, j), value in expected.items():
                close(float(matrix[i, j]), value, size, (scene, letter, i, j))


def by_derivatives(scene, made):
    """c_i = sum of (dM_ij/dq_k - dM_jk/dq_i / 2) qd_j qd_k, g = dV/dq (so dg_i/dq_k = dg_k/dq_i), M = dtau/dqdd."""
    q, qd, qdd, M, c, g, tau = (made[k] for k in ("q", "qd", "qdd", "M", "c", "g", "tau"))
    n = len(qd)
    random.seed(scene)
    at = {s: sympy.Rational(random.randint(-99, 99), 64) for s in [*q, *qd, *qdd]}
    at.update({p: sympy.Rational(random.randint(1, 99), 64) for p in made["parameters"]})

    def number(x):
        return x.subs(at).evalf(30)
    dM = [M.diff(q[k]) for k in range(n)]
    for i in range(n):
        christoffel = sum((dM[k][i, j] - dM[i][j, k] / 2) * qd[j] * qd[k] for j in range(n) for k in range(n))
        close(number(c[i]), number(christoffel), 1, (scene, "c", i))
        for j in range(n):
            close(number(tau[i].diff(qdd[j])), number(M[i, j]), 1, (scene, "dtau/dqdd", i, j))
            close(number(g[i].diff(q[j])), number(g[j].diff(q[i])), 1, (scene, "dg/dq", i, j))
    # free symbols are those that are named, and numbers are exact
    assert M.free_symbols <= {*q, *made["parameters"]} and not M.atoms(sympy.Float), scene


def main():
    for scene in SCENES:
        at_evaluated_states(scene, module_of(scene))
    for scene in ("double_pendulum", "cart_pole", "elastic_pendulum", "scara"):
        by_derivatives(scene, module_of(scene))

    # functions of time in place of symbols: SymPy's mechanics
    made = module_of("simple_pendulum")
    t = sympy.Symbol("t")
    angle = sympy.Function("theta")(t)
    M, c, g, _ = made["equations"]([angle], [angle.diff(t)], made["parameters"])
    assert M[0][0].has(angle) is False and sympy.sympify(g[0]).diff(t).has(angle.diff(t)) and c == [0]

    # a parameter that is called as a coordinate is another symbol
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write('gravity = [0, 0, -10]\n[parameters]\nq1 = "cos(pi/10)"\n[[link]]\nname = "base"\n[[link]]\n'
                   'name = "arm"\nparent = "base"\nmass = "q1"\ncom = [0, 0, "sqrt(2)"]\n[link.joint]\n'
                   'kind = "revolute"\naxis = [0, 1, 0]\n')
        file.flush()
        made = module_of(file.name)
        (mass,), (q,) = made["parameters"], made["q"]
        assert mass != q and made["M"].free_symbols == {mass}, made["M"]
        value = made["M"].subs(made["VALUES"])[0]
        assert value.is_Rational and abs(value - 2 * sympy.cos(sympy.pi / 10)).evalf(70) < 1e-58, value
    refused = subprocess.run([PROGRAM, "derive", "cart_pole", "--format", "sympy", "--quantity", "tau"],
                             capture_output=True, text=True)
    assert refused.returncode == 2 and "allowed: --quantity all" in refused.stderr, refused.stderr
    print("test_sympy: %d scenes by SymPy %s" % (len(SCENES), sympy.__version__))


main()
