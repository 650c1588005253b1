# SPDX-License-Identifier: GPL-3.0-or-later
"""The hardest known states, data/hardest: what is kept there still holds, and the search still finds it.

    python3 test_hardest_states.py PROGRAM

Our witnesses answer at every state that is kept; the verifier of data/golden judges them by its limits.
"""
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
KEPT = ROOT / "data" / "hardest"
VERIFY = [sys.executable, str(ROOT / "data" / "golden" / "verify.py")]
PROGRAM = os.path.abspath(sys.argv[1])
WITNESSES = {"lagrange": ["M", "c", "g", "tau", "qdd"], "newton_euler": ["M", "c", "g", "tau"], "articulated_body": ["qdd"]}
AGAIN = "double_pendulum"  # searched for once more
WITHOUT_FOLLOWERS = {"gripper"}  # golden vectors are of its tree, `evaluate` of the mechanism
CASES = []


def case(function):
    CASES.append(function)
    return function


def check(holds, *what):
    if not holds:
        raise AssertionError("\n".join(str(part) for part in what))


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    check(done.returncode == 0, words, "status", done.returncode, done.stderr)
    return done.stdout


def scenes():
    return [file for file in sorted(KEPT.glob("*.csv")) if file.stem not in WITHOUT_FOLLOWERS]


def rows(file):
    with open(file, encoding="utf-8", newline="") as text:
        return list(csv.DictReader(line for line in text if line[0] != "#"))


def states(file):
    """{state: {"q1": "0.5", ...}}, and which states ask for each quantity."""
    given, asked = {}, {}
    for row in rows(file):
        if row["role"] == "given":
            given.setdefault(row["state"], {})[row["quantity"] + row["row"]] = row["value"]
        elif row["state"] not in asked.setdefault(row["quantity"], []):
            asked[row["quantity"]].append(row["state"])
    return given, asked


def column(quantity, row, wide):
    if quantity != "M":
        return "%s%d" % (quantity, row + 1)
    i, j = divmod(row, wide)
    return "M%d_%d" % (i + 1, j + 1) if wide > 9 else "M%d%d" % (i + 1, j + 1)


def answers(file, witness, quantities, folder, factor=1.0):
    """Lines of an answers file: what a witness says at the states of these quantities, times a factor."""
    given, asked = states(file)
    out = []
    for quantity in quantities:
        if quantity not in asked:
            continue
        drop = "tau" if quantity != "qdd" else "qdd"
        names = [key for key in given[asked[quantity][0]] if key.rstrip("0123456789") != drop]
        table = folder / "states.csv"
        table.write_text("\n".join([",".join(names)] + [",".join(given[s][key] for key in names) for s in asked[quantity]]) + "\n",
                         encoding="utf-8")
        said = run("evaluate", file.stem, "--quantity", quantity, "--states", table, "--convention", "dynwitness",
                   "--witness", witness)
        numbers = list(csv.reader(line for line in said.splitlines() if not line.startswith("#")))[1:]
        for state, values in zip(asked[quantity], numbers):
            wide = sum(key.startswith("qd") and not key.startswith("qdd") for key in given[state])
            for k, x in enumerate(values):
                i, j = divmod(k, wide) if quantity == "M" else (k, 0)
                out.append("%s,%s,%d,%d,%r" % (state, quantity, i + 1, j + 1, float(x) * factor))
    return out


def judged(file, lines, folder):
    said = folder / "answers.csv"
    said.write_text("state,quantity,row,column,value\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return subprocess.run([*VERIFY, str(file), str(said)], capture_output=True, text=True)


@case
def our_witnesses_stay_within_their_limits_there(folder):
    check(scenes(), "nothing is kept in", KEPT)
    for file in scenes():
        for witness, quantities in WITNESSES.items():
            done = judged(file, answers(file, witness, quantities, folder), folder)
            check(done.returncode == 0, file.name, witness, done.stdout, done.stderr)
    print("    %d scenes" % len(scenes()))


@case
def a_millionth_too_much_is_seen_in_every_scene(folder):
    for file in scenes():
        done = judged(file, answers(file, "newton_euler", ["M", "c", "g", "tau"], folder, 1 + 1e-6), folder)
        check(done.returncode == 1, file.name, done.stdout, done.stderr)


@case
def the_search_finds_the_same_again(folder):
    run("golden", AGAIN, "--hardest", "--format", "csv", "-o", folder / "again")

    def ours(table):
        return [line for line in table.read_text(encoding="utf-8").splitlines()
                if line.startswith("| " + AGAIN) and line.split("|")[3].strip() in (*WITNESSES, "composite_body", "fast")]

    def digits(line):  # usual, worst
        return [float(x) for x in line.split("|")[4:6]]

    kept, again = ours(KEPT / "hardest.md"), ours(folder / "again" / "hardest.md")
    check(len(kept) == len(again) > 10, kept, again)
    for one, other in zip(kept, again):
        check(one.split("|")[2:4] == other.split("|")[2:4], one, other)
        # another compiler rounds otherwise; a state that is as hard stays so to a digit
        check(all(abs(a - b) <= 1 for a, b in zip(digits(one), digits(other))), one, other)


@case
def the_worst_is_worse_than_usual(folder):
    for line in (KEPT / "hardest.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("| ") and not line.startswith("| scene"):
            usual, worst = (float(x) for x in line.split("|")[4:6])
            check(worst <= usual, line)


def main():
    failed = 0
    for function in CASES:
        with tempfile.TemporaryDirectory() as folder:
            try:
                function(Path(folder))
                print("ok   ", function.__name__)
            except AssertionError as error:
                failed += 1
                print("FAILS", function.__name__, error, sep="\n")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
