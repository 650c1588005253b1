# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets functions of the notebooks testify: what `dynwitness grade` starts with the rubrics in rubrics/.

    python3 hand_in.py answers.py      in a folder that holds by_hand.py and dynwitness_engine.py as well

answers.py has one or more of these functions, with the arguments that it names; gravity is (3,) [m/s^2], world axes:
tau(bodies, q, qd, qdd, gravity), qdd(bodies, q, qd, tau, gravity), M(bodies, q), c(bodies, q, qd), g(bodies, q, gravity),
potential(bodies, q), kinetic(bodies, q, qd), momentum(bodies, q, qd), jacobian(bodies, q, k, at): of body k's point `at`."""
import importlib.util
import inspect
import sys
from collections import namedtuple

import dynwitness_engine
import numpy as np

Body = namedtuple("Body", "name parent q R0 p0 S mass com inertia rotor spring rest")
ASKED = ("tau", "qdd", "M", "c", "g", "potential", "kinetic", "momentum", "jacobian")


class Bodies(list):
    """A list of Body, and gravity (3,) [m/s^2]."""


def bodies_of(scene):
    """The scene of the protocol as the bodies that the notebooks know."""
    result = Bodies()
    result.gravity = np.array(scene["gravity"], float)
    for link in scene["links"][1:]:
        joint = link["joint"]
        if joint["kind"] not in ("fixed", "revolute", "prismatic") or joint["gyroscopic"]:
            raise dynwitness_engine.Refused(f"joint {joint['name']} is {joint['kind']}")
        before, after = ([np.array(joint[side][x], float) for x in "Rp"] for side in ("before", "after"))
        S = np.zeros(6)
        if joint["rates"]:
            axis = after[0].T @ np.array(joint["axis"], float)
            S[3:] = axis if joint["kind"] == "revolute" else 0
            S[:3] = np.cross(axis, after[0].T @ after[1]) if joint["kind"] == "revolute" else axis
        rotor = joint["gear_ratio"] ** 2 * joint["rotor_inertia"] if joint["rates"] else 0.0
        result.append(Body(link["name"], link["parent"] - 1, joint["q"] if joint["rates"] else -1,
                           before[0] @ after[0], before[1] + before[0] @ after[1], S, link["mass"],
                           np.array(link["com"], float), np.array(link["inertia"], float), rotor,
                           joint.get("stiffness", 0.0), joint.get("rest", 0.0)))
    return result


def engine(scene):
    bodies = bodies_of(scene)
    gravity = bodies.gravity

    def ask(function):
        """The function with what the protocol gives: a state's parts, and the frame of a Jacobian."""
        names = [name for name in inspect.signature(function).parameters if name not in ("bodies", "gravity")]
        asked = [name for name in names if name not in ("k", "at")] + (["frame"] if "k" in names else [])
        last = (gravity,) if "gravity" in inspect.signature(function).parameters else ()

        def answer(*values):
            frame = values[-1] if "k" in names else None
            state = [np.array(value, float) for value in (values[:-1] if frame else values)]
            if frame:
                state += [frame["link"] - 1, np.array(frame["at"], float)]
            return function(bodies, *state, *last)

        answer.__signature__ = inspect.Signature(
            [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in asked])
        return answer

    return {name: ask(getattr(answers, name)) for name in ASKED if hasattr(answers, name)}


if __name__ == "__main__":
    there = importlib.util.spec_from_file_location("answers", sys.argv[1])
    answers = importlib.util.module_from_spec(there)
    there.loader.exec_module(answers)
    dynwitness_engine.testify(engine, name="hand_in")
