# SPDX-License-Identifier: GPL-3.0-or-later
"""What takes the whole program: verdicts, simulations, pictures. It is run, and its files are read.

It is the ./dynwitness of this checkout (it builds itself when first called), or what the environment
variable DYNWITNESS_PROGRAM names. A scene is a name (`run("scenes")` lists them), a TOML, URDF or MJCF
file, a `Scene`, or a `SceneText`. Pictures are drawn by gnuplot.
"""
import json
import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

try:  # where pip was told to install it from
    from ._checkout import ROOT
    ROOT = Path(ROOT)
except ImportError:
    ROOT = Path(__file__).resolve().parents[3]


class ProgramFailed(Exception):
    """The program ended with a status that is not success; the text is its own message."""

    def __init__(self, words, status, message):
        super().__init__(f"dynwitness {' '.join(words)}: exit status {status}\n{message}")
        self.status, self.message = status, message


def run(*words, agreed_only=True):
    """Standard output of the program. Statuses that are not 0 raise ProgramFailed; with
    agreed_only=False status 1 (a disagreement was found) does not."""
    program = os.environ.get("DYNWITNESS_PROGRAM") or str(ROOT / "dynwitness")
    words = [str(word) for word in words]
    try:
        done = subprocess.run([program, *words], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True)
    except OSError as error:
        raise RuntimeError(f"{program} does not start: {error.strerror} (it is DYNWITNESS_PROGRAM, "
                           "or else the wrapper script of this checkout)") from None
    if done.returncode and (agreed_only or done.returncode != 1):
        raise ProgramFailed(words, done.returncode, done.stderr.strip())
    return done.stdout


class SceneText(str):
    """The text of a TOML scene file. `SceneText.read(name)` is a bundled one, which `swap` changes."""

    @classmethod
    def read(cls, name):
        return cls((ROOT / "data" / "scenes" / f"{name}.toml").read_text())

    def swap(self, old, new):
        """The scene with `old`, which must be there exactly once, replaced by `new`."""
        if self.count(old) != 1:
            raise ValueError(f"swap: {old!r} is there {self.count(old)} times, expected once")
        return SceneText(self.replace(old, new))


class _Files:
    """A folder for one call: what the program reads and writes there is gone afterwards."""

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="dynwitness")
        self.path = Path(self._folder.name)
        return self

    def __exit__(self, *_):
        self._folder.cleanup()

    def scene(self, scene):
        if hasattr(scene, "toml"):  # a Scene in process
            scene = SceneText(scene.toml())
        if not isinstance(scene, SceneText):
            return scene
        (self.path / "scene.toml").write_text(scene)
        return self.path / "scene.toml"

    def table(self, name="table.csv"):
        """{column: array} of a CSV file; columns that are not numbers stay text."""
        lines = (self.path / name).read_text().splitlines()
        header, *rows = (line.split(",") for line in lines if not line.startswith("#"))
        table = {}
        for column, cells in zip(header, zip(*rows)):
            try:
                table[column] = np.array([float(cell) for cell in cells])
            except ValueError:
                table[column] = np.array(cells)
        return table


def evaluate(scene, quantities, witness=None, **states):
    """{quantity: array} at given states.

    quantities: as on the command line, "M,c,g,tau,qdd,kinetic,potential,...".
    states: q=, qd=, and qdd= or tau=, one state (n numbers) or many (an array of states x n);
        those left out are 0. Without any: the start of the scene.
    Arrays have shape (states, n, n) for M, (states,) for energies and (states, n) else; SI units.
    """
    with _Files() as files:
        words = ["evaluate", files.scene(scene), "--quantity", quantities]
        words += ["-o", files.path / "table.csv"]
        if states:
            blocks = {name: np.atleast_2d(np.asarray(x, float)) for name, x in states.items()}
            count, n = np.broadcast_shapes(*(block.shape for block in blocks.values()))
            blocks = {"q": np.zeros((count, n)), "qd": np.zeros((count, n)), **blocks}
            if "tau" in quantities.split(","):
                blocks.setdefault("qdd", np.zeros((count, n)))
            if "qdd" in quantities.split(","):
                blocks.setdefault("tau", np.zeros((count, n)))
            lines = [",".join(f"{name}{i + 1}" for name in blocks for i in range(n))]
            for row in np.hstack([np.broadcast_to(block, (count, n)) for block in blocks.values()]):
                lines.append(",".join(repr(float(number)) for number in row))
            (files.path / "states.csv").write_text("\n".join(lines) + "\n")
            words += ["--states", files.path / "states.csv", "--convention", "dynwitness"]
        if witness:
            words += ["--witness", witness]
        run(*words)
        columns = {}
        for name, values in files.table().items():
            columns.setdefault(re.sub(r"[\d_]+$", "", name), []).append((name, values))
    result = {}
    for quantity, entries in columns.items():
        values = np.stack([values for _, values in entries], axis=1)
        if quantity == "M":
            n = int(round(len(entries) ** 0.5))
            values = values.reshape(-1, n, n)
        result[quantity] = values[:, 0] if entries[0][0] == quantity else values
    return result


