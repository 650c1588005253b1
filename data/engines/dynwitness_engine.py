# SPDX-License-Identifier: Apache-2.0
"""Your dynamics code as a witness of dynwitness (crosscheck/witnesses/engine_protocol.md).

    import dynwitness_engine

    def engine(scene):                      # once: what you need of the scene, a dictionary
        def tau(q, qd, qdd): ...            # called with the parts of the state that it names
        def M(q): ...
        return {"tau": tau, "M": M}         # what you know
    # reactions(q, qd, qdd): six a link but the root; jacobian(q, frame): of frame["link"] at frame["at"], six rows;
    # model(): [{"link": name, "mass": .., "com": .., "inertia": ..}, ..], what you take the links to be

    dynwitness_engine.testify(engine, name="my_arm", version="1")

Lists and numpy arrays will do. What you print goes to standard error.
"""
import inspect
import json
import math
import os
import sys


class Refused(Exception):
    """Raise it in engine(scene): you cannot hold this scene, and why."""


def _plain(value):
    """Lists and floats, all finite."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, dict):
        return {key: _plain(x) for key, x in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(x) for x in value]
    value = float(value)
    if not math.isfinite(value):
        raise ArithmeticError("not finite: %r" % value)
    return value


def testify(engine, name="", version="", **introduction):
    """Answers until there are no more questions.

    introduction: joints=[...], your order of the joints' names; quaternion="xyzw", if that is yours.
    What engine(scene) returns as "shows" is no function: what a reader of scene["file"] has read.
    """
    out = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)  # what is printed is no answer

    def say(message):
        out.write(json.dumps(message, allow_nan=False) + "\n")
        out.flush()

    known = {}
    for line in sys.stdin:
        asked = json.loads(line)
        if "scene" in asked:
            said = {"protocol": 1, "name": name, "version": version, **introduction}
            try:
                functions = dict(engine(asked["scene"]))
                if "shows" in functions:
                    said["shows"] = functions.pop("shows")
                if "model" in functions:
                    said["model"] = [dict(_plain({k: link[k] for k in link if k != "link"}), link=link["link"])
                                     for link in functions.pop("model")()]
                known = {quantity: (f, list(inspect.signature(f).parameters)) for quantity, f in functions.items()}
                said["quantities"] = [quantity for quantity in known if quantity in asked.get("asks", known)]
            except Refused as reason:
                said["refuses"] = str(reason)
            say(said)
            continue
        answers = []
        for state in asked["states"]:
            answer, state["frame"] = {}, asked.get("frame")
            for quantity in asked["quantities"]:
                f, parts = known[quantity]
                try:
                    answer[quantity] = _plain(f(*(state[part] for part in parts)))
                except ArithmeticError as reason:  # a state where it has no value
                    answer[quantity] = str(reason)
            answers.append(answer)
        say({"batch": asked["batch"], "answers": answers})
