# SPDX-License-Identifier: GPL-3.0-or-later
"""What all pages of the site share: the frame around a text, links between pages, files that pages point to."""
import html
import os
import posixpath
import re
import shutil
from pathlib import Path

KATEX = Path("/usr/share/javascript/katex")
STARTER = ('<link rel="stylesheet" href="{up}katex/katex.min.css"><script src="{up}katex/katex.min.js"></script>'
           '<script src="{up}katex/auto-render.js"></script><script>addEventListener("DOMContentLoaded", () => '
           'renderMathInElement(document.querySelector("main"), {{delimiters: [{{left: "$$", right: "$$", display: true}}, '
           '{{left: "$", right: "$", display: false}}], throwOnError: false}}))</script>')


def slug(words):
    return re.sub(r"[^a-z0-9]+", "-", words.lower()).strip("-")


class Site:
    """A folder that fills with pages."""

    def __init__(self, folder, root, menu, homes):
        """menu: [(part, [(page, title)])]; homes: {file of the repository: page that shows it}."""
        self.folder, self.root, self.menu, self.homes = folder, root, menu, homes
        self.pages, self.missing = [], []
        folder.mkdir(parents=True)
        shutil.copy(Path(__file__).with_name("site.css"), folder / "site.css")
        self.maths = KATEX.is_dir()
        if self.maths:
            (folder / "katex").mkdir()
            for name in ("katex.min.css", "katex.min.js", "contrib/auto-render.js"):
                shutil.copy(KATEX / name, folder / "katex")
            shutil.copytree("/usr/share/fonts/truetype/katex", folder / "katex/fonts",
                            ignore=shutil.ignore_patterns("*.ttf", "*.woff"))
        else:
            self.left_out("mathematics as such (TeX is shown): libjs-katex")

    def left_out(self, what):
        self.missing.append(what)

    def _side(self, up, name):
        parts = []
        for part, pages in self.menu:
            here = any(page == name for page, _ in pages)
            links = "".join(f'<li><a href="{up}{page}"{" aria-current=page" if page == name else ""}>{html.escape(title)}</a></li>'
                            for page, title in pages)
            parts.append(f"<details{' open' if here else ''}><summary>{html.escape(part)}</summary><ul>{links}</ul></details>")
        return "".join(parts)

    def page(self, name, title, body, maths=False):
        """Writes a page: `name` is its path in the site, `body` what stands in <main>."""
        up = "../" * name.count("/")
        body = re.sub(r"<table>(.*?)</table>", r'<div class="wide"><table>\1</table></div>', body, flags=re.S)
        head = STARTER.format(up=up) if maths and self.maths else ""
        text = (f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
                f'<meta name="viewport" content="width=device-width, initial-scale=1">'
                f'<link rel="stylesheet" href="{up}site.css">{head}</head>\n<body><nav aria-label="Pages">'
                f'<a class="home" href="{up}index.html">dynwitness</a>{self._side(up, name)}</nav>\n<main>{body}</main></body></html>\n')
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        self.pages.append(name)

    def _target(self, link, source, up):
        """Where a link of a repository's text leads on the site."""
        if re.match(r"[a-z]+:", link) or link.startswith("#") and source + link not in self.homes:
            return link
        file, _, mark = link.partition("#")
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), file)) if file else source
        if f"{path}#{mark}" in self.homes:
            return up + self.homes[f"{path}#{mark}"]
        mark = f"#{mark}" if mark else ""
        if path in self.homes:
            return up + self.homes[path] + mark
        if path.endswith(".ipynb"):
            return f"{up}notebooks/{Path(path).stem}.html"
        there = self.root / path
        if there.is_dir():
            there = there / "README.md"
            if posixpath.join(path, "README.md") in self.homes:
                return up + self.homes[posixpath.join(path, "README.md")]
        if not there.is_file():
            return link  # broken_links() tells it
        copy = self.folder / "files" / os.path.relpath(there, self.root)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(there, copy)
        return f"{up}files/{os.path.relpath(there, self.root)}"

    def linked(self, text, source, up=""):
        """Markdown of the repository's file `source`, with links that hold on the site."""
        text = re.sub(r"(\]\()([^)\s]+)(\))", lambda m: m[1] + self._target(m[2], source, up) + m[3], text)
        return re.sub(r'((?:src|srcset|href)=")([^"]+)(")', lambda m: m[1] + self._target(m[2], source, up) + m[3], text)

    def broken_links(self):
        """Complaints: pages, files and marks that are linked to and not there, and what needs a network."""
        complaints, marks = [], {}
        for name in self.pages:
            text = (self.folder / name).read_text()
            marks[name] = set(re.findall(r'\bid="([^"]+)"', text))
        for name in self.pages:
            text = re.sub(r"<(pre|code)\b.*?</\1>", "", (self.folder / name).read_text(), flags=re.S)
            for attribute, link in re.findall(r'\b(href|src|srcset)="([^"]*)"', text):
                link = html.unescape(link)
                if link.startswith("data:"):
                    continue
                if re.match(r"[a-z]+:", link):
                    if attribute != "href":
                        complaints.append(f"{name}: needs a network for {link}")
                    continue
                file, _, mark = link.partition("#")
                path = posixpath.normpath(posixpath.join(posixpath.dirname(name), file)) if file else name
                if not (self.folder / path).is_file():
                    complaints.append(f"{name}: links to {link}, which is not there")
                elif mark and path in marks and mark not in marks[path]:
                    complaints.append(f"{name}: links to {link}, which has no such mark")
        return complaints
