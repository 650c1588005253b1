#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Hands in the notebooks' solutions and sees them get all marks, and an unsolved exercise none.

    grade_solutions.py DYNWITNESS_CHECK

Of each notebooks/rubrics/NAME.toml: the exercises that its first line names, from notebooks/solutions/NAME.py.
Exit status 77 (skipped): numpy is missing."""
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from run_notebooks import FOLDER, solutions


def handed_in(name, exercises):
    """One file with the solutions of these exercises."""
    solved = solutions(name)
    return "\n".join(solved[f"exercise-{number}"] for number in exercises) + "\n"


def graded(program, rubric, folder):
    """{submission: (marks, of how many)}."""
    subprocess.run([program, "grade", folder / "submissions", "--rubric", rubric, "-q", "-o", folder / "grades"],
                   check=True, capture_output=True)
    with open(folder / "grades" / "grades.csv") as table:
        return {row["submission"]: (float(row["total"]), float(row["out_of"]), row["feedback"])
                for row in csv.DictReader(table)}


def main():
    try:
        import numpy  # noqa: F401
    except ImportError as error:
        print(f"skipped: {error}; on Debian: python3-numpy")
        sys.exit(77)
    complaints = []
    for rubric in sorted((FOLDER / "rubrics").glob("*.toml")):
        title = rubric.read_text().splitlines()[0]
        exercises = re.findall(r"\d+", re.search(r"exercises? ([\d, and]+) of", title)[1])
        with tempfile.TemporaryDirectory(prefix="dynwitness") as folder:
            folder = Path(folder)
            (folder / "submissions").mkdir()
            solution = handed_in(rubric.stem, exercises)
            (folder / "submissions" / "solved.py").write_text(solution)
            # the same with a sign, somewhere in what it returns: right nowhere
            wrong = re.sub(r"^    return (?!there)", "    return -1.0 * ", solution, flags=re.M)
            (folder / "submissions" / "wrong.py").write_text(wrong)
            marks = graded(sys.argv[1], rubric, folder)
        got, most, feedback = marks["solved.py"]
        print(f"{rubric.name}: the solution gets {got:g} of {most:g}, the same with signs changed {marks['wrong.py'][0]:g}")
        if got != most:
            complaints.append(f"{rubric.name}: the solution gets {got:g} of {most:g}: {feedback}")
        if marks["wrong.py"][0] > most / 2:  # what a sign that `check` can name keeps: partial = 0.5
            complaints.append(f"{rubric.name}: a wrong one gets {marks['wrong.py'][0]:g} of {most:g}")
    print("\n".join(complaints))
    sys.exit(bool(complaints))


if __name__ == "__main__":
    main()
