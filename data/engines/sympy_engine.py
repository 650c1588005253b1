# SPDX-License-Identifier: Apache-2.0
"""Lagrange's equations by SymPy, turned into functions by its lambdify: any tree of a few revolute,
prismatic and fixed joints (three take seconds, six minutes). Run with SymPy 1.11.1 (README.md).

    ./dynwitness crosscheck planar_3r --engine "python3 data/engines/sympy_engine.py" --engine-seconds 60
"""
import sympy
from sympy import Matrix, cos, sin

import dynwitness_engine


def engine(scene):
    if scene["wrenches"]:
        raise dynwitness_engine.Refused("it knows no wrenches")
    n = scene["dof"]
    q, qd = sympy.symbols("q:%d" % n), sympy.symbols("qd:%d" % n)
    gravity = Matrix(scene["gravity"])
    frames, V = [], sympy.Integer(0)                     # of links: R, p, turns before it
    M = sympy.zeros(n, n)
    damping = [0] * n
    for link in scene["links"]:
        R, p, on = sympy.eye(3), sympy.zeros(3, 1), []   # on: (rate, axis) that turn it
        if link["parent"] >= 0:
            joint = link["joint"]
            if joint["kind"] not in ("fixed", "revolute", "prismatic") or joint["gyroscopic"]:
                raise dynwitness_engine.Refused("joint '%s': it knows fixed, revolute, prismatic, and "
                                                "no gyroscopic rotors" % joint["name"])
            R, p, on = frames[link["parent"]]
            before, after = joint["before"], joint["after"]
            p = p + R * Matrix(before["p"])
            R = R * Matrix(before["R"])
            if joint["rates"]:
                x, i = q[joint["q"]], joint["qd"]
                z = Matrix(joint["axis"])
                if joint["kind"] == "revolute":
                    K = Matrix([[0, -z[2], z[1]], [z[2], 0, -z[0]], [-z[1], z[0], 0]])
                    on = on + [(i, R * z)]
                    R = R * (sympy.eye(3) + sin(x) * K + (1 - cos(x)) * K * K)
                else:
                    p = p + R * z * x
                M[i, i] += joint["gear_ratio"] ** 2 * joint["rotor_inertia"]
                V += joint["stiffness"] * (x - joint["rest"]) ** 2 / 2
                positive, negative = joint["coulomb"]
                damping[i] = (joint["viscous"], positive, negative)
            p = p + R * Matrix(after["p"])
            R = R * Matrix(after["R"])
        frames.append((R, p, on))
        com = p + R * Matrix(link["com"])
        V -= link["mass"] * gravity.dot(com)
        if link["parent"] < 0:
            continue
        J = com.jacobian(q)
        W = sympy.zeros(3, n)                            # w = W qd
        for i, z in on:
            W[:, i] = z
        W = R.T * W
        M += link["mass"] * J.T * J + W.T * Matrix(link["inertia"]) * W
    c = [sum((M[i, j].diff(q[k]) - M[j, k].diff(q[i]) / 2) * qd[j] * qd[k]
             for j in range(n) for k in range(n)) for i in range(n)]
    g = [V.diff(x) for x in q]

    def made(arguments, expressions):
        return sympy.lambdify(arguments, expressions, "math", cse=True)

    M_of, c_of, g_of = made([q], M.tolist()), made([q, qd], c), made([q], g)
    V_of = made([q], V)

    def passive(v):
        return [viscous * x + (positive if x > 0 else -negative if x < 0 else 0)
                for (viscous, positive, negative), x in zip(damping, v)]

    def tau(q, qd, qdd):
        return [sum(m * a for m, a in zip(row, qdd)) + x + y + f
                for row, x, y, f in zip(M_of(q), c_of(q, qd), g_of(q), passive(qd))]

    return {"M": lambda q: M_of(q), "c": lambda q, qd: c_of(q, qd), "g": lambda q: g_of(q),
            "tau": tau, "potential": lambda q: V_of(q)}


if __name__ == "__main__":
    dynwitness_engine.testify(engine, name="sympy", version=sympy.__version__)
