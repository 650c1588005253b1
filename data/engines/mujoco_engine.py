# SPDX-License-Identifier: Apache-2.0
"""MuJoCo's Python package as a witness, for trees of revolute, prismatic, spherical and fixed joints.
Written against the interface of mujoco 3.1; NOT RUN yet: mujoco_engine.mjs, which says the same to the
package of npm, was (README.md).

    ./dynwitness crosscheck puma_560 --engine-memory 100000 --engine "python3 data/engines/mujoco_engine.py"

Rotors are `armature`, springs `stiffness` and `springref`, viscous friction `damping`; contacts and
constraints are off.
"""
import mujoco
import numpy as np

import dynwitness_engine

KINDS = {"revolute": "hinge", "prismatic": "slide", "spherical": "ball"}


def text(numbers):
    return " ".join("%.17g" % x for x in np.ravel(numbers))


def mjcf(scene, gravity):
    def body(k, R, p):                       # R, p: of the parent's link in the body around this one
        link = scene["links"][k]
        joint = link["joint"]
        before, after = joint["before"], joint["after"]
        p = p + R @ np.array(before["p"])
        R = R @ np.array(before["R"])
        out = '<body pos="%s" xyaxes="%s">' % (text(p), text([R[:, 0], R[:, 1]]))
        if joint["kind"] != "fixed":
            if joint["kind"] not in KINDS or joint["gyroscopic"] or any(joint["coulomb"]):
                raise dynwitness_engine.Refused("joint '%s': it knows %s, and neither gyroscopic rotors nor "
                                                "Coulomb friction" % (joint["name"], ", ".join(KINDS)))
            out += '<joint type="%s" axis="%s" armature="%.17g" damping="%.17g" stiffness="%.17g" ' \
                   'springref="%.17g"/>' % (KINDS[joint["kind"]], text(joint.get("axis", [0, 0, 1])),
                                            joint["gear_ratio"] ** 2 * joint["rotor_inertia"],
                                            joint["viscous"], joint["stiffness"], joint["rest"])
        R, p = np.array(after["R"]), np.array(after["p"])
        I = R @ np.array(link["inertia"]) @ R.T
        diagonal, products = np.diag(I), [I[0, 1], I[0, 2], I[1, 2]]
        if link["mass"] > 0:                 # a full one is taken apart into principal axes, which loses digits
            out += '<inertial pos="%s" mass="%.17g" %s/>' % (
                text(p + R @ np.array(link["com"])), link["mass"],
                'fullinertia="%s"' % text([*diagonal, *products]) if np.any(products)
                else 'diaginertia="%s"' % text(diagonal))
        return out + children(k, R, p) + "</body>"

    def children(k, R, p):
        return "".join(body(i, R, p) for i, link in enumerate(scene["links"]) if link["parent"] == k)

    return '<mujoco><compiler angle="radian"/><option gravity="%s"><flag contact="disable" ' \
           'constraint="disable" energy="enable"/></option><worldbody>%s</worldbody></mujoco>' % (
               text(gravity), children(0, np.eye(3), np.zeros(3)))


def engine(scene):
    if scene["wrenches"]:
        raise dynwitness_engine.Refused("constant wrenches")

    def loaded(gravity):
        try:
            model = mujoco.MjModel.from_xml_string(mjcf(scene, gravity))
        except ValueError as problem:
            raise dynwitness_engine.Refused(str(problem).splitlines()[0])
        return model, mujoco.MjData(model)

    heavy, weightless = loaded(scene["gravity"]), loaded([0, 0, 0])
    n, root = scene["dof"], scene["links"][0]
    springs = [(link["joint"]["qd"], link["joint"]["q"], link["joint"]["stiffness"], link["joint"]["rest"])
               for link in scene["links"][1:] if link["joint"]["stiffness"] != 0]

    def forward(which, q, qd, tau=None):
        model, data = which
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, qd, 0 if tau is None else tau
        mujoco.mj_forward(model, data)
        return data

    def M(q):
        data, out = forward(heavy, q, np.zeros(n)), np.zeros((n, n))
        mujoco.mj_fullM(heavy[0], out, data.qM)
        return out

    def g(q):
        out = forward(heavy, q, np.zeros(n)).qfrc_bias.copy()
        for i, k, stiffness, rest in springs:
            out[i] += stiffness * (q[k] - rest)
        return out

    def tau(q, qd, qdd):
        model, data = heavy
        data.qpos[:], data.qvel[:], data.qacc[:], data.qfrc_applied[:] = q, qd, qdd, 0
        mujoco.mj_inverse(model, data)
        return data.qfrc_inverse.copy()

    def potential(q):                        # MuJoCo's world has no mass
        return forward(heavy, q, np.zeros(n)).energy[0] - root["mass"] * np.dot(root["com"], scene["gravity"])

    return {"M": M, "g": g, "tau": tau, "potential": potential,
            "c": lambda q, qd: forward(weightless, q, qd).qfrc_bias.copy(),
            "qdd": lambda q, qd, tau: forward(heavy, q, qd, tau).qacc.copy(),
            "kinetic": lambda q, qd: forward(heavy, q, qd).energy[1]}


if __name__ == "__main__":
    dynwitness_engine.testify(engine, name="mujoco_python", version=mujoco.__version__)
