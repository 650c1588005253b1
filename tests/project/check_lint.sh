#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# clang-tidy with the checks of .clang-tidy, in files and our headers that they include. All of
# scene/ is read as it is built, several files together: a header that thirty files include is read
# four times then. (An include that is missing is found by the preset check, file by file.)
#
#   check_lint.sh BUILD [FILE...]   the files named; none: scene/ and all headers of recursive/
#
# Status 1: something was found. 77: there is no clang-tidy 14.
set -euo pipefail
build=$(readlink -f -- "$1")
shift
cd "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/../.."

linter=
for name in clang-tidy-14 clang-tidy; do
  if [[ $($name --version 2>/dev/null) == *'version 14.'* ]]; then linter=$name && break; fi
done
compiler=$(type -P clang++-14 || type -P clang++ || true)
if [[ -z $linter || -z $compiler ]]; then
  echo 'check_lint: skipped: no clang-tidy 14 with its clang++ (Debian 12: apt install clang-tidy clang)'
  exit 77
fi

# how a file is compiled, as clang++ is told
CXXFLAGS='' cmake --fresh -S . -B "$build/lint" -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER="$compiler" \
  -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON -D DYNWITNESS_TOGETHER=$( (($#)) && echo OFF || echo ON) >"$build/lint.log" 2>&1 || { tail -n 20 "$build/lint.log"; exit 1; }
status=0
# (files read together are includes with the ending .cpp)
lint() { printf '%s\0' "$@" | xargs -0 -n 1 -P "$(nproc)" "$linter" --quiet -p "$build/lint" \
  --warnings-as-errors='*' --checks=-bugprone-suspicious-include 2>/dev/null || status=1; }
if (($#)); then
  lint "$@"
else
  together=("$build"/lint/CMakeFiles/dynwitness_scene.dir/Unity/*.cxx)
  mapfile -t alone < <(printf '%s\n' scene/*.cpp | grep -vFf <(grep -oh 'scene/[^/"]*\.cpp' "${together[@]}"))
  lint "${together[@]}" "${alone[@]}"
  # templates: read, and used nowhere
  everything=$build/lint/recursive.cpp
  printf '#include "%s"\n' recursive/*.hpp recursive/fast/*.hpp >"$everything"
  "$linter" --quiet --warnings-as-errors='*' "$everything" -- -std=c++17 -I"$PWD" \
    $(pkg-config --cflags eigen3) 2>/dev/null || status=1
fi
exit $status
