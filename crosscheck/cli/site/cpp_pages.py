# SPDX-License-Identifier: GPL-3.0-or-later
"""The C++ interface as pages: headers of scene/, symbolic/ and recursive/, as Doxygen's XML has them."""
import html
import re
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

FOLDERS = {"scene": "what every witness reads", "symbolic": "T and V, and from them M, c, g",
           "recursive": "spatial algebra, projections, sweeps"}
SETTINGS = """PROJECT_NAME = dynwitness
INPUT = {folders}
RECURSIVE = YES
FILE_PATTERNS = *.hpp
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
JAVADOC_AUTOBRIEF = NO
MARKDOWN_SUPPORT = NO
QUIET = YES
WARNINGS = NO
OUTPUT_DIRECTORY = {out}
"""


def _signature(member):
    text = "".join(member.find("definition").itertext()) if member.find("definition") is not None else ""
    text += member.findtext("argsstring") or ""
    template = member.find("templateparamlist")
    if template is not None:
        words = [" ".join(filter(None, ("".join(p.find("type").itertext()), p.findtext("declname")))) for p in template]
        text = f"template <{', '.join(words)}>\n{text}"
    return re.sub(r"(?<=<) | (?=>)", "", text.replace("dynwitness::", ""))


def _comment(header, line):
    """The comment above a declaration as it stands in the source: equations keep their lines."""
    lines = header.read_text().splitlines()
    at = line - 2
    while at >= 0 and (lines[at].startswith("template") or not lines[at].strip().endswith("*/")):
        if not lines[at].strip() or line - at > 4:
            return _slashes(lines, line)
        at -= 1
    end = at
    while at >= 0 and "/*" not in lines[at]:
        at -= 1
    text = "\n".join(lines[at:end + 1]).strip()
    text = text.removeprefix("/**").removesuffix("*/")
    return "\n".join(row.strip("\n")[4:] if row.startswith("    ") else row.strip() for row in text.split("\n")).strip()


def _slashes(lines, line):
    at, found = line - 2, []
    while at >= 0 and lines[at].strip().startswith(("///", "template")):
        if lines[at].strip().startswith("///"):
            found.insert(0, lines[at].strip()[3:].strip())
        at -= 1
    return "\n".join(found)


def _entries(xml, root):
    """{header: [(line, signature, comment)]}, of functions and types outside `detail`."""
    headers = {}
    for file in sorted(xml.glob("*.xml")):
        if not file.name.startswith(("namespace", "class", "struct")):
            continue
        compound = ElementTree.parse(file).getroot().find("compounddef")
        name = compound.findtext("compoundname")
        if "detail" in name or "@" in name or compound.get("prot") == "private":
            continue
        items = [] if compound.get("kind") == "namespace" else [(compound, f"{compound.get('kind')} {name}")]
        items += [(member, _signature(member)) for member in compound.iter("memberdef")
                  if member.get("kind") in ("function", "typedef", "enum") and member.get("prot") == "public"]
        for item, words in items:
            place = item.find("location")
            if place is None or not place.get("file", "").endswith(".hpp"):
                continue
            header = root / (place.get("declfile") or place.get("file"))  # Doxygen's paths are from where it ran, or absolute
            line = int(place.get("declline") or place.get("line"))
            comment = _comment(header, line)
            if comment:
                if item.get("kind") == "enum":
                    words = f"enum {item.findtext('name')}"
                headers.setdefault(header.relative_to(root), set()).add((line, words.replace("dynwitness::", ""), comment))
    return headers


def write(site):
    """A page a header and an index, or a word that Doxygen is missing."""
    if not shutil.which("doxygen"):
        site.page("cpp/index.html", "C++ interface", "<h1>C++ interface</h1><p>Not built: Doxygen was missing.</p>")
        site.left_out("the C++ interface: doxygen")
        return
    with tempfile.TemporaryDirectory(prefix="dynwitness") as out:
        settings = SETTINGS.format(folders=" ".join(f'"{site.root / folder}"' for folder in FOLDERS), out=out)
        subprocess.run(["doxygen", "-"], input=settings, text=True, check=True, capture_output=True,
                       cwd=site.root)
        headers = _entries(Path(out) / "xml", site.root)
    rows = []
    for header in sorted(headers):
        text = (site.root / header).read_text()
        about = " ".join(line[3:] for line in text.splitlines()[1:6] if line.startswith("// ") and "SPDX" not in line)
        body = "".join(f"<pre class=\"signature\"><code>{html.escape(words)}</code></pre><pre class=\"doc\">{html.escape(comment)}</pre>"
                       for _, words, comment in sorted(headers[header]))
        page = str(header).replace("/", "_") + ".html"
        site.page(f"cpp/{page}", str(header), f"<h1><code>{header}</code></h1><p>{html.escape(about)}</p>{body}")
        rows.append((header.parts[0], f'<tr><td><a href="{page}"><code>{header}</code></a></td><td>{html.escape(about)}</td></tr>'))
    tables = "".join(f"<h2><code>{folder}/</code>: {what}</h2><table>{''.join(row for part, row in rows if part == folder)}</table>"
                     for folder, what in FOLDERS.items())
    site.page("cpp/index.html", "C++ interface", f"<h1>C++ interface</h1><p>Headers as their comments describe them; "
              f'<a href="../from-cpp.html">From C++</a> has a first program.</p>{tables}')
