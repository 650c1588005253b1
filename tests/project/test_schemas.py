#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command that writes JSON has a schema, and no object of a schema is open: test_schemas.py PROGRAM

Which commands write JSON is asked of their own help.
"""
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# several kinds of file, or one that another command writes
NAMES = {"crosscheck": ["report", "campaign"], "check": ["check", "answers"]}


def help_of(program, *words):
    return subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True).stdout


def open_objects(schema, path=""):
    """Objects that take whatever there is; a file of definitions alone describes none."""
    if isinstance(schema, dict):
        if schema.get("type") == "object" and "additionalProperties" not in schema and \
                not ("$id" in schema and "properties" not in schema):
            yield path or "top level"
        for key, part in schema.items():
            yield from open_objects(part, f"{path}/{key}")
    elif isinstance(schema, list):
        for k, part in enumerate(schema):
            yield from open_objects(part, f"{path}/{k}")


def main():
    program = sys.argv[1]
    commands = re.findall(r"^  ([a-z]+) +[A-Z]", help_of(program).split("Subcommands:")[1], re.M)
    schemas = {file.name.split(".")[0]: file for file in ROOT.glob("crosscheck/*/*.schema.json")}
    wrong, with_json = [], 0
    for command in commands:
        said = help_of(program, command)
        if not re.search(r"--json\b|--format TEXT:\{[^}]*\bjson\b", said):
            continue
        with_json += 1
        for name in NAMES.get(command, [command]):
            if name not in schemas:
                wrong.append(f"{command} writes JSON, and there is no crosscheck/*/{name}.schema.json")
    for name, file in schemas.items():
        schema = json.loads(file.read_text(encoding="utf-8"))
        wrong += [f"{file.name}: {place} takes fields that it does not describe" for place in open_objects(schema)]
    for sentence in wrong:
        print(sentence)
    print(f"{with_json} commands write JSON, {len(schemas)} schemas")
    return 1 if wrong or with_json < 20 else 0  # 22 when this was written


if __name__ == "__main__":
    sys.exit(main())
