#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""notebooks/export.py makes pages that ask no network for anything, and whose mathematics a browser without one shows.

    test_exported_pages.py    status 77: nbconvert or KaTeX is missing

One page is opened in Chromium, where there is one, without any host to resolve."""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OUTSIDE = re.compile(r"""<(?:script|img|link|iframe|source)\b[^>]*?(?:src|href)\s*=\s*["'](?!data:|\#)([^"']+)|url\(["']?(https?:[^)"']*)""")


def export(*words):
    return subprocess.run(["/usr/bin/python3", ROOT / "notebooks/export.py", *words], capture_output=True, text=True)


def shown_mathematics(page, folder):
    """How many formulas a browser shows, and how many dollar signs are left of TeX in what is read."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not browser:
        return None
    done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/profile",
                           "--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=8000", "--dump-dom",
                           f"file://{page}"], capture_output=True, text=True, timeout=300)
    body = re.sub(r"<(script|style|pre|annotation)\b.*?</\1>", "", done.stdout[done.stdout.find("<body"):], flags=re.S)
    return body.count('class="katex"'), re.sub(r"<[^>]*>", "", body).count("$")


def main():
    notebooks = sorted((ROOT / "notebooks").glob("*.ipynb"))
    with tempfile.TemporaryDirectory(prefix="dynwitness") as work:
        made = export(*notebooks, "-o", work)
        if made.returncode == 2 and "on Debian" in made.stderr:
            print(made.stderr)
            sys.exit(77)
        complaints = [made.stderr] if made.returncode else []
        for notebook in notebooks:
            page = (Path(work) / f"{notebook.stem}.html").read_text()
            complaints += [f"{notebook.stem}: asks for {a or b}" for a, b in OUTSIDE.findall(page)]
        # the question can find something: nbconvert's own pages ask for MathJax
        if not OUTSIDE.search('<script src="https://cdnjs.cloudflare.com/ajax/libs/mathjax/2.7.7/latest.js"></script>'):
            complaints.append("a script from outside is not found")
        seen = shown_mathematics(Path(work) / "07_from_energy_to_motion.html", work)
        if seen and (seen[0] < 30 or seen[1] > 0):  # 51 formulas when this was written
            complaints.append(f"07_from_energy_to_motion: {seen[0]} formulas are shown, {seen[1]} dollar signs are left")
        refused = export(ROOT / "README.md", "-o", work)
        if refused.returncode != 2 or "allowed: a notebook" not in refused.stderr:
            complaints.append(f"README.md is exported: {refused.stderr}")
    for complaint in complaints:
        print(complaint)
    print(f"{len(notebooks)} pages, formulas shown and left: {seen or 'no browser'}")
    sys.exit(bool(complaints))


if __name__ == "__main__":
    main()
