#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Instructions a link, for few links and for many: making a scene, making its model, inverse and forward
dynamics must take as many for the 8000th link as for the 200th, within the factor that is asked of times.

    test_growth_counts.py PROGRAM

PROGRAM is count_growth, run here under valgrind's callgrind. Two sizes give what each link more takes; what
is there once drops out. Something quadratic that takes but three instructions a pair fails, if a link takes
as many as it does in a model. Exit status 77 (skipped) where there is no valgrind."""
import os
import shutil
import subprocess
import sys
import tempfile

from test_instruction_counts import inclusive, skip

FEW, MANY = (128, 256), (4096, 8192)
ALLOWED = 1.5
WORK = ["growth_scene", "growth_model", "growth_ID", "growth_FD"]


def counts(program, family, links):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "callgrind")
        # valgrind counts a byte stored by "rep stosb" as an instruction: memset is told to do without
        tunables = {"GLIBC_TUNABLES": "glibc.cpu.x86_rep_stosb_threshold=1000000000"}
        subprocess.run(["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={out}", program, family,
                        str(links)], check=True, stdout=subprocess.DEVNULL, env={**os.environ, **tunables})
        return inclusive(out)


def main():
    if not shutil.which("valgrind"):
        skip("valgrind is not installed")
    worse = 0
    for family in ["chain", "tree"]:
        measured = {links: counts(sys.argv[1], family, links) for links in FEW + MANY}
        for work in WORK:
            few, many = ((measured[b][work] - measured[a][work]) / (b - a) for a, b in (FEW, MANY))
            grown = many > ALLOWED * few
            worse += grown
            print(f"{family:6} {work:12} {few:9.0f} instructions a link at {FEW[1]} links {many:9.0f} at "
                  f"{MANY[1]}  x {many / few:.3f}" + ("  GROWN" if grown else ""))
    sys.exit(1 if worse else 0)


main()