def crosscheck(scene, *options):
    """What `dynwitness crosscheck SCENE` puts into report.json; look at its ["verdict"]. Charts
    and the 10 s simulations are left out."""
    with _Files() as files:
        report = files.path / "report.json"
        run("crosscheck", files.scene(scene), "--no-charts", "--no-drift", *options,
            "-o", files.path / "report", "--json", report, agreed_only=False)
        return json.loads(report.read_text())


class Report(str):
    """What the program says, as it prints it; a notebook shows it as it stands. `right`: its verdict."""

    def __new__(cls, text, right):
        report = super().__new__(cls, text)
        report.right = right
        return report

    def _repr_html_(self):
        return f"<pre>{_escaped(str(self))}</pre>"

    def __repr__(self):
        return str(self)


# of what each quantity of an engine is a function, in the order of its arguments
ARGUMENTS = {"tau": ("q", "qd", "qdd"), "M": ("q",), "c": ("q", "qd"), "g": ("q",)}


def _answers(functions, scene, states, seed):
    """A table of random states and what the functions answer there, as `check --answers` reads it."""
    draw = np.random.default_rng(seed)
    given = {name: draw.uniform(-3, 3, (states, scene.n)) for name in ("q", "qd", "qdd")}
    names = [f"{part}{i + 1}" for part in given for i in range(scene.n)]
    blocks = list(given.values())
    for quantity, function in functions.items():
        shape = (scene.n, scene.n) if quantity == "M" else (scene.n,)
        rows = []
        for k in range(states):
            answer = np.asarray(function(*(given[part][k].copy() for part in ARGUMENTS[quantity])), float)
            if answer.shape != shape:
                raise ValueError(f"fn: {quantity}: expected shape {shape}, got {answer.shape}")
            rows.append(answer.ravel())
        if quantity == "M":
            names += [f"M{i + 1}{'_' if scene.n > 9 else ''}{j + 1}" for i in range(scene.n) for j in range(scene.n)]
        else:
            names += [f"{quantity}{i + 1}" for i in range(scene.n)]
        blocks.append(np.array(rows))
    lines = [",".join(names)]
    lines += [",".join(repr(float(x)) for x in row) for row in np.hstack(blocks)]
    return "\n".join(lines) + "\n"


def check(fn, scene, *, states=10, seed=1):
    """Is a Python function the dynamics of a scene? The Report of `dynwitness check`: where it is wrong, in
    which term, and which mistake would have answered the same. `report.right` is the verdict.

    fn: a function fn(q, qd, qdd) that gives tau, or a dictionary of functions: {"tau": fn(q, qd, qdd),
        "M": fn(q), "c": fn(q, qd), "g": fn(q)}. Called with one state at a time, arrays of shape (n,)
        [rad, rad/s, rad/s^2; m for slides]; M has shape (n, n), the others (n,) [N m, N].
    scene: a Scene, or what load() takes. Rates have to be derivatives of positions.
    states: how many random states, at most 10. seed: of these.

    Each answer is judged by what an algorithm of its kind may lose in rounding.
    """
    from . import load
    scene = scene if hasattr(scene, "toml") else load(str(scene))
    functions = fn if isinstance(fn, dict) else {"tau": fn}
    unknown = [name for name in functions if name not in ARGUMENTS]
    if unknown or not functions:
        raise ValueError(f"fn: {', '.join(map(str, unknown)) or 'no quantity'}, allowed: {', '.join(ARGUMENTS)}")
    if not 1 <= states <= 10:
        raise ValueError(f"states: {states}, allowed: 1 to 10")
    if scene.nq != scene.n:
        raise ValueError(f"scene: {scene.name} has {scene.nq} positions for {scene.n} rates, allowed: "
                         "joints whose rates are derivatives of their positions")
    with _Files() as files:
        (files.path / "answers.csv").write_text(_answers(functions, scene, states, seed))
        right = True
        try:
            run("check", files.scene(scene), "--answers", files.path / "answers.csv", "-o",
                files.path / "report.txt")
        except ProgramFailed as failed:
            if failed.status != 1:
                raise
            right = False
        return Report((files.path / "report.txt").read_text(), right)


