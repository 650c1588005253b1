# SPDX-License-Identifier: Apache-2.0
"""Recursive Newton-Euler for any open chain or tree of revolute, prismatic and fixed joints, as a
student writes it down: plain Python, vectors in the axes of their link."""
from math import cos, sin

import dynwitness_engine


def add(*vectors):
    return [sum(x) for x in zip(*vectors)]


def scaled(k, v):
    return [k * x for x in v]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def times(R, v):
    return [dot(row, v) for row in R]


def transposed(R):
    return [list(column) for column in zip(*R)]


def product(A, B):
    return [[dot(row, column) for column in transposed(B)] for row in A]


def turn(axis, angle):
    """Rodrigues: a turn about a unit vector."""
    x, y, z = axis
    C, S = cos(angle), sin(angle)
    K = 1 - C
    return [[C + x * x * K, x * y * K - z * S, x * z * K + y * S],
            [x * y * K + z * S, C + y * y * K, y * z * K - x * S],
            [x * z * K - y * S, y * z * K + x * S, C + z * z * K]]


def engine(scene):
    links, n, gravity = scene["links"], scene["dof"], scene["gravity"]
    if scene["wrenches"]:
        raise dynwitness_engine.Refused("it knows no wrenches")
    for link in links[1:]:
        joint = link["joint"]
        if joint["kind"] not in ("fixed", "revolute", "prismatic"):
            raise dynwitness_engine.Refused(
                "joint '%s' is %s, it knows fixed, revolute, prismatic" % (joint["name"], joint["kind"]))
        if joint["gyroscopic"]:
            raise dynwitness_engine.Refused("it knows no gyroscopic rotors")
    moving = [link["joint"] for link in links[1:] if link["joint"]["rates"] == 1]
    zeros = [0.0] * n

    def place(joint, q):
        """Of the link in its parent: R, p; r from the joint to the link's origin; the axis z; and
        the moved joint's origin in the parent."""
        Rb, pb = joint["before"]["R"], joint["before"]["p"]
        Ra, pa = joint["after"]["R"], joint["after"]["p"]
        origin, R = pb, Rb
        if joint["kind"] == "revolute":
            R = product(Rb, turn(joint["axis"], q[joint["q"]]))
        if joint["kind"] == "prismatic":
            origin = add(pb, times(Rb, scaled(q[joint["q"]], joint["axis"])))
        back = transposed(Ra)
        z = times(back, joint["axis"]) if joint["rates"] else None
        return product(R, Ra), add(origin, times(R, pa)), times(back, pa), z, origin

    def passed(q, qd, qdd, gravity):
        """Where the links are in their parents, and force and moment (about the link's origin) that
        each needs from its parent, in its axes."""
        where, w, wd, a = [None], [[0.0] * 3], [[0.0] * 3], [scaled(-1, gravity)]
        for link in links[1:]:                       # outward: motion
            joint, p = link["joint"], link["parent"]
            where.append(place(joint, q))
            R, _, r, z, origin = where[-1]
            back = transposed(R)
            wi, wdi = times(back, w[p]), times(back, wd[p])
            aj = times(back, add(a[p], cross(wd[p], origin), cross(w[p], cross(w[p], origin))))
            if joint["kind"] == "revolute":
                rate = scaled(qd[joint["qd"]], z)
                wdi = add(wdi, scaled(qdd[joint["qd"]], z), cross(wi, rate))
                wi = add(wi, rate)
            if joint["kind"] == "prismatic":
                aj = add(aj, scaled(qdd[joint["qd"]], z), cross(wi, scaled(2 * qd[joint["qd"]], z)))
            w.append(wi)
            wd.append(wdi)
            a.append(add(aj, cross(wdi, r), cross(wi, cross(wi, r))))
        f, m = [[0.0] * 3 for _ in links], [[0.0] * 3 for _ in links]
        for i in range(len(links) - 1, 0, -1):       # inward: forces
            link, p = links[i], links[i]["parent"]
            com, I = link["com"], link["inertia"]
            ac = add(a[i], cross(wd[i], com), cross(w[i], cross(w[i], com)))
            F = scaled(link["mass"], ac)
            N = add(times(I, wd[i]), cross(w[i], times(I, w[i])))
            f[i] = add(f[i], F)
            m[i] = add(m[i], N, cross(com, F))
            R, position = where[i][:2]
            f_parent = times(R, f[i])
            f[p] = add(f[p], f_parent)
            m[p] = add(m[p], times(R, m[i]), cross(position, f_parent))
        return where, f, m

    def sweep(q, qd, qdd, gravity):
        """Forces of links alone: M qdd + c, and g where there is gravity."""
        where, f, m = passed(q, qd, qdd, gravity)
        tau = list(zeros)
        for i, link in enumerate(links[1:], 1):
            joint, (_, _, r, z, _) = link["joint"], where[i]
            if joint["kind"] == "revolute":
                tau[joint["qd"]] = dot(z, add(m[i], cross(r, f[i])))
            if joint["kind"] == "prismatic":
                tau[joint["qd"]] = dot(z, f[i])
        return tau

    def reactions(q, qd, qdd):
        """About the moved joint frame's origin, in its axes."""
        where, f, m = passed(q, qd, qdd, gravity)
        rows = []
        for i, link in enumerate(links[1:], 1):
            R, r = link["joint"]["after"]["R"], where[i][2]
            rows.append(times(R, f[i]) + times(R, add(m[i], cross(r, f[i]))))
        return rows

    def rotor(joint):
        return joint["gear_ratio"] ** 2 * joint["rotor_inertia"]

    def friction(joint, rate):
        positive, negative = joint["coulomb"]
        return joint["viscous"] * rate + (positive if rate > 0 else -negative if rate < 0 else 0)

    def M(q):
        columns = []
        for k, joint in enumerate(moving):
            columns.append(sweep(q, zeros, [float(i == k) for i in range(n)], [0, 0, 0]))
            columns[k][k] += rotor(joint)
        return transposed(columns)

    def c(q, qd):
        return sweep(q, qd, zeros, [0, 0, 0])

    def g(q):
        return [force + joint["stiffness"] * (x - joint["rest"])
                for force, joint, x in zip(sweep(q, zeros, zeros, gravity), moving, q)]

    def tau(q, qd, qdd):
        return [force + rotor(j) * acceleration + j["stiffness"] * (x - j["rest"]) + friction(j, rate)
                for force, j, x, rate, acceleration
                in zip(sweep(q, qd, qdd, gravity), moving, q, qd, qdd)]

    def qdd(q, qd, tau_given):
        A = M(q)
        x = [a - b for a, b in zip(tau_given, tau(q, qd, zeros))]
        for k in range(n):                           # A = L D L'
            if A[k][k] == 0:
                raise ArithmeticError("M is singular")
            for i in range(k + 1, n):
                l = A[i][k] / A[k][k]
                x[i] -= l * x[k]
                for j in range(k + 1, n):
                    A[i][j] -= l * A[k][j]
        for k in range(n - 1, -1, -1):
            x[k] = (x[k] - sum(A[k][j] * x[j] for j in range(k + 1, n))) / A[k][k]
        return x

    def kinetic(q, qd):
        return dot(qd, times(M(q), qd)) / 2

    def world(q):
        """R, p of every link."""
        frames = [([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0])]
        for link in links[1:]:
            R, p = frames[link["parent"]]
            R_here, p_here = place(link["joint"], q)[:2]
            frames.append((product(R, R_here), add(p, times(R, p_here))))
        return frames

    def jacobian(q, frame):
        """z x (p - p_joint) and z, joint by joint from the link inward."""
        frames, J = world(q), [[0.0] * n for _ in range(6)]
        i = frame["link"]
        R, p = frames[i]
        point = add(p, times(R, frame["at"]))
        while i > 0:
            joint, parent = links[i]["joint"], links[i]["parent"]
            if joint["rates"]:
                _, _, _, z, origin = place(joint, q)
                z, (R, p) = times(frames[i][0], z), frames[parent]
                arm = add(point, scaled(-1, add(p, times(R, origin))))
                column = cross(z, arm) + z if joint["kind"] == "revolute" else z + [0.0] * 3
                for row, x in zip(J, column):
                    row[joint["qd"]] = x
            i = parent
        return J

    def model():
        return [{key: link[key] for key in ("mass", "com", "inertia")} | {"link": link["name"]} for link in links[1:]]

    def potential(q):
        V = 0.0
        for link, (R, p) in zip(links, world(q)):
            V -= link["mass"] * dot(gravity, add(p, times(R, link["com"])))
        return V + sum(j["stiffness"] * (x - j["rest"]) ** 2 / 2 for j, x in zip(moving, q))

    return {"M": M, "c": c, "g": g, "tau": tau,
            "qdd": lambda q, qd, tau: qdd(q, qd, tau), "kinetic": kinetic, "potential": potential,
            "reactions": reactions, "jacobian": jacobian, "model": model}


if __name__ == "__main__":
    dynwitness_engine.testify(engine, name="open_chain_in_python", version="1")
