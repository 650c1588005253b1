#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Instructions a call of the fast sweeps, beside those on record: a time on a shared machine says little,
a count says the same every time.

    test_instruction_counts.py PROGRAM [--record]

PROGRAM is count_instructions, run here under valgrind's callgrind. A count that grew by more than 3 % is a
failure; one that fell is told, to be put on record with --record. Compilers that are not on record are
left out. Exit status 77 (skipped), with the reason, when nothing can be compared."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

RECORD = Path(__file__).with_name("instruction_counts.json")
SCENES = ["franka_panda", "puma_560", "humanoid", "humanoid_floating", "chain_64"]
FORMULAS = ["ID", "M", "FD", "dtau", "dqdd"]
ALLOWED = 1.03
CALLS = 20


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def inclusive(file):
    """Instructions in each function with all that it calls, from a callgrind file."""
    names, counts, function = {}, {}, None
    for line in open(file):
        if found := re.match(r"(c?fn)=\((\d+)\)(?: (.*))?$", line):
            kind, key, name = found.groups()
            names.setdefault(key, name)
            if kind == "fn":
                function = names[key]
        elif function and re.match(r"[+*\-\d]", line):
            counts[function] = counts.get(function, 0) + int(line.split()[1])
    return counts


def measure(program):
    compilers = subprocess.run([program], check=True, capture_output=True, text=True).stdout.split("\n")[:-1]
    results = {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            out = os.path.join(folder, "callgrind")
            # valgrind counts a byte stored by "rep stosb" as an instruction: memset is told to do without
            tunables = {"GLIBC_TUNABLES": "glibc.cpu.x86_rep_stosb_threshold=1000000000"}
            subprocess.run(["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={out}", program,
                            str(CALLS), scene], check=True, stdout=subprocess.DEVNULL,
                           env={**os.environ, **tunables})
            counts = inclusive(out)
            for compiler, prefix in zip(compilers, ["own", "second"]):
                for formula in FORMULAS:
                    count = counts[f"{prefix}_fast_{formula}"] / CALLS
                    results.setdefault(compiler, {}).setdefault(scene, {})[formula] = round(count)
    return results


def main():
    program = sys.argv[1]
    if not shutil.which("valgrind"):
        skip("valgrind is not installed")
    if not re.search(r"\bavx2\b", Path("/proc/cpuinfo").read_text()):
        skip("counts on record are for processors with AVX2")
    measured = measure(program)
    if "--record" in sys.argv:
        record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
        record.update(measured)
        RECORD.write_text(json.dumps(record, indent=2) + "\n")
        return
    record = json.loads(RECORD.read_text())
    known = [compiler for compiler in measured if compiler in record]
    if not known:
        skip(f"no counts on record for {', '.join(measured)}; there are some for {', '.join(record)}")
    worse = 0
    for compiler in known:
        for scene, counts in measured[compiler].items():
            for formula, count in counts.items():
                before = record[compiler].get(scene, {}).get(formula)
                if before is None:
                    print(f"{compiler:10} {scene:18} {formula:4} not on record {count:7} now: --record")
                    continue
                grown = count > ALLOWED * before
                worse += grown
                print(f"{compiler:10} {scene:18} {formula:4} {before:7} on record {count:7} now "
                      f"{100 * (count / before - 1):+6.1f} %" + ("  GROWN" if grown else ""))
    sys.exit(1 if worse else 0)


if __name__ == "__main__":
    main()
