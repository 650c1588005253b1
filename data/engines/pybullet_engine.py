# SPDX-License-Identifier: Apache-2.0
"""PyBullet as a witness, for trees of revolute, prismatic and fixed joints on a fixed base. Written
against the interface of PyBullet 3.2; NOT RUN yet (README.md).

    ./dynwitness crosscheck puma_560 --engine-memory 100000 --engine "python3 data/engines/pybullet_engine.py"

PyBullet reads URDF alone, whose links begin at their joint: frames behind a joint are folded into what
comes after. Inertias are given by their principal axes, because Bullet keeps no others. Rotors, springs
and friction are the user's, and added here.
"""
import os
import tempfile

import numpy as np
import pybullet

import dynwitness_engine


def origin(R, p):
    """R = Rz(yaw) Ry(pitch) Rx(roll)."""
    flat = np.hypot(R[0, 0], R[1, 0])
    if flat > 1e-8:
        rpy = np.arctan2(R[2, 1], R[2, 2]), np.arctan2(-R[2, 0], flat), np.arctan2(R[1, 0], R[0, 0])
    else:
        rpy = 0.0, np.arctan2(-R[2, 0], flat), np.arctan2(-R[0, 1], R[1, 1])
    return '<origin xyz="%.17g %.17g %.17g" rpy="%.17g %.17g %.17g"/>' % (*p, *rpy)


def urdf(scene):
    after = []                               # of each link: its frame where URDF's begins
    text = '<robot name="scene">'
    for k, link in enumerate(scene["links"]):
        R, p = np.eye(3), np.zeros(3)
        if link["parent"] >= 0:
            joint = link["joint"]
            if joint["kind"] not in ("fixed", "revolute", "prismatic") or joint["gyroscopic"]:
                raise dynwitness_engine.Refused("joint '%s': it knows fixed, revolute, prismatic, and no "
                                                "gyroscopic rotors" % joint["name"])
            R_parent, p_parent = after[link["parent"]]
            before = joint["before"]
            text += '<joint name="joint_%d" type="%s"><parent link="link_%d"/><child link="link_%d"/>%s' % (
                k, "continuous" if joint["kind"] == "revolute" else joint["kind"], link["parent"], k,
                origin(R_parent @ np.array(before["R"]), p_parent + R_parent @ np.array(before["p"])))
            if joint["rates"]:
                text += '<axis xyz="%.17g %.17g %.17g"/><limit lower="-1e9" upper="1e9" effort="1e9" ' \
                        'velocity="1e9"/>' % tuple(joint["axis"])
            text += "</joint>"
            R, p = np.array(joint["after"]["R"]), np.array(joint["after"]["p"])
        after.append((R, p))
        moments, axes = np.linalg.eigh(R @ np.array(link["inertia"]) @ R.T)
        if np.linalg.det(axes) < 0:
            axes[:, 0] *= -1
        text += '<link name="link_%d"><inertial>%s<mass value="%.17g"/><inertia ixx="%.17g" iyy="%.17g" ' \
                'izz="%.17g" ixy="0" ixz="0" iyz="0"/></inertial></link>' % (
                    k, origin(axes, p + R @ np.array(link["com"])), link["mass"], *moments)
    return text + "</robot>"


def engine(scene):
    if scene["wrenches"]:
        raise dynwitness_engine.Refused("constant wrenches")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.urdf")
        with open(path, "w") as file:
            file.write(urdf(scene))
        body = pybullet.loadURDF(path, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
    joints = {link["joint"]["qd"]: ("joint_%d" % k, link["joint"])
              for k, link in enumerate(scene["links"]) if k > 0 and link["joint"]["rates"]}
    n = scene["dof"]
    moving = [info[1].decode() for info in map(lambda i: pybullet.getJointInfo(body, i),
                                               range(pybullet.getNumJoints(body))) if info[3] >= 0]
    theirs = [moving.index(joints[i][0]) for i in range(n)]     # of ours
    told = [joints[i][1] for i in range(n)]
    rotors = np.array([j["gear_ratio"] ** 2 * j["rotor_inertia"] for j in told])

    def in_theirs(v):
        out = [0.0] * n
        for i, k in enumerate(theirs):
            out[k] = v[i]
        return out

    def inverse(q, qd, qdd, gravity):
        pybullet.setGravity(*gravity)
        tau = pybullet.calculateInverseDynamics(body, in_theirs(q), in_theirs(qd), in_theirs(qdd))
        return np.array([tau[k] for k in theirs])

    def springs(q):
        return np.array([j["stiffness"] * (x - j["rest"]) for j, x in zip(told, q)])

    def friction(qd):
        return np.array([j["viscous"] * v + (j["coulomb"][0] if v > 0 else -j["coulomb"][1] if v < 0 else 0)
                         for j, v in zip(told, qd)])

    zeros = [0.0] * n

    def M(q):
        dense = np.array(pybullet.calculateMassMatrix(body, in_theirs(q)))
        return dense[np.ix_(theirs, theirs)] + np.diag(rotors)

    return {"M": M,
            "c": lambda q, qd: inverse(q, qd, zeros, [0, 0, 0]),
            "g": lambda q: inverse(q, zeros, zeros, scene["gravity"]) + springs(q),
            "tau": lambda q, qd, qdd: inverse(q, qd, qdd, scene["gravity"]) + rotors * np.array(qdd)
            + springs(q) + friction(qd)}


pybullet.connect(pybullet.DIRECT)
dynwitness_engine.testify(engine, name="pybullet", version=str(pybullet.getAPIVersion()))
