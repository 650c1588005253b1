#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Engines are modules, which programs load when a witness is asked for and not before:

    test_engine_modules.py PROGRAM

Libraries are told by the linker (readelf, nm) and, of what is running, by the loader (LD_DEBUG).
Ends with 77, which ctest takes for skipped, where readelf or nm is missing.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAM = Path(sys.argv[1])
DATA = Path(__file__).resolve().parents[2] / "data"
MODULES = sorted((PROGRAM.parents[1] / "lib" / "dynwitness").glob("engine-*.so"))
LIBRARIES = re.compile(r"lib(dart|SimTK|mujoco|orocos-kdl)|engine-")
# it reads files as DART and MuJoCo do, by them
READERS = "dynwitness-readers"
LEFT_OUT = "a witness is left out: simbody: "
# what no witness is asked for
PLAIN = [["--version"], ["--help"], ["crosscheck", "--help"], ["check", "--help"], ["scenes"],
         ["show", "acrobot"], ["derive", "simple_pendulum"],
         ["evaluate", "acrobot", "--quantity", "tau"],
         ["sweep", "double_pendulum", "--q", "0.3,0.4", "--qd", "1,2"]]

if not shutil.which("readelf") or not shutil.which("nm"):
    print("skipped: no readelf, or no nm (Debian: binutils)")
    sys.exit(77)


def run(*words, **environment):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          errors="replace", env={**os.environ, "LC_ALL": "C", **environment})


def programs():
    """All that are built but those that are no part of the command line."""
    return [file for file in sorted(PROGRAM.parent.glob("dynwitness*"))
            if "-reader-" not in file.name and file.name != "dynwitness_benchmarks"]


def linked(file):
    return set(re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", file).stdout))


def names(file, which):
    lines = run("nm", "-D", "-f", "posix", which, file).stdout.splitlines()
    return {line.split()[0] for line in lines}


def loaded(program, *words):
    told = run(program, *words, LD_DEBUG="files")
    return {Path(name).name for name in re.findall(r"calling init: (\S+)", told.stderr)}


assert MODULES, f"no modules beside {PROGRAM}"
assert programs(), f"no programs in {PROGRAM.parent}"

for program in programs():
    engines = {name for name in linked(program) if LIBRARIES.search(name)}
    assert program.name == READERS or not engines, f"{program.name} is linked to {engines}"
    called = set().union(*(names(module, "--undefined-only") for module in MODULES))
    missing = {name for name in called - names(program, "--defined-only") if "10dynwitness" in name}
    assert not missing, f"{program.name} has not what modules of engines call: {sorted(missing)}"

for words in PLAIN:
    found = {name for name in loaded(PROGRAM, *words) if LIBRARIES.search(name)}
    assert not found, f"dynwitness {' '.join(words)} loads {found}"
found = loaded(PROGRAM, "version")  # asks all witnesses: that the looking can see them
assert {module.name for module in MODULES} <= found, f"dynwitness version loads {found}"

with tempfile.TemporaryDirectory() as folder:
    one = loaded(PROGRAM, "chart", "simple_pendulum", "--witness", "simbody", "--random", "5", "-o",
                 folder)
    one = {name for name in one if name.startswith("engine-")}
    assert one == {"engine-simbody.so"}, f"dynwitness chart --witness simbody loads {one}"

    alone = Path(folder) / "bin" / "dynwitness"
    alone.parent.mkdir()
    shutil.copy2(PROGRAM, alone)
    module = Path(folder) / "lib" / "dynwitness" / "engine-simbody.so"
    report_folder = Path(folder) / "report"

    def said(*words):
        return run(alone, *words, DYNWITNESS_DATA=str(DATA))

    def expect_absent(reason):
        witnesses = json.loads(said("version", "--format", "json").stdout)["witnesses"]
        simbody = next(w for w in witnesses if w["name"] == "simbody")
        assert not simbody["present"] and reason in simbody["absent"], simbody
        answer = said("version")
        assert answer.returncode == 0 and reason in answer.stdout, answer
        assert LEFT_OUT in answer.stderr and reason in answer.stderr, answer
        answer = said("crosscheck", "simple_pendulum", "--witness", "simbody", "-o", report_folder)
        assert answer.returncode == 2 and reason in answer.stderr, answer

    expect_absent(f"its module is missing: {module}")
    # what the others agree about is not said without saying whom it is without, --quiet or not
    for quiet in [], ["--quiet"]:
        answer = said("crosscheck", "simple_pendulum", "--random", "2", "--no-charts", "--no-drift",
                      "-o", report_folder, *quiet)
        assert answer.returncode == 0, answer
        assert LEFT_OUT + "its module is missing: " in answer.stderr, answer
        assert "\nwithout simbody: its module is missing: " in answer.stdout, answer
    # whom nobody asked is not missed
    answer = said("crosscheck", "simple_pendulum", "--witness", "lagrange,newton_euler", "--random",
                  "2", "--no-charts", "--no-drift", "-o", Path(folder) / "chosen")
    assert answer.returncode == 0 and LEFT_OUT not in answer.stderr, answer
    assert "without simbody" not in answer.stdout, answer
    report = json.loads((report_folder / "report.json").read_text())
    simbody = next(w for w in report["witnesses"] if w["name"] == "simbody")
    assert not simbody["present"] and "its module is missing" in simbody["absent"], simbody
    module.parent.mkdir(parents=True)
    module.write_text("nothing of the kind")
    expect_absent("its module does not load: ")
print(f"{len(programs())} programs, {len(MODULES)} modules")
