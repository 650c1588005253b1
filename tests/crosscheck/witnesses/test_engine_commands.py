#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What commands make of a program of the user's: right ones answer the same in batches and one by one, and what
a hostile one does is never a failure of ours (status 3). Usage: test_engine_commands.py DYNWITNESS"""
import json
import os
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1]
ENGINES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "data", "engines")
FOLDER = tempfile.TemporaryDirectory()
START = "import json, sys\nsys.stdin.readline()\n"
HELLO = START + "print(json.dumps({'protocol': 1, 'quantities': ['M', 'c', 'g', 'tau', 'qdd']}), flush=True)\n"


def run(*arguments, stdin=None):
    done = subprocess.run([PROGRAM, *arguments], input=stdin, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def script(name, text):
    path = os.path.join(FOLDER.name, name + ".py")
    with open(path, "w") as file:
        file.write(text)
    return "python3 " + path


def answering(value):
    """Of the simple pendulum; value: of every quantity, M in rows."""
    return HELLO + """
for line in sys.stdin:
    batch = json.loads(line)
    value = lambda quantity: %s
    print(json.dumps({'batch': batch['batch'], 'answers': [{q: value(q) for q in batch['quantities']}
                                                           for _ in batch['states']]}), flush=True)
""" % value


# batches of evaluate: three and a rest
states = os.path.join(FOLDER.name, "states.csv")
with open(states, "w") as file:
    file.write("q1,q2,qd1,qd2,qdd1,qdd2\n")
    for k in range(200):
        file.write(",".join(repr(0.1 * k + 0.01 * i) for i in range(6)) + "\n")
engine = "python3 " + os.path.join(ENGINES, "double_pendulum.py")
status, in_batches, said = run("evaluate", "double_pendulum", "--states", states, "--quantity", "tau,M", "--engine", engine)
assert status == 0, said
with open(states) as file:
    status, one_by_one, said = run("evaluate", "double_pendulum", "--states", "-", "--quantity", "tau,M", "--engine",
                                   engine, stdin=file.read())
assert status == 0 and in_batches == one_by_one and in_batches.count("\n") == 201, said
status, ours, said = run("evaluate", "double_pendulum", "--states", states, "--quantity", "tau,M")
for a, b in zip(in_batches.splitlines()[1:], ours.splitlines()[1:]):
    for x, y in zip(a.split(","), b.split(",")):
        assert abs(float(x) - float(y)) <= 1e-12 * max(1, abs(float(y))), (x, y)

# hostile ones
crosscheck = ["crosscheck", "simple_pendulum", "--random", "2", "--no-drift", "--no-charts", "--witness",
              "newton_euler,composite_body", "-o",
              os.path.join(FOLDER.name, "report")]
commands = {"evaluate": ["evaluate", "simple_pendulum", "--quantity", "M"], "check": ["check", "simple_pendulum"],
            "crosscheck": crosscheck,
            "chart": ["chart", "simple_pendulum", "--quantity", "M", "--random", "2", "--witness", "newton_euler"]}
hostile = {  # expected of evaluate, check, crosscheck and chart
    "fails": ("import sys; sys.exit(4)", (1, 1, 1, 0)),
    "is no program": (None, (1, 1, 1, 0)),
    "refuses": (START + "print(json.dumps({'protocol': 1, 'refuses': 'too heavy'}), flush=True)", (2, 2, 0, 0)),
    "refuses without a word": (START + "print(json.dumps({'protocol': 1, 'refuses': ''}), flush=True)", (2, 2, 0, 0)),
    "dies at a batch": (HELLO + "sys.stdin.readline()", (1, 1, 1, 0)),
    "never has a value": (answering("'not today'"), (1, 1, 1, 0)),
    "never has a value, nor a word": (answering("''"), (1, 1, 1, 0)),
    "exaggerates": (answering("[[1e308]] if quantity == 'M' else [-1e308]"), (0, 1, 1, 0)),
    "nearly nothing": (answering("[[5e-324]] if quantity == 'M' else [-0.0]"), (0, 1, 1, 0)),
    "not a number": (answering("[[float('nan')]] if quantity == 'M' else [0]"), (1, 1, 1, 0)),
}
for name, (text, expected) in hostile.items():
    engine = "no_such_program_of_anybody" if text is None else script(name.replace(" ", "_"), text)
    for (command, words), wanted in zip(commands.items(), expected):
        status, out, said = run(*words, "--engine", engine)
        assert status == wanted, (name, command, status, out[-2000:], said)
        if wanted == 1 and command != "check":
            assert "engine_1" in said + out, (name, command, said)
status, out, said = run("check", "simple_pendulum", "--engine", script("mute", answering("'not today'")))
assert "FAILED: nothing that it says could be judged: M: at state 0: engine_1 has no M: not today" in out, out

# where joints follow others a program is heard about the tree: its model and its Jacobian too, and what it does not
# answer is told
def heard_of_gripper(name, *changes):
    with open(os.path.join(ENGINES, "open_chain.py")) as file:
        text = file.read()
    for old, new in changes:
        assert text.count(old) == 1, (name, old)
        text = text.replace(old, new)
    report = os.path.join(FOLDER.name, name)
    status, out, said = run("crosscheck", "gripper", "--random", "2", "--no-drift", "--no-charts", "--witness",
                            "newton_euler,composite_body", "-o", report, "--engine",
                            "PYTHONPATH=" + ENGINES + " " + script(name, text))
    with open(os.path.join(report, "report.json")) as file:
        checks = json.load(file)["scenes"][0]["checks"]
    return status, out, {check["quantity"]: check["verdict"] for check in checks
                         if check["check"] in ("model", "jacobian") or "does not know" in check.get("reason", "")}


status, out, heard = heard_of_gripper("right")
assert status == 0 and heard == {"model": "agree", "jacobian": "agree", "momentum": "not answerable"}, (heard, out)
status, out, heard = heard_of_gripper("heavier", ("return [{key: link[key] for",
                                                  "links[3]['com'][0] += 1e-9\n        return [{key: link[key] for"))
assert status == 1 and heard["model"] == "disagree" and heard["jacobian"] == "agree", (heard, out)
status, out, heard = heard_of_gripper("mirrored", ("column = cross(z, arm)", "column = cross(arm, z)"))
assert status == 1 and heard["model"] == "agree" and heard["jacobian"] == "disagree", (heard, out)
status, out, heard = heard_of_gripper("no_M", ('{"M": M, "c"', '{"c"'))
assert status == 0 and heard["M"] == "not answerable" and "qdd is solved from M and tau" in out, (heard, out)

# a chart has the program's time and error, or why not
status, out, said = run("chart", "double_pendulum", "--random", "40", "--witness", "newton_euler", "--engine",
                        "python3 " + os.path.join(ENGINES, "double_pendulum.py"))
row = [line for line in out.splitlines() if "double_pendulum_by_hand (a program: wall time)" in line]
assert status == 0 and len(row) == 1, out + said
error, nanoseconds = float(row[0].split(",")[3]), float(row[0].split(",")[5])
assert 0 < error < 1e-12 and nanoseconds > 0, row
status, out, said = run("chart", "simple_pendulum", "--quantity", "M", "--random", "2", "--witness", "newton_euler",
                        "--engine", "exit 4")
assert "engine_1" in out and "it failed with status 4" in out, out
print("right")