def chart(scene, quantity="tau", *options):
    """The Drawing that `dynwitness chart SCENE --quantity QUANTITY` draws: time of one evaluation against
    worst error, of all methods; quantity: M, tau or qdd. It measures, which takes seconds to minutes."""
    if quantity not in ("M", "tau", "qdd"):
        raise ValueError(f"quantity: {quantity!r}, allowed: M, tau, qdd")
    with _Files() as files:
        run("chart", files.scene(scene), "--quantity", quantity, *options, "-o", files.path / "charts")
        svg = next((files.path / "charts").glob(f"*_{quantity}.svg")).read_text()
        return Drawing(svg[svg.index("<svg"):], f"{quantity} of {_name(scene)}: time against error, by method")


def audit(*equations):
    """What `dynwitness audit --json` says of the textbook chapter: all of it, or these entries ("15")."""
    with _Files() as files:
        words = [word for equation in equations for word in ("--equation", equation)]
        run("audit", *words, "--json", files.path / "audit.json", agreed_only=False)
        return json.loads((files.path / "audit.json").read_text())


def _name(scene):
    return scene.name if hasattr(scene, "name") else "the scene" if isinstance(scene, SceneText) else str(scene)


def show(scene):
    """What `dynwitness show SCENE --format json` says, and the drawing of the mechanism at its start.

    Returns (dictionary, Drawing)."""
    with _Files() as files:
        facts = json.loads(run("show", files.scene(scene), "--format", "json", "-o", files.path / "page.html"))
        page = (files.path / "page.html").read_text()
    svg = re.search(r'<svg id="picture".*?</svg>', page, re.S).group(0)
    style = re.search(r"<style>(.*?)</style>", page, re.S).group(1)
    # the drawing's own rules and colours, which on the page stand with all others
    colours = re.search(r":root \{(.*?)\}", style, re.S).group(1)
    rules = "\n".join(line for line in style.splitlines() if line.startswith(".drawn"))
    svg = svg.replace('id="picture" ', 'xmlns="http://www.w3.org/2000/svg" width="480" height="360" ', 1)
    head = svg.index(">") + 1
    svg = f"{svg[:head]}<style>.drawn {{{colours}}}\n{rules}</style>{svg[head:]}"
    return facts, Drawing(svg, f"{_name(scene)} at its start")


def scene_html(scene):
    """A Scene in a notebook: what it is, its drawing, and which q is which joint."""
    facts, picture = show(scene)
    rows = [(joint["name"], joint["kind"], " ".join(joint["q"]), " ".join(joint["qd"]), joint["parent"], joint["child"])
            for joint in facts["joints"] if joint["kind"] != "fixed"]
    table = Table(["joint", "kind", "q", "qd", "parent", "child"], rows)
    return f"<p><b>{_escaped(scene.title)}</b> ({_escaped(scene.name)})</p>{picture.svg}{table._repr_html_()}"


def parameters(scene, *options):
    """What `dynwitness parameters SCENE --json` writes: which parameters the motion knows."""
    with _Files() as files:
        run("parameters", files.scene(scene), *options, "--json", files.path / "parameters.json")
        return json.loads((files.path / "parameters.json").read_text())


def drift(scene, *options):
    """The table of `dynwitness drift SCENE --csv`: method, step_s, worst_error, scale_J."""
    with _Files() as files:
        run("drift", files.scene(scene), *options, "--csv", files.path / "table.csv")
        return files.table()


def simulate(scene, *options):
    """What `dynwitness simulate SCENE` prints, and its table: time_s, q1.., qd1.., ..."""
    with _Files() as files:
        text = run("simulate", files.scene(scene), *options, "--csv", files.path / "table.csv")
        return text, files.table()


def growth(*options):
    """The table of `dynwitness growth`: family, links, method, fd_error and times [ns]."""
    with _Files() as files:
        run("growth", *options, "-o", files.path)
        return files.table("growth.csv")


