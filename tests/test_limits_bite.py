#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every limit bites: test_limits_bite.py REPORT...

Reads report.json of crosschecks and holds the ratio of the loosest limit to the largest error that
was seen (one ulp at least), of every check that is counted in ulp: a check says nothing about faults
between the two. Its median over all must stay below 100, and the worst below 10^4. What a witness
documents as its own loss of digits is no limit of ours, and is left out.

Exit status 1: a limit is too wide (each is named), or there was nothing to look at.
"""
import json
import statistics
import sys
from collections import defaultdict
from pathlib import Path

MEDIAN, WORST = 100, 1e4


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: test_limits_bite.py REPORT...")
    ratios = defaultdict(list)  # by quantity
    too_wide = []
    for file in sys.argv[1:]:
        for scene in json.loads(Path(file).read_text(encoding="utf-8"))["scenes"]:
            for check in scene["checks"]:
                ratio = check.get("limit_over_seen")
                if ratio is None or check.get("known_loss"):
                    continue
                ratio = float(ratio)  # "inf" is written as a word
                ratios[check["quantity"] or check["check"]].append(ratio)
                if not ratio < WORST:
                    what = check.get("statement", check["check"])
                    too_wide.append((ratio, f"{scene['name']}: {what}: limit {check['loosest_limit']} ulp, "
                                            f"seen {check['seen']} ulp"))
    everything = [ratio for some in ratios.values() for ratio in some]
    for quantity, some in sorted(ratios.items()):
        print(f"{quantity:40} {len(some):6} checks, limit / seen: median {statistics.median(some):9.3g}, "
              f"worst {max(some):9.3g}")
    if len(everything) < 100:
        sys.exit(f"{len(everything)} checks, expected at least 100")
    median = statistics.median(everything)
    print(f"all: median {median:.3g} (limit {MEDIAN}), worst {max(everything):.3g} (limit {WORST:g})")
    for ratio, text in sorted(too_wide, reverse=True)[:40]:
        print(f"too wide, {ratio:.3g}: {text}")
    sys.exit(bool(too_wide) or not median < MEDIAN)


if __name__ == "__main__":
    main()
