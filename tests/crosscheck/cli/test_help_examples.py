#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example that --help gives is run as it stands, in a folder with the files that it names.

    test_help_examples.py FOLDER_OF_PROGRAMS [COMMAND...] [--times]

Those of SLOW are not run, each for its reason; what is listed there and is no example is a fault, and so is a command
without an example that is not in WITHOUT."""
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PATIENCE = 120  # [s]
WITHOUT = {"scenes": "takes no scene", "version": "takes nothing"}

# seconds on an idle machine of two cores, or what is missing
SLOW = {
    "dynwitness museum": "a minute: the test museum_names_every_exhibit is this",
    "dynwitness chart franka_panda --quantity all -o charts": "half a minute of timing",
    "dynwitness chart double_pendulum --simulate -o charts": "half a minute of timing",
    "dynwitness drift double_pendulum --advise 0.001": "minutes: test_step_advice",
    "dynwitness envelope kuka_iiwa_14 --ratio 1.5": "a minute",
    "dynwitness growth --links 1000000 -o growth --json growth.json": "minutes and 3 GB",
    "dynwitness stability": "minutes",
    "dynwitness audit -o audit": "the test audit is this",
    "dynwitness crosscheck --mechanisms 1000": "minutes",
    "dynwitness reduce puma_560 --front front": "a minute",
    "dynwitness campaign nightly.toml -o nights": "a night",
    "dynwitness campaign nightly.toml --shard 3/8 -o nights": "an hour",
    "dynwitness campaign status nights": "of a night",
    "dynwitness campaign merge nights -o result": "of a night",
    "dynwitness campaign nightly.toml --on slurm --shards 200 -o nights": "there is no Slurm here",
}
# a fault is what these are there to find
FINDS = {
    'dynwitness check double_pendulum --answer "M12 = m2*l1*l2*cos(q2)/2"',
}

# what examples expect in their folder
PREPARED = {
    "crosscheck": ["dynwitness write double_pendulum --format urdf --lossy -o my_arm.urdf", "pendulum my_arm.py"],
    "check": ["states puma_560 6", "mv s.csv states.csv",
              "dynwitness evaluate puma_560 --states states.csv --quantity tau -o tau.csv",
              "echo 'g2 = 1/2*m2*g*l2*sin(q1 + q2)' > formulas.txt"],
    "grade": ["mkdir submissions", "cp data/engines/double_pendulum.py data/engines/dynwitness_engine.py submissions"],
    "evaluate": ["states acrobot 2", "dynwitness simulate puma_560 --duration 0.1 --step 0.01 --csv motion.csv",
                 "dynwitness evaluate humanoid_floating --random 3 --quantity M -o /dev/null",
                 "pinocchio_log"],
    "drift": ["dynwitness simulate double_pendulum --duration 0.2 --step 0.02 --csv coarse.csv",
              "dynwitness simulate double_pendulum --duration 0.2 --step 0.01 --csv fine.csv"],
    "readers": ["dynwitness write double_pendulum --format urdf --lossy -o my_arm.urdf",
                "dynwitness write double_pendulum --format mjcf --lossy -o my_arm.xml", "reader my_reader.py"],
    "same": ["dynwitness write double_pendulum --format urdf --lossy -o my_arm.urdf",
             "dynwitness write my_arm.urdf --format toml -o my_arm.toml", "cp my_arm.urdf old.urdf",
             "cp my_arm.urdf new.urdf"],
    "write": ["dynwitness write double_pendulum --format mjcf --lossy -o my_arm.xml"],
    "show": ["dynwitness write double_pendulum --format urdf --lossy -o my_arm.urdf"],
    "stability": ["pendulum my_arm.py"],
}
