# SPDX-License-Identifier: Apache-2.0
"""Holds your answers to golden vectors of dynwitness: python3 verify.py GOLDEN.csv ANSWERS.csv [FACTOR]

ANSWERS.csv has the line state,quantity,row,column,value and then one such line for each number that your program
gives, counted as in GOLDEN.csv. A quantity that it never gives is not judged. FACTOR multiplies the limits: 536870912
for single precision. Exit status: 0 all within their limits, 1 not, 2 what was read makes no sense."""
import csv
import sys


def main(golden, answers, factor="1"):
    text = open(golden, encoding="utf-8").read().splitlines()
    sentences = dict(line[8:].split(": ", 1) for line in text if line.startswith("# group "))
    wanted = [row for row in csv.DictReader(line for line in text if line[:1] != "#") if row["role"] == "wanted"]
    place = lambda row: ",".join(row[key] for key in ("state", "quantity", "row", "column"))
    said = {place(row): row["value"] for row in csv.DictReader(open(answers, encoding="utf-8"))}
    unknown = sorted(set(said) - set(map(place, wanted)))
    if unknown or not said:
        raise ValueError("%s: %s" % (answers, "not asked for: " + unknown[0] if unknown else "no answers"))
    known = {key.split(",")[1] for key in said}
    judged, wrong = dict.fromkeys(sentences, 0), {group: [] for group in sentences}
    for row in wanted:
        if row["quantity"] in known and row["limit"]:
            judged[row["group"]] += 1
            got = said.get(place(row), "nan")
            if not abs(float(got) - float(row["value"])) <= float(row["limit"]) * float(factor):
                wrong[row["group"]].append("%s: got %s, wanted %s, limit %s" % (place(row), got, row["value"], row["limit"]))
    if not any(judged.values()):
        raise ValueError("nothing that was answered has a limit")
    for group, bad in wrong.items():
        print("%s: %d of %d numbers wrong%s" % (group, len(bad), judged[group], ", the first " + bad[0] if bad else ""))
    for quantity in sorted({row["quantity"] for row in wanted} - known):
        print("not answered: " + quantity)
    failed = [group for group in wrong if wrong[group]]
    print("first to fail: %s: %s" % (failed[0], sentences[failed[0]]) if failed else "all right")
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main(*sys.argv[1:]))
    except (TypeError, ValueError, KeyError, OSError) as problem:
        print(problem, file=sys.stderr)
        sys.exit(2)
