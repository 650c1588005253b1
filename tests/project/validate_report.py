#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds a report.json to its schema: validate_report.py SCHEMA REPORT...

Exit status 1: a report does not follow the schema (each place is named). 77: there is no jsonschema.
"""
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


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: validate_report.py SCHEMA REPORT...")
    schema = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    Draft7Validator.check_schema(schema)
    # a schema may name those beside it
    for file in Path(sys.argv[1]).parent.glob("*.schema.json"):
        if file.name != Path(sys.argv[1]).name:
            schema.setdefault("definitions", {})[file.name] = json.loads(file.read_text(encoding="utf-8"))
    validator = Draft7Validator(schema)
    wrong = 0
    for file in sys.argv[2:]:
        try:
            report = json.loads(Path(file).read_text(encoding="utf-8"), parse_constant=refuse)
        except ValueError as error:
            print(f"{file}: {error}")
            wrong += 1
            continue
        for error in sorted(validator.iter_errors(report), key=lambda e: list(map(str, e.path))):
            print(f"{file}: {'/'.join(map(str, error.absolute_path)) or 'top level'}: {error.message[:300]}")
            wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
