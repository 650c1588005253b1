#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What MuJoCo 3.3.8 of npm makes of the smallest files that it reads as another robot.

    test_mujoco_of_today.py DYNWITNESS

The numbers are known by hand: a link that turns about x with ixx = 1, iyy = 2, its <inertial> turned by a right
angle about z, has M = 2, and MuJoCo's is 1: 50 % off. The same inertia at rest on it by a joint that is fixed, with
the same turn: M = 1 + 2 = 3, and MuJoCo's is 2. In MJCF its compiler fuses where the file asks for it, by the same
code; bodies that are not fused are read as written. 77: the package is not there.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SKIP = 77
INERTIA = '<mass value="1"/><inertia ixx="1" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/>'
TURN = 'rpy="0 0 1.5707963267948966"'
HINGE = ('<joint name="hinge" type="continuous"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/></joint>')


def robot(a, more=""):
    return f'<robot name="r">\n<link name="base"/>\n<link name="a"><inertial>{a}{INERTIA}</inertial></link>\n{HINGE}{more}</robot>\n'


def fused(origin, inertial=""):
    return robot("", f'<link name="b"><inertial>{inertial}{INERTIA}</inertial></link>'
                     f'<joint name="weld" type="fixed"><parent link="a"/><child link="b"/><origin {origin}/></joint>')


def mjcf(compiler):
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 2 2"/>'
    return (f'<mujoco>\n<compiler angle="radian" {compiler}/><worldbody>\n<body name="a"><joint name="hinge" axis="1 0 0"/>{inertial}'
            f'<body name="b" euler="0 0 1.5707963267948966">{inertial}</body></body></worldbody></mujoco>')


# file, rule, M off by [%] where that is known by hand, where it is on record; no rule: MuJoCo has the robot of the file
CASES = {
    "inertial_turned": (robot(f"<origin {TURN}/>"), "the rpy of <inertial> is dropped (a)", 50, "3559"),
    "fused_child_turned": (fused(TURN), "a fixed child is merged without its rotation (b)", 100 / 3, "2982"),
    # the least moment is ixx, so that its principal axes are (y, z, x): it puts the child at z = 0.4
    "fused_child_shifted": (fused('xyz="0 0.4 0"'), "a fixed child is merged without its rotation, and its shift is turned "
                            "by its principal axes (b)", 0, "2982"),
    "fused_child_turned_and_shifted": (
        fused('xyz="0.3 -0.1 0.2" rpy="0.1 0.2 0.7"', '<origin xyz="0.05 0.02 -0.04"/>'),
        "a fixed child is merged without its rotation, and its shift is turned by its principal axes (b)", None, "2982"),
    "mjcf_fused_child_turned": (mjcf('fusestatic="true"'), "a fixed child is merged without its rotation (b)", 100 / 3, "2982"),
    "mjcf": (mjcf(""), None, 0, None),
    # joints without names, several in a body, one turned from its zero, shapes, a spring
    "mjcf_unnamed": (
        '<mujoco>\n<option gravity="1 2 3"/><worldbody><geom size="1"/><body euler="10 20 30">'
        '<joint type="slide" pos="1 2 3" ref="0.1"/><joint axis="0 1 0" pos="0.1 0 0.2" ref="20" stiffness="2" springref="5"/>'
        '<geom size="0.1" pos="0.1 0.2 0.3"/><geom type="box" size="0.1 0.2 0.1" euler="0 0 20"/>'
        '<body pos="0.1 0 0.3"><joint axis="1 1 0" pos="0 0.1 0"/><geom type="capsule" size="0.1 0.2" pos="0.1 0 0"/></body>'
        '</body></worldbody></mujoco>', None, 0, None),
    "plain": (robot(""), None, 0, None),
    # what stands before the first element may be long
    "comments": ('<?xml version="1.0"?>\n' + 60 * "<!-- <mujoco> -->\n" + robot(""), None, 0, None),
    "comments_mjcf": (60 * "<!-- <robot> -->\n" + mjcf(""), None, 0, None),
    "child_as_it_stands": (fused('xyz="0 0 0"'), None, 0, None),
}


def main():
    wrong = 0
    for name, (text, rule, off, record) in CASES.items():
        with tempfile.TemporaryDirectory() as folder:
            suffix = "xml" if "</mujoco>" in text else "urdf"
            file, out = Path(folder) / f"{name}.{suffix}", Path(folder) / "readers.json"
            file.write_text(text)
            status = subprocess.run([sys.argv[1], "readers", str(file), "--json", str(out)],
                                    stdout=subprocess.DEVNULL).returncode
            readers = json.loads(out.read_text())["readers"]
        mujoco = next(r for r in readers if r["name"] == "mujoco_npm")
        if not mujoco["present"]:
            print(f"test_mujoco_of_today: skipped: {mujoco['absence']}")
            return SKIP
        def expect(what, holds):
            nonlocal wrong
            if not holds:
                wrong += 1
                print(f"{name}: expected {what}, got status {status}, {json.dumps(mujoco, indent=1)}")
        expect("version 3.3.8", mujoco["version"] == "3.3.8")
        expect("that it is read", mujoco["read"])
        if suffix == "xml":
            expect("others that do not read MJCF", all(not r["read"] and not r["findings"] for r in readers
                                                       if r["name"] in ("dart", "kdl_parser", "sdformat")))
        findings = mujoco["findings"]
        if rule is None:
            expect("no finding", not findings)
            continue
        expect("exit status 1", status == 1)
        expect("one finding", len(findings) == 1)
        if findings:
            finding = findings[0]
            expect(f"link a at line 3: {rule}", (finding["link"], finding["line"], finding["rule"]) == ("a", 3, rule))
            expect(f"M off by {off} %", off is None or abs(finding["M_percent"] - off) < 1e-9)
            expect(f"issue {record}", any(link.endswith("/" + record) for link in finding["records"]))
            expect("a remedy that was tried", mujoco["remedy"])
    print(f"{len(CASES)} files, {wrong} not as expected")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
