#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivations and linearizations in LaTeX are documents: pdflatex takes them, and no line runs off the page. M of an arm
of seven joints takes two pages.

latex_compiles.py PROGRAM SCENE...    status 77: there is no pdflatex
"""
import re
import shutil
import subprocess
import sys
import tempfile

# [pt]
MOST_OVERFULL = 0


def main():
    program, *scenes = sys.argv[1:]
    if not shutil.which("pdflatex"):
        print("no pdflatex (Debian: texlive-latex-base)")
        return 77
    failed = 0
    # M with all that it is made of: seen 2 and 2 pages
    derive, linearize = ["derive", "--proof"], ["linearize", "--symbolic"]
    asked = [(derive, scene, [], None) for scene in scenes]
    asked += [(derive, scene, ["--only", "M"], 2) for scene in ("kuka_iiwa_14", "franka_panda")]
    asked += [(linearize, scene, [], None) for scene in ("acrobot", "cylindrical_arm", "modern_robotics_3link")]
    for command, scene, options, most_pages in asked:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([program, *command, scene, *options, "--format", "latex", "-o", f"{folder}/d.tex"],
                           check=True)
            run = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "d.tex"],
                                 cwd=folder, capture_output=True, text=True, errors="replace")
            overfull = [float(pt) for pt in re.findall(r"Overfull \\hbox \(([0-9.]+)pt", run.stdout)]
            pages = re.search(r"\((\d+) pages?", run.stdout)
            worst = max(overfull, default=0.0)
            print(f"{command[0]} {scene} {' '.join(options)}: status {run.returncode}, {pages and pages[1]} pages, worst line {worst} pt")
            if run.returncode != 0 or not pages or worst > MOST_OVERFULL or int(pages[1]) > (most_pages or 1e9):
                print(run.stdout[-1500:])
                failed += 1
    return failed != 0


if __name__ == "__main__":
    sys.exit(main())
