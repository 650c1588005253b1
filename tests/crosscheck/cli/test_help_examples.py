#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example that --help gives is run as it stands, in a folder with the files that it names.

    test_help_examples.py FOLDER_OF_PROGRAMS [COMMAND...] [--times]

Those of SLOW are not run, each for its reason; what is listed there and is no example is a fault, and so is a command
without an example."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PATIENCE = 120  # [s]

# what keeps them from being run: the time that was seen on two cores, or what is missing
SLOW = {
    "dynwitness museum": "a minute: the test museum_names_every_exhibit is this",
    "dynwitness chart franka_panda --quantity all -o charts": "half a minute of timing",
    "dynwitness chart double_pendulum --simulate -o charts": "half a minute of timing",
    "dynwitness drift double_pendulum --advise 0.001": "minutes: test_step_advice",
    "dynwitness envelope kuka_iiwa_14 --ratio 1.5": "a minute",
    "dynwitness growth --family chain --links 4096": "two minutes of timing",
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
# a difference is what these are there to find: a wrong formula; published digits that such steps do not reach
FINDS = {
    "dynwitness simulate car_axis --duration 3 --formulation index3 --step 0.001",
    'dynwitness check double_pendulum --answer "M12 = m2*l1*l2*cos(q2)/2"',
}

URDF = "dynwitness write double_pendulum --format urdf --lossy -o my_arm.urdf"
# (MuJoCo takes no rods, which have no inertia about themselves)
MJCF = "dynwitness write franka_panda --format mjcf --lossy -o my_arm.xml"


def states(name, positions, rates, rows=3):
    """A file of states, any numbers."""
    header = [f"q{k + 1}" for k in range(positions)] + [f"{d}{k + 1}" for d in ("qd", "qdd") for k in range(rates)]
    lines = [",".join(header)]
    for row in range(rows):
        lines.append(",".join(f"{((7 * k + 5 * row) % 11 - 4.5) / 8}" for k in range(len(header))))
    Path(name).write_text("\n".join(lines) + "\n")


def from_readme(name):
    """What README has the reader write into this file."""
    text = (ROOT / "README.md").read_text()
    return re.search(rf"^cat > {re.escape(name)} <<'END'\n(.*?)^END$", text, re.S | re.M)[1]


def prepare(command, run):
    """Files that the examples of a command expect in their folder, which is the working one."""
    if command in ("crosscheck", "readers", "same", "show"):
        run(URDF)
    if command == "crosscheck":
        Path("my_arm.py").write_text(from_readme("my_arm.py"))
    elif command == "check":
        states("states.csv", 6, 6)
        run("dynwitness evaluate puma_560 --states states.csv --quantity tau -o tau.csv")
        Path("formulas.txt").write_text("g2 = 1/2*m2*g*l2*sin(q1 + q2)\n")
    elif command == "grade":
        Path("submissions").mkdir()
        shutil.copy(ROOT / "data/engines/double_pendulum.py", "submissions")
    elif command == "evaluate":
        states("s.csv", 2, 2)
        states("log.csv", 38, 37)
        run("dynwitness simulate puma_560 --duration 0.1 --step 0.01 --csv motion.csv")
    elif command == "drift":
        for name, step in (("coarse", 0.02), ("fine", 0.01)):
            run(f"dynwitness simulate double_pendulum --duration 0.2 --step {step} --csv {name}.csv")
    elif command == "readers":
        run(MJCF)
        shutil.copy(ROOT / "tests/crosscheck/cli/my_reader.py", ".")
    elif command == "same":
        run("dynwitness write my_arm.urdf --format toml --lossy -o my_arm.toml")
        for name in ("old", "new"):
            shutil.copy("my_arm.urdf", f"{name}.urdf")
    elif command == "write":
        run(MJCF)
    elif command == "stability":
        shutil.copy(ROOT / "data/engines/open_chain.py", "my_arm.py")
        shutil.copy(ROOT / "data/engines/dynwitness_engine.py", ".")


def programs(folder):
    """{command: its program}."""
    lines = (ROOT / "crosscheck/cli/commands.txt").read_text().splitlines()
    return {line.split()[0]: folder / line.split()[1] for line in lines if line and line[0] != "#"}


def examples(program, command):
    text = subprocess.run([program, command, "--help"], capture_output=True, text=True, check=True).stdout
    text = re.sub(r" \\\n +", " ", text)
    names = re.findall(r"^ *(dynwitness [a-z]+ ?.*)$", text, re.M)
    return [re.sub(r" +# .*", "", line).strip() for line in names if line.split()[1] in COMMANDS]


def outcome(line, of_command):
    """A shell's run of an example: its complaint, "" when there is none."""
    words = re.sub(r"^dynwitness (\w+)", lambda m: f"'{of_command[m[1]]}' {m[1]} -q", line)
    try:
        done = subprocess.run(["bash", "-c", words], capture_output=True, text=True, timeout=PATIENCE,
                              stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return f"takes more than {PATIENCE} s"
    expected = 1 if line in FINDS else 0
    if done.returncode == expected:
        return ""
    return f"exit status {done.returncode}, expected {expected}\n" + (done.stderr + done.stdout)[-600:]


def main():
    arguments = [word for word in sys.argv[2:] if word != "--times"]
    of_command = programs(Path(sys.argv[1]).resolve())
    COMMANDS.update(of_command)
    complaints, known, run_of = [], set(), 0
    for command in arguments or of_command:
        lines = examples(of_command[command], command)
        known |= set(lines)
        if not lines:
            complaints.append(f"{command}: no example")
        with tempfile.TemporaryDirectory(prefix="dynwitness") as folder:
            os.chdir(folder)
            (Path(folder) / "data").symlink_to(ROOT / "data")
            prepare(command, lambda line: complaints.extend(filter(None, [outcome(line, of_command)])))
            for line in lines:
                if line in SLOW:
                    continue
                start = time.monotonic()
                complaint = outcome(line, of_command)
                run_of += 1
                if "--times" in sys.argv:
                    print(f"{time.monotonic() - start:6.1f} s  {line}", flush=True)
                if complaint:
                    complaints.append(f"{line}\n    {complaint}")
            os.chdir(ROOT)
    if not arguments:
        complaints += [f"no example of any help: {line}" for line in sorted((set(SLOW) | FINDS) - known)]
        if run_of < 60:  # 81 when this was written
            complaints.append(f"only {run_of} examples were run")
    for complaint in complaints:
        print(complaint)
    print(f"{run_of} examples run")
    sys.exit(bool(complaints))


COMMANDS = {}
main()
