#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Executes the notebooks from top to bottom and compares what they say with the outputs they keep.

    run_notebooks.py PROGRAM [NOTEBOOK...] [--update]

PROGRAM is dynwitness. Exit status 1: a cell raised, or its text differs from the kept one; pictures
must be there and are not compared, since they change with gnuplot's version. A cell tagged
needs-NAME is not compared where the witness NAME is not installed, and must run all the same.
A cell tagged "exercise" is for the reader to fill in, and the next, tagged "raises-exception", must fail by an
AssertionError until then; after notebooks/solutions/NOTEBOOK.py, whose part "# %% ID" takes the place of the
exercise with that id, it must hold. A line "# from NOTEBOOK ID" there stands for that solution of another notebook.
--update keeps the new outputs instead of comparing; it refuses where a cell raises or a witness is
missing. Exit status 77 (skipped), with the reason: a Python package or the module is missing."""
import argparse
import difflib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SKIP = 77
PATIENCE = 300  # seconds for one cell; the machine may be busy
FOLDER = Path(__file__).resolve().parents[2] / "notebooks"


def texts(outputs):
    """What a reader reads, one entry an output: streams put together, pictures by name only."""
    result = []
    for output in outputs:
        if output.output_type == "stream":
            if result and result[-1][0] == output.name:
                result[-1] = (output.name, result[-1][1] + output.text)
            else:
                result.append((output.name, output.text))
        elif output.output_type == "error":
            result.append(("error", f"{output.ename}: {output.evalue}"))
        else:
            for kind, text in sorted(output.data.items()):
                result.append((kind, "(a picture)" if kind.startswith("image/") else text))
    return result


def differences(kept, new):
    """Lines of both, marked; empty when they are the same."""
    kept, new = ([f"[{kind}] {line}" for kind, text in outputs for line in text.split("\n")]
                 for outputs in (texts(kept), texts(new)))
    return [line for line in difflib.ndiff(kept, new) if line[0] in "-+"]


def raised(error):
    """What a cell raised, and the line of the notebook that did."""
    trace = re.sub(r"\x1b\[[\d;]*m", "", "\n".join(error.traceback))
    line = re.search(r"^-+> +\d+ +(.*)", trace, re.M)
    what = f"raised {error.ename}: {error.evalue or 'it does not hold'}"
    return f"{what}\n    {line[1]}" if line else what


def missing_witnesses(program):
    """Names of the engines that this build is without."""
    done = subprocess.run([program, "version"], check=True, capture_output=True, text=True)
    return set(re.findall(r"^witness (\w+) +absent", done.stdout, re.M))


def solutions(name):
    """{id of an exercise: the text of its solution} of the notebook of this name."""
    file = FOLDER / "solutions" / f"{name}.py"
    if not file.exists():
        return {}
    text = re.sub(r"^# from (\S+) (\S+)$", lambda other: solutions(other[1])[other[2]] + "\n", file.read_text(),
                  flags=re.M)
    parts = re.split(r"^# %% (\S+)\n", text, flags=re.M)
    return {exercise: solution.strip() for exercise, solution in zip(parts[1::2], parts[2::2])}


def with_solutions(notebook, path, nbformat):
    """The cells to run after a notebook's own: each exercise solved, and its check. And what is missing."""
    solved, cells, complaints = solutions(path.stem), [], []
    for cell, check in zip(notebook.cells, notebook.cells[1:]):
        if "exercise" not in cell.metadata.get("tags", []):
            continue
        if "raises-exception" not in check.metadata.get("tags", []):
            complaints.append(f"{path.name}: no check follows {cell.id}")
        if cell.id not in solved:
            complaints.append(f"{path.name}: no solution of {cell.id}")
            continue
        cells += [nbformat.v4.new_code_cell(solved.pop(cell.id)), nbformat.v4.new_code_cell(check.source)]
    return cells, complaints + [f"{path.name}: a solution of {name}, which is no exercise" for name in solved]


def shortened(cell):
    """An error without the trace, which names folders."""
    for output in cell.outputs:
        if output.output_type == "error":
            output.traceback = [f"{output.ename}: {output.evalue}"]


def tidy(notebook):
    """Without all that differs from run to run: counts, times, the version of Python."""
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook.metadata = {"kernelspec": kernel, "language_info": {"name": "python"}}
    for cell in notebook.cells:
        tags = cell.metadata.get("tags")
        cell.metadata = {"tags": tags} if tags else {}
        if cell.cell_type != "code":
            continue
        cell.execution_count = None
        merged = []  # how a stream comes in pieces is a matter of time
        for output in cell.outputs:
            if merged and output.output_type == "stream" == merged[-1].output_type \
                    and output.name == merged[-1].name:
                merged[-1].text += output.text
            else:
                merged.append(output)
        cell.outputs = merged
        shortened(cell)
        for output in cell.outputs:
            if "execution_count" in output:
                output.execution_count = None
            if output.output_type in ("display_data", "execute_result"):
                output.metadata = {kind: size for kind, size in output.metadata.items() if kind == "image/png"}


