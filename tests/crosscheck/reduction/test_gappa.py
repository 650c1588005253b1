#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bound that `reduce` certifies, proven again by Gappa (Debian package gappa).

A two-link arm with gravity is reduced to a smaller scene. What both answer differs by D, written
down here by hand from the textbook's formulas of a planar arm, with the numbers of both files:

    h = m2 l1 (x2 cos q2 - y2 sin q2)          J2 = I2 + m2 (x2^2 + y2^2)
    tau1 = (J1 + m2 l1^2 + J2 + 2 h) qdd1 + (J2 + h) qdd2 + h' (2 qd1 qd2 + qd2^2) + g1
    tau2 = (J2 + h) qdd1 + J2 qdd2 - h' qd1^2 + g2,   g2 = G m2 (x2 cos(q1 + q2) - y2 sin(q1 + q2))

Gappa knows no cosines: the ranges of q are cut into boxes, and of each box it is told in which
intervals cosines and sines lie. It proves |D_i| <= what `reduce` says, on each of them, over all qd
and qdd. A bound below the error that was seen must be refused.

usage: test_gappa.py DYNWITNESS          exit status 77: no gappa
"""
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from fractions import Fraction

SCENE = """gravity = [0, -9.81, 0]
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = 2
com = [0.25, 0, 0]
inertia = { yy = 0.06, zz = 0.06 }
[link.joint]
name = "shoulder"
kind = "revolute"
[[link]]
name = "fore"
parent = "upper"
mass = 0.5
com = [0.125, 0.004, 0]
inertia = { yy = 0.003, zz = 0.003 }
[link.joint]
name = "elbow"
kind = "revolute"
xyz = [0.5, 0, 0]
[envelope]
shoulder = { q = [-1, 1.5], qd = [-2, 2], qdd = [-5, 5] }
elbow = { q = [-2, 2], qd = [-3, 3], qdd = [-8, 8] }
"""
PIECES = 12  # of each joint's range: boxes of a fifth and a third of a radian


def numbers(text):
    """(m, x, y, I about the centre of mass) of both links, as exact fractions."""
    tree = tomllib.loads(text, parse_float=Fraction)
    out = []
    for link in tree["link"][1:]:
        com = [Fraction(x) for x in link.get("com", [0, 0, 0])]
        out.append((Fraction(link.get("mass", 0)), com[0], com[1],
                    Fraction(link.get("inertia", {}).get("zz", 0))))
    return out


def forces(links):
    """tau1 and tau2 as sums: {name of a function of the state: coefficient}."""
    (m1, x1, y1, i1), (m2, x2, y2, i2) = links
    l1, gravity = Fraction(1, 2), Fraction(981, 100)
    j1, j2 = i1 + m1 * (x1 * x1 + y1 * y1), i2 + m2 * (x2 * x2 + y2 * y2)
    hx, hy = m2 * l1 * x2, m2 * l1 * y2
    tip = {"c12": gravity * m2 * x2, "s12": -gravity * m2 * y2}
    tau1 = {"a1": j1 + m2 * l1 * l1 + j2, "c2 * (2 * a1 + a2)": hx, "s2 * (2 * a1 + a2)": -hy, "a2": j2,
            "s2 * (2 * v1 * v2 + v2 * v2)": -hx, "c2 * (2 * v1 * v2 + v2 * v2)": -hy,
            "c1": gravity * (m1 * x1 + m2 * l1), "s1": -gravity * m1 * y1, **tip}
    tau2 = {"a1": j2, "c2 * a1": hx, "s2 * a1": -hy, "a2": j2, "s2 * v1 * v1": hx, "c2 * v1 * v1": hy, **tip}
    return tau1, tau2


def difference(a, b):
    terms = [(function, a[function] - b[function]) for function in a if a[function] != b[function]]
    return " + ".join(f"({c.numerator} / {c.denominator}) * {f}" for f, c in terms) or "0 * v1"


def interval(function, low, high):
    """Where cos or sin of an angle in [low, high] lies, outward by far more than math's roundings."""
    first = 0 if function is math.cos else math.pi / 2  # where it is 1
    values = [function(low), function(high)]
    for k in range(-4, 5):
        if low <= first + k * math.pi <= high:
            values.append((-1) ** k)
    return f"[{min(values) - 1e-12:.15f}, {max(values) + 1e-12:.15f}]"


def proven(expressions, bounds, box):
    """Whether Gappa proves |D_i| <= bound for all i on this box in q."""
    angles = {"1": box[0], "2": box[1], "12": (box[0][0] + box[1][0], box[0][1] + box[1][1])}
    ranges = {"v1": "[-2, 2]", "v2": "[-3, 3]", "a1": "[-5, 5]", "a2": "[-8, 8]"}
    for name, (low, high) in angles.items():
        ranges["c" + name] = interval(math.cos, low, high)
        ranges["s" + name] = interval(math.sin, low, high)
    given = " /\\ ".join(f"{name} in {r}" for name, r in ranges.items())
    goals = " /\\ ".join(f"|d{i}| <= {b:.17g}" for i, b in enumerate(bounds))
    script = "".join(f"d{i} = {e};\n" for i, e in enumerate(expressions))
    script += f"{{ {given} -> {goals} }}\n"
    return subprocess.run(["gappa"], input=script, text=True, capture_output=True, check=False).returncode == 0


def pieces(low, high):
    edges = [low + (high - low) * k / PIECES for k in range(PIECES + 1)]
    return list(zip(edges, edges[1:]))


def main():
    if not shutil.which("gappa"):
        print("skipped: gappa is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        files = {name: os.path.join(folder, name) for name in ("scene.toml", "small.toml", "out.json")}
        with open(files["scene.toml"], "w", encoding="utf-8") as file:
            file.write(SCENE)
        subprocess.run([sys.argv[1], "reduce", files["scene.toml"], "--tolerance", "5%", "--json", files["out.json"],
                        "--toml", files["small.toml"]], check=True, stdout=subprocess.DEVNULL)
        with open(files["out.json"], encoding="utf-8") as file:
            model = json.load(file)["as_scenes"][0]
        with open(files["small.toml"], encoding="utf-8") as file:
            small = file.read()
    assert model["parameters_dropped"], "nothing was left out: nothing to prove"
    expressions = [difference(a, b) for a, b in zip(forces(numbers(SCENE)), forces(numbers(small)))]
    bounds = [force["error_at_most"] for force in model["forces"]]
    seen = [force["error_at_least"] for force in model["forces"]]
    boxes = [(a, b) for a in pieces(-1, 1.5) for b in pieces(-2, 2)]
    failed = [box for box in boxes if not proven(expressions, bounds, box)]
    print(f"left out: {[d['what'] for d in model['parameters_dropped']]}; |D| <= {bounds}: Gappa proves "
          f"{len(boxes) - len(failed)} of {len(boxes)} boxes")
    too_small = [0.99 * s for s in seen]
    refused = sum(not proven(expressions, too_small, box) for box in boxes)
    print(f"|D| <= {too_small}, which is less than was seen: refused on {refused} boxes")
    return 0 if not failed and refused > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
