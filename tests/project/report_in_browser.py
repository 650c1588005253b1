#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a report in headless Chromium, as a reader would, and complains about what a reader would miss.

    report_in_browser.py FOLDER [--screenshots FOLDER] [--most-printed PAGES]

Opens FOLDER/index.html and the pages of its scenes from the disk, for light and dark readers and on a
narrow screen. Exit status 1:
an error was logged, a picture is missing, its letters are not to be read in light or dark, a formula did not render, a link leads nowhere, something
was asked from the network, the page is wider than the screen, or all pages together take more than PAGES of
paper (Letter, which is the shorter). 77: there is no Chromium.
"""
import argparse
import base64
import fcntl
import html
import html.entities
import itertools
import json
import os
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.parse
import xml.etree.ElementTree
from pathlib import Path

SKIP = 77
PATIENCE = 60  # seconds for any one answer; the machine may be busy

FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-dev-shm-usage",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-extensions", "--disable-default-apps", "--remote-debugging-pipe",
]

# What a reader would miss, as a list of sentences. Runs in the page.
LOOK = r"""
(async () => {
  const wrong = [];
  const excerpt = e => e.outerHTML.replace(/\s+/g, ' ').slice(0, 100);
  const seen = e => { const b = e.getBoundingClientRect(); return b.width > 0 && b.height > 0; };
  for (const d of document.querySelectorAll('details')) d.open = true;

  const pictures = [...document.images];
  for (const image of pictures) {
    await image.decode().catch(() => {});
    if (!image.complete || image.naturalWidth === 0) wrong.push(`missing picture: ${image.currentSrc || image.src}`);
    else if (!seen(image)) wrong.push(`invisible picture: ${image.currentSrc}`);
    if (!image.alt) wrong.push(`picture without a description: ${excerpt(image)}`);
  }
  const trees = [...document.querySelectorAll('main svg.tree')];
  for (const tree of trees) if (!seen(tree)) wrong.push(`invisible picture: ${excerpt(tree)}`);
  for (const use of document.querySelectorAll('svg use'))
    if (!document.querySelector(use.getAttribute('href'))) wrong.push(`missing sign: ${excerpt(use)}`);

  const children = {mfrac: 2, msub: 2, msup: 2, munder: 2, mover: 2, mroot: 2, msubsup: 3, munderover: 3};
  const known = new Set(['math', 'mrow', 'mi', 'mn', 'mo', 'ms', 'mtext', 'mspace', 'msqrt', 'mstyle', 'mpadded',
    'mphantom', 'mtable', 'mtr', 'mtd', 'mmultiscripts', 'mprescripts', 'none', 'semantics', 'annotation',
    ...Object.keys(children)]);
  const formulas = [...document.querySelectorAll('math')];
  for (const formula of formulas) {
    const where = `formula did not render: ${excerpt(formula)}`;
    if (formula.namespaceURI !== 'http://www.w3.org/1998/Math/MathML') wrong.push(`${where} (not MathML)`);
    if (!seen(formula)) wrong.push(`${where} (nothing to see)`);
    if (!formula.textContent.trim()) wrong.push(`${where} (empty)`);
    for (const part of [formula, ...formula.querySelectorAll('*')]) {
      const words = [...part.childNodes].filter(n => n.nodeType === Node.TEXT_NODE).map(n => n.data.trim()).join('');
      if (words && !['mi', 'mn', 'mo', 'ms', 'mtext', 'annotation', 'merror'].includes(part.localName))
        wrong.push(`${where} (bare text: ${words})`);
      const n = children[part.localName];
      if (part.localName === 'merror') wrong.push(`${where} (merror: ${part.textContent})`);
      else if (!known.has(part.localName) || part.namespaceURI !== formula.namespaceURI)
        wrong.push(`${where} (what is <${part.localName}>?)`);
      else if (n && part.children.length !== n)
        wrong.push(`${where} (<${part.localName}> with ${part.children.length} parts instead of ${n})`);
    }
  }

  const ids = new Set();
  for (const e of document.querySelectorAll('[id]')) {
    if (ids.has(e.id)) wrong.push(`two elements with the id ${e.id}`);
    ids.add(e.id);
  }
  const files = [];
  for (const a of document.querySelectorAll('a[href]')) {
    const href = a.getAttribute('href');
    if (href.startsWith('#')) { if (!ids.has(href.slice(1))) wrong.push(`link to nowhere: ${href}`); }
    else files.push(a.href);
  }
  const page = document.scrollingElement;
  if (page.scrollWidth > page.clientWidth)
    wrong.push(`the page is wider than the screen: ${page.scrollWidth} > ${page.clientWidth}`);
  if (!document.querySelector('h1') || !document.querySelector('h1').textContent.trim()) wrong.push('no headline');
  for (const d of document.querySelectorAll('details')) d.open = false;
  return {wrong, files, pictures: pictures.length, trees: trees.length, formulas: formulas.length,
    paper: getComputedStyle(document.body).backgroundColor,
    drawings: pictures.map(image => image.currentSrc).filter(source => source.endsWith('.svg'))};
})()
"""

# Runs in a drawing that is the whole page, on PAPER: letters, and lines that are drawn, with the contrast that they have.
LOOK_AT_DRAWING = r"""
((paper, least) => {
  const wrong = [];
  const numbers = colour => { const n = (colour.match(/[\d.]+/g) || []).map(Number); return n.length < 3 ? null : n; };
  const light = ([r, g, b]) => {
    const [x, y, z] = [r, g, b].map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * x + 0.7152 * y + 0.0722 * z;
  };
  const contrast = (a, b) => { const [x, y] = [light(a), light(b)].sort((s, t) => t - s); return (x + 0.05) / (y + 0.05); };
  const whole = document.documentElement;
  const ground = [...document.querySelectorAll('rect, polygon')].map(e => [e.getBoundingClientRect(), numbers(getComputedStyle(e).fill)])
    .find(([box, fill]) => fill && box.width >= 0.99 * whole.clientWidth && box.height >= 0.99 * whole.clientHeight);
  const sheet = ground ? ground[1] : numbers(paper);
  let seen = 0;
  for (const letters of document.querySelectorAll('text')) {
    if (!letters.textContent.trim()) continue;
    const fill = numbers(getComputedStyle(letters).fill), has = fill ? contrast(fill, sheet) : 0;
    ++seen;
    if (has < least) wrong.push(`letters "${letters.textContent.trim().slice(0, 30)}" have a contrast of ${has.toFixed(2)}, at least ${least}`);
  }
  if (!seen) wrong.push('no letters');
  return wrong.slice(0, 3);
})"""

# of letters: Web Content Accessibility Guidelines 2.1, 1.4.3, level AA
LEAST_CONTRAST = 4.5


def find_chromium():
    wanted = [os.environ.get("DYNWITNESS_CHROMIUM"), "chromium", "chromium-browser", "google-chrome-stable",
              "google-chrome"]
    return next((found for name in wanted if name and (found := shutil.which(name))), None)


class Browser:
    """Chromium, spoken to through two pipes: JSON messages, each ended by a zero byte."""

    def __init__(self, program, profile):
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()
        # well away from 3 and 4, where Chromium wants its ends
        ends = [fcntl.fcntl(fd, fcntl.F_DUPFD, 20) for fd in (to_read, to_write)]
        os.close(to_read)
        os.close(to_write)
        self.log = tempfile.TemporaryFile()

        def place():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(
            [program, *FLAGS, f"--user-data-dir={profile}", "about:blank"], preexec_fn=place, close_fds=False,
            stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log,
            env={**os.environ, "HOME": profile})
        for fd in ends:
            os.close(fd)
        self.buffer, self.number, self.events = b"", 0, []

    def message(self, deadline):
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.back], [], [], max(0, deadline - time.monotonic()))
            data = os.read(self.back, 1 << 16) if ready else b""
            if not data:
                self.log.seek(0)
                sys.exit("report_in_browser: Chromium does not answer\n" +
                         self.log.read().decode(errors="replace")[-2000:])
            self.buffer += data
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, session=None, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if session:
            request["sessionId"] = session
        os.write(self.to, json.dumps(request).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while True:
            answer = self.message(deadline)
            if answer.get("id") != self.number:
                self.events.append(answer)
            elif "error" in answer:
                sys.exit(f"report_in_browser: {method}: {answer['error']}")
            else:
                return answer["result"]

    def wait_for(self, method):
        deadline = time.monotonic() + PATIENCE
        while not any(e.get("method") == method for e in self.events):
            self.events.append(self.message(deadline))

    def close(self):
        os.close(self.to)  # Chromium ends with its pipe
        os.close(self.back)
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def complaints(events):
    """Errors that the browser logged, and requests that left the disk."""
    for event in events:
        method, about = event.get("method"), event.get("params", {})
        if method == "Log.entryAdded" and about["entry"]["level"] in ("error", "warning"):
            entry = about["entry"]
            yield f"logged {entry['level']}: {entry['text']} {entry.get('url', '')}".rstrip()
        elif method == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning", "assert"):
            yield "console: " + " ".join(str(a.get("value", a.get("description"))) for a in about["args"])
        elif method == "Runtime.exceptionThrown":
            yield "exception: " + about["exceptionDetails"]["text"]
        elif method == "Network.requestWillBeSent":
            if urllib.parse.urlsplit(about["request"]["url"]).scheme not in ("file", "data"):
                yield f"asked from the network: {about['request']['url']}"


def sheets_of(browser, session):
    """Sheets of paper that the page takes, as it opens: what is folded away stays so."""
    pdf = base64.b64decode(browser.call("Page.printToPDF", session, printBackground=True,
                                        preferCSSPageSize=True)["data"])
    return len(re.findall(rb"/Type\s*/Page\b(?!s)", pdf))


def hard_to_read(browser, drawing, light, paper):
    """What of a drawing a reader of this light does not see on this paper. Drawings in pages take their colours from what
    the reader prefers, as they do alone, where a script can ask for them."""
    target = browser.call("Target.createTarget", url="about:blank")["targetId"]
    session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
    browser.events.clear()
    for domain in ("Page", "Runtime"):
        browser.call(f"{domain}.enable", session)
    browser.call("Emulation.setEmulatedMedia", session, features=[{"name": "prefers-color-scheme", "value": light}])
    browser.call("Page.navigate", session, url=drawing)
    browser.wait_for("Page.loadEventFired")
    answer = browser.call("Runtime.evaluate", session, returnByValue=True,
                          expression=f"{LOOK_AT_DRAWING}({json.dumps(paper)}, {LEAST_CONTRAST})")
    if "exceptionDetails" in answer:
        sys.exit(f"report_in_browser: {answer['exceptionDetails']}")
    browser.call("Target.closeTarget", targetId=target)
    return answer["result"]["value"]


def malformed_formulas(page):
    """HTML mends broken markup silently, so formulas are read as XML too."""
    def character(match):
        name = match.group(1)
        known = html.entities.html5.get(name + ";")
        return match.group(0) if name in ("lt", "gt", "amp", "quot", "apos") or not known else known
    found = re.findall(r"<math\b.*?</math>", page, re.S)
    if len(found) != len(re.findall(r"<math\b", page)):
        yield "formula did not render: a <math> is not closed"
    for formula in found:
        try:
            xml.etree.ElementTree.fromstring(re.sub(r"&(\w+);", character, formula))
        except xml.etree.ElementTree.ParseError as error:
            yield f"formula did not render: {error} in {formula[:100]}"


def main():
    parser = argparse.ArgumentParser(description="Opens a report in headless Chromium and looks at it.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--screenshots", type=Path, help="folder for a picture of each view")
    parser.add_argument("--most-printed", type=int, metavar="PAGES", help="sheets that all pages may take, printed")
    arguments = parser.parse_args()
    index = (arguments.folder / "index.html").resolve()
    if not index.is_file():
        sys.exit(f"report_in_browser: {index}: no such file")
    program = find_chromium()
    if not program:
        print("report_in_browser: skipped: no Chromium found (Debian: apt install chromium)")
        return SKIP

    pages = [index, *sorted(index.parent.glob("scenes/*/index.html"))]
    wrong, total, sheets, drawings = [], {"pictures": 0, "trees": 0, "formulas": 0}, 0, 0
    for one in pages:
        page = one.read_text(encoding="utf-8")
        wrong += malformed_formulas(page)
        if shutil.which("gnuplot"):
            wrong += [f"missing picture: {why}" for why in re.findall(r"The plot was left out: gnuplot[^<]*", page)]
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile)
        for one, (view, light, width) in itertools.product(
                pages, (("light", "light", 1280), ("dark", "dark", 1280), ("narrow", "light", 360))):
            where = f"{view}: " if one == index else f"{one.parent.name}, {view}: "
            target = browser.call("Target.createTarget", url="about:blank")["targetId"]
            session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            browser.events.clear()
            for domain in ("Page", "Runtime", "Log", "Network"):
                browser.call(f"{domain}.enable", session)
            browser.call("Emulation.setDeviceMetricsOverride", session, width=width, height=900,
                         deviceScaleFactor=1, mobile=view == "narrow")
            browser.call("Emulation.setEmulatedMedia", session,
                         features=[{"name": "prefers-color-scheme", "value": light}])
            browser.call("Page.navigate", session, url=one.as_uri())
            browser.wait_for("Page.loadEventFired")
            answer = browser.call("Runtime.evaluate", session, expression=LOOK, awaitPromise=True,
                                  returnByValue=True)
            if "exceptionDetails" in answer:
                sys.exit(f"report_in_browser: {answer['exceptionDetails']}")
            found = answer["result"]["value"]
            wrong += [where + sentence for sentence in [*found["wrong"], *complaints(browser.events)]]
            for link in found["files"]:
                part = urllib.parse.urlsplit(link)
                if part.scheme != "file" or not Path(urllib.parse.unquote(part.path)).is_file():
                    wrong.append(f"{where}link to nowhere: {link}")
            if view != "narrow":
                for drawing in found["drawings"]:
                    wrong += [f"{where}{urllib.parse.urlsplit(drawing).path.rsplit('/', 1)[1]}: {sentence}"
                              for sentence in hard_to_read(browser, drawing, light, found["paper"])]
                    drawings += 1
            if view == "light":
                for kind in total:
                    total[kind] += found[kind]
                sheets += sheets_of(browser, session) if arguments.most_printed else 0
            if arguments.screenshots:
                arguments.screenshots.mkdir(parents=True, exist_ok=True)
                shot = browser.call("Page.captureScreenshot", session, captureBeyondViewport=True)
                (arguments.screenshots / f"{'' if one == index else one.parent.name + '_'}{view}.png").write_bytes(base64.b64decode(shot["data"]))
            browser.call("Target.closeTarget", targetId=target)
        browser.close()
    if arguments.most_printed and sheets > arguments.most_printed:
        wrong.append(f"printed it takes {sheets} pages, allowed: {arguments.most_printed}")

    for sentence in dict.fromkeys(wrong):
        print(f"report_in_browser: {sentence}")
    print(f"report_in_browser: {index}: {len(pages)} pages, {total['pictures']} pictures, "
          f"{total['trees']} trees, {total['formulas']} formulas, {drawings} drawings in light and dark"
          f"{f', {sheets} sheets of paper' if sheets else ''}: {'as they should be' if not wrong else 'NOT as they should be'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
