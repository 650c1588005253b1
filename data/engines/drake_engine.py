# SPDX-License-Identifier: Apache-2.0
"""Drake's MultibodyPlant as a witness, for trees of revolute, prismatic and fixed joints. Written
against the interface of pydrake 1.x; NOT RUN yet (README.md).

    ./dynwitness crosscheck puma_560 --engine-memory 100000 --engine "python3 data/engines/drake_engine.py"

Drake's own: gravity is a force on the right-hand side, M vdot + C v = tau_g + tau. Its reflected
inertia belongs to actuators; rotors, springs and friction are added here in its place, so that qdd is
not answered where there are rotors.
"""
import numpy as np
from pydrake.all import (FixedOffsetFrame, MultibodyForces, MultibodyPlant, PrismaticJoint, RevoluteJoint,
                         RigidTransform, RotationalInertia, RotationMatrix, SpatialInertia, WeldJoint)

import dynwitness_engine


def transform(frame):
    return RigidTransform(RotationMatrix(np.array(frame["R"])), np.array(frame["p"]))


def engine(scene):
    if scene["wrenches"]:
        raise dynwitness_engine.Refused("constant wrenches")

    def plant_of(gravity):
        plant = MultibodyPlant(time_step=0.0)
        bodies, joints = [], []
        for k, link in enumerate(scene["links"]):
            I = np.array(link["inertia"])
            bodies.append(plant.AddRigidBody("link_%d" % k, SpatialInertia.MakeFromCentralInertia(
                link["mass"], np.array(link["com"]),
                RotationalInertia(I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]))))
            if link["parent"] < 0:
                plant.AddJoint(WeldJoint("root", plant.world_frame(), bodies[0].body_frame(),
                                         RigidTransform()))
                continue
            joint = link["joint"]
            if joint["kind"] not in ("fixed", "revolute", "prismatic") or joint["gyroscopic"]:
                raise dynwitness_engine.Refused("joint '%s': it knows fixed, revolute, prismatic, and no "
                                                "gyroscopic rotors" % joint["name"])
            on_parent = plant.AddFrame(FixedOffsetFrame("before_%d" % k, bodies[link["parent"]].body_frame(),
                                                        transform(joint["before"])))
            on_child = plant.AddFrame(FixedOffsetFrame("after_%d" % k, bodies[k].body_frame(),
                                                       transform(joint["after"]).inverse()))
            if joint["kind"] == "fixed":
                plant.AddJoint(WeldJoint("joint_%d" % k, on_parent, on_child, RigidTransform()))
                continue
            kind = RevoluteJoint if joint["kind"] == "revolute" else PrismaticJoint
            joints.append((joint, plant.AddJoint(kind("joint_%d" % k, on_parent, on_child,
                                                      np.array(joint["axis"])))))
        plant.mutable_gravity_field().set_gravity_vector(np.array(gravity))
        plant.Finalize()
        return plant, plant.CreateDefaultContext(), joints

    plant, context, joints = plant_of(scene["gravity"])
    n = scene["dof"]
    theirs = np.array([joint.velocity_start() for _, joint in joints], dtype=int)   # of ours
    rotors = np.array([j["gear_ratio"] ** 2 * j["rotor_inertia"] for j, _ in joints])

    def moved(q, qd=None):
        x, v = np.zeros(n), np.zeros(n)
        x[theirs] = q
        if qd is not None:
            v[theirs] = qd
        plant.SetPositions(context, x)
        plant.SetVelocities(context, v)

    def springs(q):
        return np.array([j["stiffness"] * (x - j["rest"]) for (j, _), x in zip(joints, q)])

    def friction(qd):
        return np.array([j["viscous"] * v + (j["coulomb"][0] if v > 0 else -j["coulomb"][1] if v < 0 else 0)
                         for (j, _), v in zip(joints, qd)])

    def M(q):
        moved(q)
        return plant.CalcMassMatrix(context)[np.ix_(theirs, theirs)] + np.diag(rotors)

    def c(q, qd):
        moved(q, qd)
        return plant.CalcBiasTerm(context)[theirs]

    def g(q):
        moved(q)
        return springs(q) - plant.CalcGravityGeneralizedForces(context)[theirs]

    def tau(q, qd, qdd):
        moved(q, qd)
        a = np.zeros(n)
        a[theirs] = qdd
        forces = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)   # gravity
        links = plant.CalcInverseDynamics(context, a, forces)[theirs]
        return links + rotors * np.array(qdd) + springs(q) + friction(qd)

    def potential(q):
        moved(q)
        return plant.CalcPotentialEnergy(context) + sum(
            j["stiffness"] * (x - j["rest"]) ** 2 / 2 for (j, _), x in zip(joints, q))

    def kinetic(q, qd):
        moved(q, qd)
        return plant.CalcKineticEnergy(context) + np.dot(rotors, np.square(qd)) / 2

    return {"M": M, "c": c, "g": g, "tau": tau, "potential": potential, "kinetic": kinetic}


dynwitness_engine.testify(engine, name="drake")
