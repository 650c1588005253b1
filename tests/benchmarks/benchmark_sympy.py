# SPDX-License-Identifier: GPL-3.0-or-later
"""SymPy derives the equations of motion of a scene by Kane's method, for `./dynwitness bench`.

usage: benchmark_sympy.py SCENE.toml Q1,Q2,... QD1,QD2,...

For open chains of revolute joints in modified Denavit-Hartenberg rows, with inertias about the
centres of mass. Prints one JSON object: CPU seconds from the model to M and c + g as SymPy gives them,
and for taking common sub-expressions out of them; operations that are left; M (row by row) and c + g at
the state [SI].
"""
import json
import sys
import time
import tomllib

import sympy
from sympy.physics import mechanics


def number(value):
    """The exact number that a scene writes: decimals are rationals, "pi/2" is what it says."""
    return sympy.nsimplify(value, rational=True) if isinstance(value, float) else sympy.sympify(value)


def derive(scene):
    """M and -(c + g) of M qdd = -(c + g), in q and qd."""
    world = mechanics.ReferenceFrame("N")
    origin = mechanics.Point("O")
    origin.set_vel(world, 0)
    frame, point, at = world, origin, {scene["link"][0]["name"]: (world, origin)}
    q, qd, bodies, loads = [], [], [], []
    gravity = sum((number(g) * axis for g, axis in zip(scene["gravity"], world)), mechanics.Vector(0))
    for i, link in enumerate(scene["link"][1:], 1):
        joint, row = link["joint"], link["joint"]["mdh"]
        if joint["kind"] != "revolute":
            raise SystemExit(f"{joint['name']}: {joint['kind']}, expected revolute joints only")
        q.append(mechanics.dynamicsymbols(f"q{i}"))
        qd.append(mechanics.dynamicsymbols(f"u{i}"))
        parent_frame, parent = at[link["parent"]]
        twisted = parent_frame.orientnew(f"T{i}", "Axis", [number(row.get("alpha", 0)), parent_frame.x])
        frame = twisted.orientnew(f"L{i}", "Axis", [number(row.get("theta", 0)) + q[-1], twisted.z])
        frame.set_ang_vel(world, parent_frame.ang_vel_in(world) + qd[-1] * twisted.z)
        point = parent.locatenew(f"O{i}", number(row.get("a", 0)) * twisted.x
                                 + number(row.get("d", 0)) * twisted.z)
        point.v2pt_theory(parent, world, parent_frame)
        at[link["name"]] = frame, point
        com = point.locatenew(f"C{i}", sum((number(c) * axis for c, axis in zip(link["com"], frame)),
                                           mechanics.Vector(0)))
        com.v2pt_theory(point, world, frame)
        inertia = {key: number(value) for key, value in link["inertia"].items() if key != "about"}
        if link["inertia"]["about"] != "com":
            raise SystemExit(f"{link['name']}: expected an inertia about the centre of mass")
        dyadic = mechanics.inertia(frame, *(inertia.get(k, 0) for k in ("xx", "yy", "zz", "xy", "yz", "xz")))
        bodies.append(mechanics.RigidBody(link["name"], com, frame, number(link["mass"]), (dyadic, com)))
        loads.append((com, number(link["mass"]) * gravity))
    kane = mechanics.KanesMethod(world, q_ind=q, u_ind=qd,
                                 kd_eqs=[u - p.diff() for u, p in zip(qd, q)])
    kane.kanes_equations(bodies, loads)
    return q, qd, kane.mass_matrix, kane.forcing


def main():
    file, q_text, qd_text = sys.argv[1:]
    with open(file, "rb") as text:
        scene = tomllib.load(text)
    start = time.process_time()
    q, qd, mass_matrix, forcing = derive(scene)
    derived = time.process_time() - start
    shared, reduced = sympy.cse([mass_matrix, forcing])
    shortened = time.process_time() - start - derived
    operations = sum(sympy.count_ops(e) for _, e in shared) + sum(sympy.count_ops(e) for e in reduced)
    values = [float(x) for text in (q_text, qd_text) for x in text.split(",")]
    evaluate = sympy.lambdify(q + qd, sympy.Matrix([*mass_matrix, *forcing]), "mpmath", cse=True)
    entries = [float(x) for x in evaluate(*values)]
    n = len(q)
    print(json.dumps({"version": sympy.__version__, "derivation_s": derived, "sharing_s": shortened,
                      "operations": int(operations), "M": entries[:n * n],
                      "bias": [-x for x in entries[n * n:]]}))


main()
