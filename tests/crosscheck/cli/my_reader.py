# SPDX-License-Identifier: GPL-3.0-or-later
"""A reader that says of every robot that it cannot read it: what `readers --engine` has to survive in an example."""
import sys

sys.path.insert(0, "data/engines")
import dynwitness_engine  # noqa: E402


def engine(scene):
    raise dynwitness_engine.Refused("it reads none")


dynwitness_engine.testify(engine, name="my_reader")
