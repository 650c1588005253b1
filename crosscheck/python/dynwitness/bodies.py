# SPDX-License-Identifier: GPL-3.0-or-later
"""A robot as the numbers that code by hand needs: what each link weighs, and how it is joined to its parent.

They are asked of the scene by two roads that hold no dynamics: the program's `show` (masses, centres, inertias)
and the module's kinematics at q = 0 (where links are, and how each moves when its own joint does).
"""
import json
from typing import NamedTuple

import numpy as np

from . import program

# of these the motion subspace stays the same in the link's own axes
KINDS = ("fixed", "revolute", "prismatic", "helical")


class Body(NamedTuple):
    """One link and the joint that holds it. Everything in the axes of the link, at its origin, but R0, p0."""

    name: str
    parent: int          # index in the list, -1: the ground
    q: int               # which of q, qd, qdd, tau is its joint's; -1: fixed to its parent
    R0: np.ndarray       # (3, 3), link to parent axes at q = 0
    p0: np.ndarray       # (3,) [m], its origin in the parent's axes at q = 0
    S: np.ndarray        # (6,), velocity (v, w) of the link for a rate of 1
    mass: float          # [kg]
    com: np.ndarray      # (3,) [m]
    inertia: np.ndarray  # (3, 3) about the centre of mass [kg m^2]
    rotor: float         # gear_ratio^2 rotor_inertia, felt by the joint [kg m^2]
    spring: float        # stiffness at the joint [N m/rad, N/m], 0 for none
    rest: float          # its q without force


class Bodies(list):
    """A list of Body, parents first, and gravity (3,) [m/s^2] in world axes."""

    gravity: np.ndarray


def bodies(scene):
    """The links of a tree of revolute, prismatic, helical and fixed joints as Bodies, a list of Body, parents first.

    scene: a Scene, or what load() takes. Raises ValueError for other joints, followers and gyroscopic rotors. Friction
    and loads are not told.
    """
    from . import load
    scene = scene if hasattr(scene, "toml") else load(str(scene))
    with program._Files() as files:
        shown = json.loads(program.run("show", files.scene(scene), "--format", "json"))
    joints = {joint["child"]: joint for joint in shown["joints"]}
    zero, result, index = np.zeros(scene.nq), Bodies(), {}
    result.gravity = np.array(shown["gravity"] or np.zeros(3))
    for link in shown["links"]:
        joint = joints.get(link["name"])
        if joint is None:  # the ground
            index[link["name"]] = -1
            continue
        if joint["kind"] not in KINDS or joint["follows"] or joint["rotor"]["gyroscopic"]:
            raise ValueError(f"scene: joint {joint['name']} of {scene.name} is {joint['kind']}, allowed: "
                             f"{', '.join(KINDS)}, without followers and gyroscopic rotors")
        q = int(joint["qd"][0][2:]) - 1 if joint["qd"] else -1
        R, R_parent = (scene.rotation(name, zero) for name in (link["name"], joint["parent"]))
        p, p_parent = (scene.position(name, zero) for name in (link["name"], joint["parent"]))
        S = np.zeros(6)
        if q >= 0:
            column = scene.jacobian(link["name"], zero)[:, q]
            S = np.round(np.concatenate([R.T @ column[:3], R.T @ column[3:]]), 15) + 0.0
        I = link["inertia"]
        inertia = np.array([[I["xx"], I["xy"], I["xz"]], [I["xy"], I["yy"], I["yz"]], [I["xz"], I["yz"], I["zz"]]])
        rotor = joint["rotor"]["inertia"] * joint["rotor"]["gear_ratio"] ** 2
        index[link["name"]] = len(result)
        result.append(Body(link["name"], index[joint["parent"]], q, R_parent.T @ R, R_parent.T @ (p - p_parent), S,
                           link["mass"], np.array(link["com"]), inertia, rotor,
                           joint["spring"]["stiffness"], joint["spring"]["rest"]))
    return result
