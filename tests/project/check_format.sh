#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Layout is what clang-format 14 makes of it, and no comment is longer than its 100 columns (strings
# and tables may be). Status 1: a file differs, each is named. 77: there is no clang-format 14.
set -euo pipefail
cd "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/../.."

formatter=
for name in clang-format-14 clang-format; do
  if [[ $($name --version 2>/dev/null) == *'version 14.'* ]]; then formatter=$name && break; fi
done
if [[ -z $formatter ]]; then
  echo 'check_format: skipped: no clang-format 14 (Debian 12: apt install clang-format)'
  exit 77
fi

mapfile -d '' files < <(find scene symbolic recursive crosscheck tests -name '*.[ch]pp' -print0 | sort -z)
((${#files[@]} > 300)) || { echo "check_format: ${#files[@]} files, expected more than 300"; exit 1; }
status=0
# one process for all: 400 starts would take longer than the work
differing=$({ "$formatter" --dry-run -Werror --ferror-limit=1 "${files[@]}" 2>&1 || true; } |
  sed -n 's/^\([^:]*\):.*Wclang-format-violations.*/\1/p' | sort -u || true)
if [[ -n $differing ]]; then
  printf 'not as %s has it: %s\n' "$formatter" $differing
  status=1
fi
long=$(awk 'FNR == 1 {inside = 0} /^ *\/\*/ {inside = 1}
  length > 100 && (inside || /^ *\/\//) {print FILENAME ":" FNR ": " length " columns, 100 allowed"}
  /\*\// {inside = 0}' "${files[@]}")
if [[ -n $long ]]; then
  echo "$long"
  status=1
fi
exit $status
