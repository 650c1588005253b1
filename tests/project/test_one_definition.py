#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A name of a type means one type: test_one_definition.py FOLDER

Two types of one name in one namespace, in two files, are undefined behaviour that no compiler tells: the linker keeps
one of the two constructors, and whoever calls the other writes over memory of his neighbour. (It happened.) Reads
every source below FOLDER and lists the types that namespaces hold, those without a name left out, which are a file's
own. Exit status 1: one name stands for two, or there was nothing to look at.
"""
import re
import sys
from collections import defaultdict
from pathlib import Path

STREETS = ("scene", "symbolic", "recursive", "crosscheck", "tests")
TOKEN = re.compile(r"""//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'
                       |\#(?:\\\n|[^\n])*|[{};]|template\s*<|[<>()]|[\w:]+|\S""", re.S | re.X)


def types(text):
    """(namespace, name) of each type that is defined in a namespace with a name."""
    stack, statement = [], []  # of scopes: a namespace's name, or None for all that is no namespace
    for match in TOKEN.finditer(text):
        token = match.group()
        if token.startswith(("//", "/*", "#", '"', "'", 'R"')):
            continue
        if token == "{":
            scope = None
            if statement and statement[0] == "namespace":
                scope = statement[1] if len(statement) > 1 else ""
            elif None not in stack and "" not in stack and "(" not in statement and "=" not in statement:
                words = [word for word in statement if word not in ("final", "enum")]
                for kind in ("struct", "class", "union"):
                    if kind in words[:-1]:
                        after = words[words.index(kind) + 1:]
                        if "<" not in after[1:2]:  # a specialisation is told apart by its arguments
                            yield "::".join(stack), after[0]
                        break
                else:
                    if "enum" in statement and words:
                        yield "::".join(stack), words[0]
            stack.append(scope)
            statement = []
        elif token == "}":
            if stack:
                stack.pop()
            statement = []
        elif token == ";":
            statement = []
        elif token.startswith("template"):
            statement.append("template")
            statement.append("<")
        else:
            statement.append(token)
            if token == ">" and statement[0] == "template" and statement.count("<") == statement.count(">"):
                statement = []  # its parameters say "class" and "=" too


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: test_one_definition.py FOLDER")
    folder = Path(sys.argv[1])
    found = defaultdict(set)
    for street in STREETS:
        for file in sorted((folder / street).rglob("*.[ch]pp")):
            place = str(file.relative_to(folder))
            # a test is a program of its own: what it defines meets no other test's
            program = place if street == "tests" and file.suffix == ".cpp" else ""
            for namespace, name in types(file.read_text(encoding="utf-8")):
                found[(program, namespace, name)].add(place)
    if len(found) < 300:
        sys.exit(f"{len(found)} types, expected at least 300")
    twice = {key: files for key, files in found.items() if len(files) > 1}
    for (_, namespace, name), files in sorted(twice.items()):
        print(f"{namespace}::{name} is defined in {', '.join(sorted(files))}")
    print(f"{len(found)} types")
    sys.exit(bool(twice))


if __name__ == "__main__":
    main()
