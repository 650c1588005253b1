#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Notebooks as pages that need no network, each one file: nbconvert's pages with KaTeX in place of MathJax, and no require.js.

    /usr/bin/python3 notebooks/export.py NOTEBOOK.ipynb... [-o FOLDER]

What the notebooks show is in them already: pictures as PNG, tables as HTML, formulas as TeX, which the page typesets itself. A
page is dark where the reader's browser is, and is printed on white. Exit status 2: a file is no notebook, or a package is
missing (Debian: python3-nbconvert libjs-katex)."""
import argparse
import base64
import json
import re
import sys
from pathlib import Path

KATEX = Path("/usr/share/javascript/katex")
PAGE = """{%- extends 'lab/index.html.j2' -%}
{%- block html_head_js -%}{%- endblock -%}
{%- block html_head_js_mathjax -%}
<style media="screen and (prefers-color-scheme: dark)">{{ resources.dark }}</style>
<style>{{ resources.katex_css }}</style>
<style>
.jp-RenderedHTMLCommon table { margin-left: 0 } .jp-OutputArea-output, .jp-MarkdownOutput { overflow-x: auto }
.jp-OutputArea-child { table-layout: fixed } .jp-OutputArea-child .jp-OutputPrompt { width: var(--jp-cell-prompt-width) }
.jp-InputArea-editor, .jp-InputArea-editor .highlight { overflow-x: auto } .jp-RenderedImage img { max-width: 100%; height: auto }
.jp-OutputArea-output .katex-display > .katex { white-space: normal }
@media (max-width: 45rem) { .jp-InputPrompt, .jp-OutputPrompt { display: none } body.jp-Notebook, main { padding: 0 .5rem } }
@media print {
  @page { margin: 12mm } body.jp-Notebook, main { padding: 0 }
  /* lines of a hundred letters fit */
  .highlight pre, .jp-OutputArea-output pre { white-space: pre-wrap; font-size: 8pt; line-height: 1.25; orphans: 3; widows: 3 }
  .jp-InputPrompt, .jp-OutputPrompt { display: none } .jp-RenderedHTMLCommon { font-size: 10pt }
  .jp-RenderedImage, .katex-display, tr { break-inside: avoid } h1, h2, h3 { break-after: avoid }
  .jp-RenderedImage img { max-height: 9cm }
}
</style>
<script>{{ resources.katex_js }}</script>
<script>addEventListener("DOMContentLoaded", () => renderMathInElement(document.body, {delimiters: [
{left: "$$", right: "$$", display: true}, {left: "$", right: "$", display: false},
{left: "\\\\[", right: "\\\\]", display: true}, {left: "\\\\(", right: "\\\\)", display: false}], throwOnError: false}))</script>
{%- endblock -%}
"""


def katex():
    """Its style, fonts within, and its script."""
    css = (KATEX / "katex.min.css").read_text()

    def font(found):
        data = base64.b64encode((KATEX / "fonts" / f"{found[1]}.woff2").read_bytes()).decode()
        return f'src:url(data:font/woff2;base64,{data}) format("woff2")'

    css = re.sub(r"src:url\(fonts/([\w-]+)\.woff2\)[^;}]*", font, css)
    scripts = [(KATEX / name).read_text() for name in ("katex.min.js", "contrib/auto-render.js")]
    return css, "\n".join(scripts).replace("</script", "<\\/script")


def exporter():
    import nbconvert
    from jinja2 import DictLoader
    css, script = katex()
    made = nbconvert.HTMLExporter(template_file="offline.html.j2", extra_loaders=[DictLoader({"offline.html.j2": PAGE})])
    dark = next(Path(folder) / "static/theme-dark.css" for folder in made.template_paths
                if (Path(folder) / "static/theme-dark.css").is_file()).read_text()
    return made, {"katex_css": css, "katex_js": script, "dark": dark}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("notebooks", nargs="+", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("."), help="folder of the pages (without: this one)")
    arguments = parser.parse_args()
    try:
        made, resources = exporter()
    except (ImportError, FileNotFoundError, StopIteration) as error:
        print(f"export.py: {error}; on Debian: apt install python3-nbconvert libjs-katex", file=sys.stderr)
        sys.exit(2)
    arguments.output.mkdir(parents=True, exist_ok=True)
    for path in arguments.notebooks:
        try:
            page, _ = made.from_filename(str(path), resources=dict(resources, metadata={"name": path.stem}))
        except (OSError, json.JSONDecodeError, ValueError) as error:
            print(f"export.py: {path}: {error}; allowed: a notebook (.ipynb)", file=sys.stderr)
            sys.exit(2)
        (arguments.output / f"{path.stem}.html").write_text(page)
        print(arguments.output / f"{path.stem}.html")


if __name__ == "__main__":
    main()
