#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the documentation site, with three scenes in its gallery, and asks whether everything is there.

    test_site.py DYNWITNESS

The builder runs the tutorial's commands and looks at every link itself; here one of each is planted wrong, which it has
to tell. Exit status 77 (skipped): python3-markdown is missing."""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "crosscheck" / "cli" / "site"
SCENES = ["double_pendulum", "puma_560", "bicycle"]


def build(program, folder, builder=SITE):
    words = ["/usr/bin/python3", builder / "build_site.py", program, folder]
    return subprocess.run([*words, *(x for name in SCENES for x in ("--scene", name))], capture_output=True, text=True)


def whole(folder):
    """Complaints about a site that was built."""
    complaints = []
    commands = re.findall(r"^([a-z]+) +dynwitness", (ROOT / "crosscheck/cli/commands.txt").read_text(), re.M)
    wanted = ["index.html", "tutorial.html", "scene-format.html", "verdicts.html", "limits.html", "audit/index.html",
              *(f"commands/{name}.html" for name in commands), *(f"scenes/{name}.html" for name in SCENES),
              *(f"notebooks/{path.stem}.html" for path in (ROOT / "notebooks").glob("*.ipynb"))]
    complaints += [f"{name} is not there" for name in wanted if not (folder / name).is_file()]
    tutorial = (folder / "tutorial.html").read_text()
    for words in ("missing      1/3*m2*l2^2", "explained exactly by: inertia of link", "all agree"):
        if words not in tutorial:
            complaints.append(f"tutorial.html does not show '{words}'")
    if (folder / "gallery.html").read_text().count("<svg") != len(SCENES):
        complaints.append("gallery.html: a picture is missing")
    if shutil.which("doxygen") and "tau_i = Z" not in (folder / "cpp/recursive_newton_euler.hpp.html").read_text():
        complaints.append("cpp: the comment of inverseDynamics is not shown")
    return complaints


def planted(program, work, file, old, new, told):
    """Complaints when a fault in a copy of the builder's texts is not told."""
    copy = work / "copy"
    shutil.rmtree(copy, ignore_errors=True)
    # the builder finds the repository from where it stands
    (copy / "crosscheck/cli").mkdir(parents=True)
    for entry in ROOT.iterdir():
        if entry.name not in ("crosscheck", ".git"):
            (copy / entry.name).symlink_to(entry)
    for entry in (ROOT / "crosscheck").iterdir():
        if entry.name != "cli":
            (copy / "crosscheck" / entry.name).symlink_to(entry)
    for entry in (ROOT / "crosscheck/cli").iterdir():
        if entry.name != "site":
            (copy / "crosscheck/cli" / entry.name).symlink_to(entry)
    shutil.copytree(SITE, copy / "crosscheck/cli/site")
    path = copy / "crosscheck/cli/site" / file
    text = path.read_text()
    assert old in text, f"{file}: '{old}' is not there to be planted in"
    path.write_text(text.replace(old, new, 1))
    done = build(program, work / "planted", copy / "crosscheck/cli/site")
    if done.returncode != 1 or told not in done.stdout + done.stderr:
        return [f"{file}: {old} -> {new}: exit status {done.returncode}, not told: {told}"]
    return []


def main():
    try:
        import markdown  # noqa: F401
    except ImportError as error:
        print(f"skipped: {error}; on Debian: python3-markdown")
        sys.exit(77)
    program = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(prefix="dynwitness") as work:
        work = Path(work)
        done = build(program, work / "site")
        print(done.stdout.replace(str(work) + "/", "").strip())
        complaints = [] if done.returncode == 0 else [f"exit status {done.returncode}: {done.stderr}"]
        if not complaints:
            complaints = whole(work / "site")
            complaints += planted(program, work, "tutorial.md", "../../../notebooks/README.md", "../../../notebooks/NOTHING.md",
                                  "links to ../../../notebooks/NOTHING.md, which is not there")
            complaints += planted(program, work, "tutorial.md", "--quantity M,c,g", "--quantity M,c,h", "exit status 2")
            (work / "mine").mkdir()
            (work / "mine" / "thesis.txt").write_text("years")
            refused = build(program, work / "mine")
            if refused.returncode != 2 or not (work / "mine" / "thesis.txt").exists():
                complaints.append("a folder that is no site is not refused")
    print("\n".join(complaints), end="\n" if complaints else "")
    sys.exit(bool(complaints))


if __name__ == "__main__":
    main()
