# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebooks as pages, with the outputs that they keep."""
import html
import json
import re


def _cells(path):
    return json.loads(path.read_text())["cells"]


def titles(folder):
    """[(stem, title)] in order."""
    found = []
    for path in sorted(folder.glob("*.ipynb")):
        first = "".join(_cells(path)[0]["source"])
        found.append((path.stem, re.search(r"^# (.*)$", first, re.M)[1].replace("$", "")))
    return found


def _text(text, rendered):
    """Markdown whose mathematics it does not touch."""
    kept = []

    def keep(found):
        kept.append(html.escape(found[0]))
        return f"MATHS{len(kept) - 1}E"

    page = rendered(re.sub(r"\$\$.*?\$\$|\$[^$\n][^$]*?\$", keep, text, flags=re.S))
    return re.sub(r"MATHS(\d+)E", lambda found: kept[int(found[1])], page)


def _output(output):
    if output["output_type"] == "error":
        return f'<pre class="output unsolved">{html.escape(output["ename"])}: {html.escape(output["evalue"])}</pre>'
    if output["output_type"] == "stream":
        return f'<pre class="output">{html.escape("".join(output["text"]).rstrip())}</pre>'
    data = {kind: "".join(text) for kind, text in output["data"].items()}
    plain = data.get("text/plain", "")
    if "image/png" in data:
        size = output.get("metadata", {}).get("image/png", {}).get("width", 760)
        return (f'<img class="plot" width="{size}" alt="{html.escape(plain.removeprefix("picture: "))}" '
                f'src="data:image/png;base64,{data["image/png"].strip()}">')
    if "text/html" in data:
        return data["text/html"]
    if "text/latex" in data:
        return f"<p>{html.escape(data['text/latex'])}</p>"
    return f'<pre class="output">{html.escape(plain)}</pre>'


def write(site, rendered):
    folder = site.root / "notebooks"
    for stem, title in titles(folder):
        parts = []
        for cell in _cells(folder / f"{stem}.ipynb"):
            text = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                parts.append(_text(site.linked(text, "notebooks/README.md", "../"), rendered))
                continue
            kind = ' class="exercise"' if "exercise" in cell["metadata"].get("tags", []) else ""
            parts.append(f"<pre{kind}><code>{html.escape(text)}</code></pre>" + "".join(map(_output, cell["outputs"])))
        site.page(f"notebooks/{stem}.html", title, "\n".join(parts), maths=True)
