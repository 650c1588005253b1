# SPDX-License-Identifier: GPL-3.0-or-later
"""A reader of robots with one hinge about x, as a program: reader.py MODE, for test_programs.cpp.

shows: link by link; answers: M and g alone; tau: that alone; forgets: the rpy of <inertial>, M and g alone;
ignores: takes the numbers that crosscheck gives; refuses, nonsense, dies, floods, order: as the words say.
"""
import math
import sys
import xml.etree.ElementTree

sys.path.insert(0, sys.argv[2])
import dynwitness_engine  # noqa: E402

mode = sys.argv[1]


def engine(scene):
    if mode == "refuses":
        raise dynwitness_engine.Refused("it is Tuesday")
    if mode == "dies":
        sys.exit("I give up")
    if mode == "ignores":
        mass = scene["links"][1]["mass"]
        return {"M": lambda q: mass}
    robot = xml.etree.ElementTree.parse(scene["file"]).getroot()
    link = robot.findall("link")[1]
    numbers = lambda name, key: [float(x) for x in link.find("inertial/" + name).get(key, "0 0 0").split()]
    mass, = numbers("mass", "value")
    x, y, z = numbers("origin", "xyz")
    yaw = numbers("origin", "rpy")[2]
    (ixx,), (iyy,), (izz,) = (numbers("inertia", key) for key in ("ixx", "iyy", "izz"))
    c, s = math.cos(yaw), math.sin(yaw)
    if mode == "forgets":
        c, s = 1, 0
    # R diag(ixx, iyy, izz) R' with R about z
    I = [[c * c * ixx + s * s * iyy, c * s * (ixx - iyy), 0], [c * s * (ixx - iyy), s * s * ixx + c * c * iyy, 0],
         [0, 0, izz]]
    about_hinge = I[0][0] + mass * (y * y + z * z)

    def g(q):
        return [9.81 * mass * (y * math.cos(q[0]) - z * math.sin(q[0]))]

    def M(q):
        return [[about_hinge]]

    if mode == "tau":
        return {"tau": lambda q, qdd: [about_hinge * qdd[0] + g(q)[0]]}
    if mode == "shows":
        one = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        nothing = {"mass": 0, "com": [0, 0, 0], "inertia": [[0, 0, 0]] * 3}
        hinge = {"name": "hinge", "kind": "revolute", "axis": [1, 0, 0], "before": {"R": one, "p": [0, 0, 0]}}
        return {"M": M, "g": g, "shows": {
            "gravity": [0, 0, -9.81], "told": ["of the test"],
            "links": [{"name": "base", "parent": -1, **nothing},
                      {"name": "a", "parent": 0, "joint": hinge, "mass": mass, "com": [x, y, z], "inertia": I}]}}
    return {"M": M, "g": g}


if mode == "nonsense":
    print("hello")
elif mode == "order":
    dynwitness_engine.testify(engine, joints=["elbow"])
else:
    dynwitness_engine.testify(engine, name="test", version="7")