def test(path, missing, update, nbformat, nbclient):
    """Complaints about one notebook."""
    kept = nbformat.read(path, as_version=4)
    new = nbformat.read(path, as_version=4)
    own = len(new.cells)
    solved, complaints = with_solutions(new, path, nbformat)
    new.cells += solved
    try:
        nbclient.NotebookClient(new, timeout=PATIENCE, startup_timeout=PATIENCE, allow_errors=True,
                                kernel_name="python3",
                                resources={"metadata": {"path": str(FOLDER)}}).execute()
    except (nbclient.exceptions.CellTimeoutError, nbclient.exceptions.DeadKernelError) as error:
        return [f"{path.name}: {error}"]
    not_compared = 0
    for number, cell in enumerate(new.cells[own:]):
        for output in cell.outputs:
            if output.output_type == "error":
                complaints.append(f"{path.name}, solution or check {number // 2 + 1} of its exercises: {raised(output)}")
    del new.cells[own:]
    for number, (old, cell) in enumerate(zip(kept.cells, new.cells), 1):
        if cell.cell_type != "code":
            continue
        where = f"{path.name}, cell {number} ({cell.source.strip().splitlines()[0][:60]})"
        wrong = [output for output in cell.outputs if output.output_type == "error"]
        if "raises-exception" in cell.metadata.get("tags", []):
            if not wrong or wrong[0].ename != "AssertionError":
                complaints.append(f"{where}: an unsolved exercise must fail by an AssertionError, got "
                                  f"{raised(wrong[0]) if wrong else 'no error'}")
        elif wrong:
            complaints.append(f"{where}: {raised(wrong[0])}")
            break  # what follows builds on it
        if any("image/svg+xml" in output.get("data", {}) for output in cell.outputs):
            complaints.append(f"{where}: a picture as SVG, which nbconvert of Debian 12 leaves out of pages: PNG")
        tags = cell.metadata.get("tags", [])
        absent = {tag[len("needs-"):] for tag in tags if tag.startswith("needs-")} & missing
        if absent:
            not_compared += 1
            if update:
                complaints.append(f"{where}: no {', '.join(sorted(absent))} here to update it with")
        elif not update and (lines := differences(old.outputs, cell.outputs)):
            title = f"{where}: what it says differs from what is kept; kept (-) and new (+):"
            complaints.append("\n    ".join([title, *lines]))
    if update and not complaints:
        tidy(new)
        nbformat.write(new, path)
    verdict = "failed" if complaints else "updated" if update else "agrees"
    if not_compared:
        verdict += f", {not_compared} cells not compared: no {', '.join(sorted(missing))}"
    print(f"{path.name}: {verdict}", flush=True)
    return complaints


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda name: str(Path(name).resolve()))
    parser.add_argument("notebooks", nargs="*", type=Path)
    parser.add_argument("--update", action="store_true")
    arguments = parser.parse_args()
    try:
        import ipykernel  # noqa: F401  the kernel of the notebooks
        import nbclient
        import nbformat
        import numpy  # noqa: F401  used by the notebooks
        sys.path.insert(0, str(FOLDER))
        from dynwitness import _core  # noqa: F401  the module, in process
    except ImportError as error:
        print(f"skipped: {error}; on Debian: python3-nbclient python3-ipykernel python3-numpy, and ./dynwitness python")
        sys.exit(SKIP)
    paths = arguments.notebooks or sorted(FOLDER.glob("*.ipynb"))
    if not paths:
        sys.exit(f"{FOLDER}: no notebooks, expected some")
    complaints = []
    with tempfile.TemporaryDirectory(prefix="dynwitness") as home:
        # nobody's own kernels and settings take part, and nothing is left in a home
        for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR"):
            os.environ[name] = home
        os.environ.update(DYNWITNESS_PROGRAM=arguments.program, PYTHONDONTWRITEBYTECODE="1",
                          DYNWITNESS_CACHE=str(Path(home) / "kernels"), OPENBLAS_NUM_THREADS="1",
                          PYDEVD_DISABLE_FILE_VALIDATION="1")
        missing = missing_witnesses(arguments.program)
        for path in paths:
            complaints += test(path, missing, arguments.update, nbformat, nbclient)
    for complaint in complaints:
        print(complaint)
    if any("differs from what is kept" in complaint for complaint in complaints):
        print("If the change is meant: tests/project/run_notebooks.py build/bin/dynwitness --update")
    sys.exit(bool(complaints))


if __name__ == "__main__":
    main()
