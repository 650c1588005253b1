#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A derivation as a page, printed: no equation is cut at the margin, and what is folded on the screen is on the paper.

    test_printed_derivation.py PROGRAM    status 77: there is no Chromium, or no pdftotext (Debian: poppler-utils)

Text that is clipped is not in the PDF, so that the right sides of long equations are looked for there."""
import shutil
import subprocess
import sys
import tempfile


def main():
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not browser or not shutil.which("pdftotext"):
        print("no Chromium, or no pdftotext")
        return 77
    with tempfile.TemporaryDirectory(prefix="dynwitness") as work:
        page, paper = f"{work}/page.html", f"{work}/paper.pdf"
        subprocess.run([sys.argv[1], "derive", "double_pendulum", "--format", "html", "-o", page], check=True)
        subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={work}/profile",
                        f"--print-to-pdf={paper}", f"file://{page}"], check=True, capture_output=True, timeout=300)
        text = subprocess.run(["pdftotext", paper, "-"], check=True, capture_output=True, text=True).stdout
    failures = []
    # twice in the last step's sentence, and at the end of both equations of motion
    taus = sum(text.count(tau) for tau in "\u03c4\U0001d70f")
    if taus != 4:
        failures.append(f"tau stands {taus} times on paper, expected 4: an equation of motion is cut")
    if "carried from joint to joint" not in " ".join(text.split()):
        failures.append("checks that are folded on the screen are not on paper")
    if "copy LaTeX" in text:
        failures.append("buttons are printed")
    print("\n".join(failures) or "whole on paper")
    return bool(failures)


if __name__ == "__main__":
    sys.exit(main())
