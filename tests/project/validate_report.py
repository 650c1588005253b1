#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds a report.json to its schema: validate_report.py SCHEMA [--lines] REPORT...

With --lines a report is one object a line; lines that do not begin with { are passed over. A schema that takes
a field that it does not know is none: one is planted into every kind of object of each report.

Exit status 1: a report does not follow the schema (each place is named), or a planted field does. 77: there is
no jsonschema.
"""
import copy
import json
import sys
from pathlib import Path

try:
    from jsonschema import Draft7Validator
except ImportError:
    print("validate_report: skipped: no jsonschema for this Python (Debian: apt install python3-jsonschema)")
    sys.exit(77)


def refuse(name):
    raise ValueError(f"{name} is not JSON")


MOST = 3  # items of a list that a field is planted into


def thinned(value):
    """The same with short lists, so that planting takes no time."""
    if isinstance(value, list):
        return [thinned(item) for item in value[:MOST]]
    return {key: thinned(item) for key, item in value.items()} if isinstance(value, dict) else value


def objects(value, path=()):
    """Where objects are: the keys and indices that lead there."""
    if isinstance(value, dict):
        yield path
    for key, item in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from objects(item, (*path, key))


def lax_places(validator, report):
    """Objects that take a field which no schema describes."""
    small = thinned(report)
    before = len(list(validator.iter_errors(small)))
    for path in objects(small):
        planted = copy.deepcopy(small)
        at = planted
        for key in path:
            at = at[key]
        at["planted"] = "by the test"
        if len(list(validator.iter_errors(planted))) <= before:
            yield "/".join(map(str, path)) or "top level"


def reports(file, by_line):
    text = Path(file).read_text(encoding="utf-8")
    parts = [line for line in text.splitlines() if line.startswith("{")] if by_line else [text]
    if not parts:
        raise ValueError("no object in it")
    return [json.loads(part, parse_constant=refuse) for part in parts]


def main():
    by_line = "--lines" in sys.argv
    sys.argv = [word for word in sys.argv if word != "--lines"]
    if len(sys.argv) < 3:
        sys.exit("usage: validate_report.py SCHEMA [--lines] REPORT...")
    schema = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    Draft7Validator.check_schema(schema)
    # a schema may name those of other folders
    for file in Path(sys.argv[1]).resolve().parents[1].glob("*/*.schema.json"):
        if file.name != Path(sys.argv[1]).name:
            schema.setdefault("definitions", {})[file.name] = json.loads(file.read_text(encoding="utf-8"))
    validator = Draft7Validator(schema)
    wrong = 0
    for file in sys.argv[2:]:
        try:
            found = reports(file, by_line)
        except ValueError as error:
            print(f"{file}: {error}")
            wrong += 1
            continue
        for report in found:
            for error in sorted(validator.iter_errors(report), key=lambda e: list(map(str, e.path))):
                print(f"{file}: {'/'.join(map(str, error.absolute_path)) or 'top level'}: {error.message[:300]}")
                wrong += 1
        for report in found[:MOST]:
            for place in lax_places(validator, report):
                print(f"{file}: {place}: a field that the schema does not know is taken")
                wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
