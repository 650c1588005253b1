#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers in files are judged as those of a program, and what the states do not isolate is told.
Usage: test_recorded.py DYNWITNESS"""
import csv
import json
import os
import random
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1]
FOLDER = tempfile.TemporaryDirectory()
N = 6


def path(name):
    return os.path.join(FOLDER.name, name)


def columns(*groups):
    return [group + str(i + 1) for group in groups for i in range(N)]


def write(name, header, rows):
    with open(path(name), "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(header)
        out.writerows([["%.17g" % x for x in row] for row in rows])
    return path(name)


def table(name):
    with open(path(name)) as file:
        header, *rows = csv.reader(file)
    return header, [[float(x) for x in row] for row in rows]


def evaluated(scene, states, quantity, name):
    subprocess.run([PROGRAM, "evaluate", scene, "--states", states, "--quantity", quantity, "-o", path(name)],
                   check=True, capture_output=True)
    return path(name)


def check(*arguments):
    done = subprocess.run([PROGRAM, "check", "puma_560", *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def check_json(*arguments):
    status, out, err = check(*arguments, "--format", "json")
    assert out, err
    return status, json.loads(out)


draw = random.Random(3).uniform
vector = lambda: [draw(-2, 2) for _ in range(N)]
zeros = [0.0] * N
generic = [vector() + vector() + vector() for _ in range(6)]
q, qd, qdd = vector(), vector(), vector()
isolating = [q + zeros + zeros, q + zeros + qdd, q + qd + zeros, q + [-x for x in qd] + zeros,
             q + [2 * x for x in qd] + zeros]
states = write("states.csv", columns("q", "qd", "qdd"), generic + isolating)
few = write("few.csv", columns("q", "qd", "qdd"), generic)
many = write("many.csv", columns("q", "qd", "qdd"), isolating + [vector() + vector() + vector() for _ in range(60)])

# two files, right; the judged states are all
tau = evaluated("puma_560", states, "tau,M", "tau.csv")
status, said = check_json("--states", states, "--answers", tau)
assert status == 0 and said["verdict"] == "right" and said["states"] == 11, said
assert {x["quantity"] for x in said["quantities"] if x["verdict"] == "right"} == {"M", "tau"}, said

# one file
header, rows = table("states.csv")
tau_header, tau_rows = table("tau.csv")
one = write("one.csv", tau_header + header, [b + a for a, b in zip(rows, tau_rows)])
status, said = check_json("--answers", one)
assert status == 0 and said["verdict"] == "right", said

# qdd as the answer
forced = write("forced.csv", columns("q", "qd", "tau"), generic)
status, said = check_json("--states", forced, "--answers", evaluated("puma_560", forced, "qdd", "qdd.csv"))
assert status == 0 and {x["quantity"] for x in said["quantities"] if x["verdict"] == "right"} == {"qdd"}, said

# reactions, by joint and component
reactions = evaluated("puma_560", states, "reactions", "reactions.csv")
status, said = check_json("--states", states, "--answers", reactions)
assert status == 0 and {x["quantity"] for x in said["quantities"] if x["verdict"] == "right"} == {"reactions"}, said
header, rows = table("reactions.csv")
bent = header.index("joint_3.mx")
rows[3][bent] *= 1 + 1e-9
status, said = check_json("--states", states, "--answers", write("bent.csv", header, rows))
wrong = [x for x in said["quantities"] if x["verdict"] == "wrong"]
assert status == 1 and len(wrong) == 1 and wrong[0]["entry"] == "joint_3.mx" and wrong[0]["state"] == 3, said

# a mistake is named, and which term it is in
with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "data", "scenes",
                       "puma_560.toml")) as file:
    toml = file.read()
assert "gravity = [0, 0, -9.81]" in toml
upside_down = path("upside_down.toml")
with open(upside_down, "w") as file:
    file.write(toml.replace("gravity = [0, 0, -9.81]", "gravity = [0, 0, 9.81]"))
for name, where in (("all", states), ("many", many)):
    wrong = evaluated(upside_down, where, "tau", "wrong_%s.csv" % name)
    status, said = check_json("--states", where, "--answers", wrong)
    assert status == 1 and said["explained"], said
    assert said["findings"][0]["sentence"] == "gravity with the opposite sign", said["findings"][0]
    assert said["where"]["terms"] == [
        "M: right in tau", "c: right in tau", "g: wrong in tau", "friction: right in tau"], said["where"]
    assert any("10 of the" in x for x in said["where"]["growth"]) == (name == "many" or name == "all"), said["where"]

# states that isolate nothing: the mistake is named all the same, and what is not told is told
wrong = evaluated(upside_down, few, "tau", "wrong_few.csv")
status, said = check_json("--states", few, "--answers", wrong)
assert status == 1 and said["findings"][0]["sentence"] == "gravity with the opposite sign", said
assert said["where"]["terms"] == ["M: not told", "c: not told", "g: not told", "friction: not told"], said["where"]
for term in ("M", "c", "g", "friction"):
    assert any("the states do not isolate %s in tau" % term in x for x in said["where"]["growth"]), said["where"]

# one state is no proof
_, rows = table("wrong_few.csv")
status, out, err = check("--states", write("one_state.csv", columns("q", "qd", "qdd"), generic[:1]),
                         "--answers", write("one_answer.csv", columns("tau"), rows[:1]))
assert status == 1 and "goes by 1 state: other mistakes may answer the same there" in out, out

# what cannot be read
for arguments, words in (
        ([], "expected --engine COMMAND, --answers FILE or --answer FORMULA"),
        (["--answers", few], "no answers"),
        (["--answers", states], "no answers"),
        (["--states", few, "--answers", tau], "more rows than"),
        (["--states", states, "--answers", one], "stand in"),
        (["--answers", write("gap.csv", columns("q") + ["M11"], [[0.0] * (N + 1)])], "column 'M12' is missing"),
        (["--answers", write("empty.csv", columns("q", "g"), [])], "empty.csv:1: no state after the header"),
        (["--answers", write("odd.csv", columns("q") + ["mass"], [[0.0] * (N + 1)])], "column 'mass' is unknown"),
        (["--states", write("bare.csv", columns("q"), [zeros]), "--answers",
          write("bare_tau.csv", columns("tau"), [zeros])], "tau1.. without qdd1..")):
    status, out, err = check(*arguments)
    assert status == 2 and words in err, (arguments, status, out, err)

# coordinates of other engines: the file says whose, or the command line does, and another one's are wrong
def humanoid(*arguments):
    done = subprocess.run([PROGRAM, "check", "humanoid_floating", *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


for convention in ("mujoco", "pinocchio", "drake"):
    theirs = path(convention + ".csv")
    subprocess.run([PROGRAM, "evaluate", "humanoid_floating", "--random", "4", "--quantity", "tau,M,g", "--convention",
                    convention, "-o", theirs], check=True, capture_output=True)
    status, out, err = humanoid("--answers", theirs)
    assert status == 0, (convention, out, err)
    with open(theirs) as file:
        first, *rest = file
    assert first == "# convention: %s\n" % convention, first
    untold = path("untold.csv")
    with open(untold, "w") as file:
        file.writelines(rest)
    status, out, err = humanoid("--answers", untold)
    assert status == 2 and "whose coordinates the file has" in err, (out, err)
    status, out, err = humanoid("--answers", untold, "--convention", convention)
    assert status == 0, (convention, out, err)
    if convention != "pinocchio":
        status, out, err = humanoid("--answers", untold, "--convention", "pinocchio")
        assert status == 1, (convention, out, err)

# and of motions: those of a spherical top, its quaternion's real part first or last
def top(*arguments):
    done = subprocess.run([PROGRAM, "drift", "heavy_top", "--motion", *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


motion = path("top.csv")
subprocess.run([PROGRAM, "simulate", "heavy_top", "--duration", "0.2", "--csv", motion], check=True, capture_output=True)
assert top(motion)[0] == 0, top(motion)
with open(motion) as file:
    first, *rest = file
assert first == "# convention: dynwitness\n", first
with open(untold, "w") as file:
    file.writelines(rest)
assert top(untold)[0] == 2 and "whose coordinates the file has" in top(untold)[2], top(untold)
assert top(untold, "--convention", "dynwitness")[0] == 0
assert top(untold, "--convention", "pinocchio")[0] == 1
print("right")
