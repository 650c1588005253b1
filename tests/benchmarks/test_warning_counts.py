#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How many instructions more a sweep takes that says what rounding may have made of its answer.

    test_warning_counts.py PROGRAM

PROGRAM is count_warnings, run here under valgrind's callgrind. More than a tenth of the sweep's own is a
failure, but where MORE_THAN_A_TENTH names it with what was seen: there not more than that. Exit status 77
(skipped), with the reason, without valgrind."""
import os
import shutil
import subprocess
import sys
import tempfile

from test_instruction_counts import inclusive, skip

SCENES = ["simple_pendulum", "double_pendulum", "franka_panda", "puma_560", "humanoid_floating"]
CALLS = 20
SWEEPS = ["fast_ID", "fast_M", "fast_FD", "sweep_ID", "sweep_FD", "solved_FD"]
# As seen: 10.6, 13.7, 9.8 and 10.7 % (10.2, 13.7, 10.1 and 11.0 before a change of recursive/fast/, which these do not
# call: what g++ inlines hangs on what else is in a file). A whole sweep over one joint takes 817 to 1406 instructions, and the estimate's
# calls, its one pass over the rates and its division 83 (tau) to 141 (qdd): registers saved and a handful of sums, which
# are not fewer for one joint. The rare road behind it in a function of its own, so that it takes no registers here, is 2
# to 5 more.
MORE_THAN_A_TENTH = {("simple_pendulum", "sweep_ID"): 0.11, ("simple_pendulum", "sweep_FD"): 0.14,
                     ("simple_pendulum", "solved_FD"): 0.105, ("double_pendulum", "solved_FD"): 0.115}


def measure(program, scene):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "callgrind")
        subprocess.run(["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={out}", program, str(CALLS),
                        scene], check=True, stdout=subprocess.DEVNULL)
        return inclusive(out)


def main():
    if not shutil.which("valgrind"):
        skip("valgrind is not installed")
    dear = 0
    for scene in SCENES:
        counts = measure(sys.argv[1], scene)
        for sweep in SWEEPS:
            if f"plain_{sweep}" not in counts:  # of few joints: count_warnings.cpp
                continue
            plain, warned = (counts[name] for name in (f"plain_{sweep}", f"warned_{sweep}"))
            more = warned / plain - 1
            is_dear = more > MORE_THAN_A_TENTH.get((scene, sweep), 0.10)
            dear += is_dear
            print(f"{scene:18} {sweep:9} {plain / CALLS:9.0f} and {100 * more:5.1f} % more"
                  + ("  TOO MANY" if is_dear else ""))
    sys.exit(1 if dear else 0)


if __name__ == "__main__":
    main()