def ulps(a, b):
    """Largest |a - b| in units of the last place of the largest |b|, 2^-52 max |b|: a rounding on
    the way to a number adds at most a half, times what was rounded over max |b|."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    return float(np.abs(a - b).max() / (np.finfo(float).eps * np.abs(b).max()))


class Step(NamedTuple):
    """One step of a derivation."""

    name: str        # such as "mass matrix M"
    sentence: str    # what it is
    equations: list  # LaTeX
    check: str       # what the program checked, and how that went; "" of a legend, or with --no-checks

    def _repr_latex_(self):
        return Maths({self.name: self}, self.name)._repr_latex_()


def derive(scene, *options):
    """The steps of `dynwitness derive SCENE`, by name; options as there: "--only", "M12,c2"."""
    with _Files() as files:
        text = run("derive", files.scene(scene), *options, "--format", "latex")
    steps = {}
    for part in text.split(r"\paragraph{")[1:]:
        words = re.match(r"\d+\. (.*?)} (.*?)\n(?:.*Check: (.*?)}\n)?", part, re.S).groups("")
        equations = re.findall(r"\$\\displaystyle (.*?)\$\n", part, re.S)
        name, sentence, check = (word.replace(r"\_", "_") for word in words)
        steps[name] = Step(name, sentence, equations, check)
    return steps


def python_function(scene):
    """f(q, qd) -> M, c, g, the function that `dynwitness derive SCENE --format python` writes."""
    with _Files() as files:
        source = run("derive", files.scene(scene), "--format", "python")
    names = {}
    exec(compile(source, "derived.py", "exec"), names)
    return names[re.search(r"^def (\w+)\(q, qd", source, re.M).group(1)]


class Maths:
    """Named steps of a derivation, equation below equation; notebooks show them as mathematics."""

    def __init__(self, steps, *names):
        self.equations = [line for name in names for line in steps[name].equations]

    def _repr_latex_(self):
        rows = r" \\ ".join(equation.replace(" = ", " &= ", 1) for equation in self.equations)
        return rf"$$\begin{{aligned}} {rows} \end{{aligned}}$$"

    def __repr__(self):
        return "\n".join(self.equations)


def _escaped(text):
    return re.sub("[&<>]", lambda sign: f"&#{ord(sign[0])};", text)


class Table:
    """Rows under a header, which a notebook shows as a table."""

    def __init__(self, header, rows):
        self.rows = [[str(cell) for cell in row] for row in [header, *rows]]

    def _repr_html_(self):
        def row(cells, tag):
            left = f'<{tag} style="text-align: left">{cells[0]}</{tag}>'
            others = "".join(f"<{tag}>{cell}</{tag}>" for cell in cells[1:])
            return f"<tr>{left}{others}</tr>"

        escaped = [[_escaped(cell) for cell in line] for line in self.rows]
        rows = [row(escaped[0], "th"), *(row(line, "td") for line in escaped[1:])]
        return "\n".join(["<table>", *rows, "</table>"])

    def __repr__(self):
        widths = [max(map(len, column)) for column in zip(*self.rows)]
        return "\n".join("  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths)).rstrip()
                         for row in self.rows)


class Drawing:
    """An SVG that the program made, which Jupyter shows; `what` says in words what is to be seen."""

    def __init__(self, svg, what):
        self.svg, self.what = svg, what

    def _repr_svg_(self):
        return self.svg

    def __repr__(self):
        return f"drawing: {self.what}"


class Picture:
    """A PNG of twice as many dots as it is wide [px], which a notebook shows; `what` says in words what is to be
    seen. Not SVG: nbconvert of Debian 12 exports pages without them."""

    def __init__(self, png, width, what):
        self.png, self.width, self.what = png, width, what

    def _repr_png_(self):
        return self.png, {"width": self.width}

    def __repr__(self):
        return f"picture: {self.what}"


def plot(what, commands, size=(760, 360), **data):
    """A picture that gnuplot draws in the project's style.

    commands: a gnuplot script, whose lines may also end after a comma; each name in `data` is there
        a data block, `plot $name using 1:2 ...`, with one column for each of the given sequences.
    size: [px], of screens of ordinary density.
    """
    lines = [f"load '{ROOT / 'crosscheck' / 'report' / 'style.gp'}'",
             f"set terminal pngcairo size {2 * size[0]},{2 * size[1]} fontscale 2 linewidth 2 pointscale 2 enhanced "
             "rounded background rgb 'white' font 'Liberation Sans,Arial,Helvetica,sans-serif,7'"]
    for name, columns in data.items():
        rows = (",".join(f"{cell:.6g}" for cell in row) for row in zip(*columns, strict=True))
        lines += [f"${name} << END", *rows, "END"]
    lines.append(re.sub(r",\s*\n", ", ", commands))
    done = subprocess.run(["gnuplot"], input="\n".join(lines).encode(), capture_output=True)
    if done.returncode or not done.stdout.startswith(b"\x89PNG"):
        raise RuntimeError(f"gnuplot: {done.stderr.decode().strip() or 'drew nothing'}")
    return Picture(done.stdout, size[0], what)
