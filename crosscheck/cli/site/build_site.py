#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Assembles the documentation site from what the repository and its programs say, without a network.

    build_site.py PROGRAM FOLDER [--scene NAME...]

PROGRAM is build/bin/dynwitness with all programs beside it. FOLDER gets the site; what stood there goes. --scene: these
alone in the gallery. Texts have their homes elsewhere (README.md, data/*/README.md, ...); of its own the site has
tutorial.md, whose commands are run. Needs python3-markdown. Doxygen, KaTeX (libjs-katex) and the Python module may be
missing: what needs them is left out, and that is told. Exit status 1: a link or an example is broken."""
import argparse
import html
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import cpp_pages
import markdown
import notebook_pages
from frame import Site, slug

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]

# page, title, where its text has its home: a file, or a file and one of its headings
TEXTS = [
    ("Explained", [
        ("verdicts", "What a crosscheck says", "README.md", "What a crosscheck says"),
        ("limits", "How limits come about", "CONTRIBUTING.md", "How limits come about"),
        ("conventions", "Conventions", "README.md", "Conventions"),
        ("digits", "Digits that survive", "crosscheck/verdicts/digits.md", None),
        ("sensitivity", "Limits beside faults", "crosscheck/verdicts/sensitivity.md", None),
        ("long-runs", "Long runs", "crosscheck/motion/long_runs.md", None)]),
    ("How to", [
        ("check-your-code", "Check your own code", "README.md", "Check your own code"),
        ("engines", "Engines in other languages", "data/engines/README.md", None),
        ("golden", "Answers for your tests", "crosscheck/golden/golden.md", None),
        ("grade", "Grade a class", "crosscheck/grade/grade.md", None),
        ("readers", "Your file on the stand", "crosscheck/readers/readers.md", None),
        ("campaigns", "Thousands of cases", "data/campaigns/README.md", None),
        ("more-commands", "A command for each question", "README.md", "More commands"),
        ("contributing", "Extend dynwitness", "CONTRIBUTING.md", None)]),
    ("Reference", [
        ("scene-format", "The scene format", "data/scenes/README.md", None),
        ("features", "What commands make of it", "crosscheck/inputs/features.md", None),
        ("protocol", "The protocol of engines", "crosscheck/witnesses/engine_protocol.md", None),
        ("published", "Published numbers", "data/reference/README.md", None),
        ("from-cpp", "From C++", "README.md", "From C++"),
        ("from-python", "From Python", "README.md", "From Python"),
        ("changelog", "Changes", "CHANGELOG.md", None)]),
    ("Teaching", [("course", "A course of twelve weeks", "notebooks/README.md", None)]),
]


def section(text, heading):
    """A chapter of a README, its heading one level up."""
    found = re.search(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    if not found:
        sys.exit(f"build_site.py: no heading '## {heading}'")
    return f"# {heading}\n{found[1]}"


def rendered(text):
    return markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "sane_lists"])


def ran(program, command):
    """What a command of the tutorial prints. It has to succeed."""
    folder = Path(program).parent
    words = command.replace("./dynwitness", str(folder / "dynwitness"))
    done = subprocess.run(["bash", "-c", words], cwd=ROOT, capture_output=True, text=True, stdin=subprocess.DEVNULL,
                          env={**os.environ, "DYNWITNESS_PROGRAM": str(program)}, timeout=300)
    expected = 1 if "  # finds a fault" in command else 0
    if done.returncode != expected:
        sys.exit(f"build_site.py: tutorial.md: {command}: exit status {done.returncode}, expected {expected}\n{done.stderr}")
    return done.stdout.rstrip()


def tutorial(program):
    """tutorial.md with the output of each block marked `sh run`, its first `lines=N` lines."""
    def with_output(block):
        most, command = int(block[1] or 1000), block[2].strip()
        lines = ran(program, command).splitlines()
        shown = lines[:most] + (["..."] if len(lines) > most else [])
        shown = "\n".join(shown).replace(str(ROOT) + "/", "")
        return f"```sh\n{command.replace('  # finds a fault', '')}\n```\n\n```text\n{shown}\n```\n"
    return re.sub(r"^```sh run(?: lines=(\d+))?\n(.*?)^```\n", with_output, (HERE / "tutorial.md").read_text(),
                  flags=re.M | re.S)


def commands():
    """[(name, what it does)] in the order of --help."""
    lines = (ROOT / "crosscheck/cli/commands.txt").read_text().splitlines()
    return [(line.split()[0], line.split(None, 2)[2]) for line in lines if re.match(r"[a-z]", line)]


def command_pages(site, program):
    """A page a command: what its own --help says."""
    rows = []
    for name, words in commands():
        said = subprocess.run([program, name, "--help"], capture_output=True, text=True, check=True).stdout
        said = html.escape(said).replace("dynwitness ", "./dynwitness ").replace("Usage: ./dynwitness", "Usage: dynwitness")
        site.page(f"commands/{name}.html", name, f"<h1><code>dynwitness {name}</code></h1>\n<pre>{said}</pre>")
        rows.append(f'<tr><td><a href="{name}.html"><code>{name}</code></a></td><td>{html.escape(words)}</td></tr>')
    site.page("commands/index.html", "Commands", "<h1>Commands</h1>\n<p>Each page is what <code>--help</code> says; the "
              f"man page and the completion of shells are made of the same.</p>\n<table>{''.join(rows)}</table>")


def scene_names(program):
    listed = subprocess.run([program, "scenes"], capture_output=True, text=True, check=True).stdout
    return [(line.split()[0], line.split(" dof ", 1)[1].strip(), line.split()[1])
            for line in listed.splitlines() if " dof " in line]


def box_around(drawing):
    """The viewBox of what is drawn: lines, points, and circles by where they are and how large."""
    xs, ys = [0.0], [0.0]
    for x, y in re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", drawing) + re.findall(r'cx="(-?[\d.]+)" cy="(-?[\d.]+)"', drawing):
        xs.append(float(x))
        ys.append(float(y))
    for numbers in re.findall(r'class="outline" r="1" transform="matrix\(([^)]*)\)"', drawing):
        a, b, c, d, x, y = map(float, numbers.split())
        wide, high = (a * a + c * c) ** 0.5, (b * b + d * d) ** 0.5
        xs += [x - wide, x + wide]
        ys += [y - high, y + high]
    margin = 0.08 * max(max(xs) - min(xs), max(ys) - min(ys))
    return (f"{min(xs) - margin:.0f} {min(ys) - margin:.0f} {max(xs) - min(xs) + 2 * margin:.0f} "
            f"{max(ys) - min(ys) + 2 * margin:.0f}")


def gallery(site, program, only):
    """A picture of each bundled scene, and its page with one that moves."""
    cards = []
    (site.folder / "scenes").mkdir()
    for name, title, dof in scene_names(program):
        if only and name not in only:
            continue
        page = site.folder / "scenes" / f"{name}.html"
        subprocess.run([program, "show", name, "-q", "-o", page], check=True, capture_output=True)
        drawing = re.search(r'<svg id="picture".*?</svg>', page.read_text(), re.S)[0]
        drawing = re.sub(r'<svg id="picture"(.*?)viewBox="[^"]*"', rf'<svg\1viewBox="{box_around(drawing)}"', drawing)
        drawing = drawing.replace(' aria-describedby="keys"', "")
        drawing = re.sub(r"<title>.*?</title>", "", drawing)
        cards.append(f'<a class="scene" href="scenes/{name}.html">{drawing}<b>{html.escape(title)}</b>'
                     f"<small><code>{name}</code>, {dof} degrees of freedom</small></a>")
    style = (ROOT / "crosscheck/report/view.css").read_text()
    drawn = "\n".join(line for line in style.splitlines() if line.startswith(".drawn"))
    site.page("gallery.html", "Gallery", "<h1>Bundled scenes</h1>\n<p>Each links to what <code>dynwitness show</code> writes: "
              "joints, masses, what is modelled, what is always zero and why, and a picture to turn and to move.</p>\n"
              f"<style>{drawn}</style><div class=\"scenes\">{''.join(cards)}</div>")


def python_page(site, program):
    """Docstrings of the package, as Python itself gives them."""
    listing = ("import inspect, dynwitness as dw\n"
               "print('##', 'the module'); print(dw.__doc__)\n"
               "for n in sorted(x for x in dir(dw) if not x.startswith('_')):\n"
               "    x = getattr(dw, n)\n"
               "    if inspect.ismodule(x) or not x.__doc__: continue\n"
               "    print('##', n); print(inspect.cleandoc(x.__doc__))\n"
               "for n in sorted(x for x in dir(getattr(dw, 'Scene', None)) if not x.startswith('_')):\n"
               "    print('##', 'Scene.' + n); print(inspect.cleandoc(getattr(dw.Scene, n).__doc__ or ''))\n"
               "print('##', 'testing.assert_engine'); print(inspect.cleandoc(dw.testing.assert_engine.__doc__))\n")
    done = subprocess.run(["/usr/bin/python3", "-c", listing], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "crosscheck/python")})
    if done.returncode or "Scene.M" not in done.stdout:
        site.page("python.html", "Python interface", "<h1>Python interface</h1><p>Not built: the module was missing.</p>")
        site.left_out("the Python interface: ./dynwitness python builds the module")
        return
    parts = re.split(r"^## (\S.*)\n", done.stdout, flags=re.M)[1:]
    body = "".join(f'<h3 id="{slug(name)}"><code>{html.escape(name)}</code></h3><pre class="doc">{html.escape(text.strip())}</pre>'
                   for name, text in zip(parts[::2], parts[1::2]))
    site.page("python.html", "Python interface", f"<h1>Python interface</h1>\n{body}")


def audit_page(site, program):
    """The chapter's audit writes its own page."""
    subprocess.run([program, "audit", "-q", "-o", site.folder / "audit"], check=True, capture_output=True)


def menu_of(notebooks):
    """[(part, [(page, title)])], as the side of each page has it."""
    menu = {"Start": [("index.html", "dynwitness"), ("tutorial.html", "Tutorial"), ("gallery.html", "Gallery of scenes")]}
    menu |= {part: [(f"{page}.html", title) for page, title, *_ in pages] for part, pages in TEXTS}
    menu["Explained"].append(("audit/index.html", "The chapter's audit"))
    menu["Reference"][:0] = [("commands/index.html", "Commands"), ("cpp/index.html", "C++ interface"),
                             ("python.html", "Python interface")]
    menu["Teaching"] += [(f"notebooks/{stem}.html", f"{int(stem[:2])}. {title}") for stem, title in notebooks]
    return list(menu.items())


def homes():
    """{file, or file#heading, of the repository: the page that shows it}."""
    found = {"README.md": "index.html"}
    for _, pages in TEXTS:
        for page, _, source, part in pages:
            found[f"{source}#{slug(part)}" if part else source] = f"{page}.html"
    return found


def front_page(site):
    readme = (ROOT / "README.md").read_text()
    start = readme[: readme.index("## What a crosscheck says")]
    links = "".join(f"<section><h2>{html.escape(part)}</h2><ul>" +
                    "".join(f'<li><a href="{target}">{html.escape(title)}</a></li>' for target, title in pages) +
                    "</ul></section>" for part, pages in site.menu)
    site.page("index.html", "dynwitness", rendered(site.linked(start, "README.md")) + f'<div class="menu">{links}</div>')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scene", action="append", default=[])
    arguments = parser.parse_args()
    program, there = arguments.program.resolve(), arguments.folder
    if there.exists() and not (there / "site.css").is_file() and (not there.is_dir() or any(there.iterdir())):
        print(f"build_site.py: {there} is no site of an earlier call; allowed: such one, an empty folder or a new one",
              file=sys.stderr)
        sys.exit(2)
    draft = arguments.folder.resolve().with_suffix(".draft")
    shutil.rmtree(draft, ignore_errors=True)
    site = Site(draft, ROOT, menu_of(notebook_pages.titles(ROOT / "notebooks")), homes())
    site.page("tutorial.html", "Tutorial", rendered(site.linked(tutorial(program), "crosscheck/cli/site/tutorial.md")))
    for _, pages in TEXTS:
        for page, title, source, part in pages:
            text = (ROOT / source).read_text()
            site.page(f"{page}.html", title, rendered(site.linked(section(text, part) if part else text, source)))
    command_pages(site, program)
    gallery(site, program, arguments.scene)
    audit_page(site, program)
    python_page(site, program)
    cpp_pages.write(site)
    notebook_pages.write(site, rendered)
    front_page(site)
    complaints = site.broken_links()
    shutil.rmtree(arguments.folder, ignore_errors=True)
    draft.rename(arguments.folder)
    print("\n".join([*(f"left out: {what}" for what in site.missing), *complaints,
                     f"{arguments.folder}/index.html: {len(site.pages)} pages"]))
    sys.exit(bool(complaints))


if __name__ == "__main__":
    main()
