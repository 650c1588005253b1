#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs a finished build to a folder of its own, builds an outside project against it, and runs
# that. Usage: run.sh BUILD_FOLDER
set -euo pipefail

here=$(dirname -- "$(readlink -f -- "$0")")
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }

# the example of the README is this program, letter for letter from its first #include
sed '/^#include/,$!d' "$here/main.cpp" >"$work/example"
awk '/^```cpp$/ { on = 1; next } /^```/ && on { exit } on' "$here/../../../README.md" >"$work/readme"
diff -u "$work/readme" "$work/example" || fail 'README.md shows another program than main.cpp'

cmake --install "$build" --prefix "$work/installed" >"$work/log" || fail "$(<"$work/log")"
# the sources may not help: what the outside project sees is what was installed
export DYNWITNESS_DATA=$work/installed/share/dynwitness
cmake -S "$here" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/installed" \
  -DCMAKE_BUILD_TYPE="$(cached CMAKE_BUILD_TYPE)" -DCMAKE_CXX_FLAGS="$(cached CMAKE_CXX_FLAGS)" \
  -DCMAKE_CXX_COMPILER="$(cached CMAKE_CXX_COMPILER)" >"$work/log" 2>&1 || fail "$(<"$work/log")"
cmake --build "$work/build" >"$work/log" 2>&1 || fail "$(<"$work/log")"
"$work/build/consumer" | tee "$work/out"

# The textbook's double pendulum, here of uniform rods (e.g. Siciliano et al., Robotics, sec. 7.3.2,
# with angles from the vertical). The limit is 64 units in the last place of 10 N m.
awk '{
  m1 = 1; m2 = 0.8; l1 = 0.5; l2 = 0.4; g = 9.81
  q1 = 0.3; q2 = -0.7; qd1 = 1; qd2 = -2; qdd1 = 0.5; qdd2 = 3
  h = m2 * l1 * l2 / 2
  M22 = m2 * l2^2 / 3
  M12 = M22 + h * cos(q2)
  M11 = m1 * l1^2 / 3 + m2 * l1^2 + M22 + 2 * h * cos(q2)
  g2 = m2 * g * l2 / 2 * sin(q1 + q2)
  g1 = (m1 / 2 + m2) * g * l1 * sin(q1) + g2
  tau1 = M11 * qdd1 + M12 * qdd2 - h * sin(q2) * (2 * qd1 * qd2 + qd2^2) + g1
  tau2 = M12 * qdd1 + M22 * qdd2 + h * sin(q2) * qd1^2 + g2
  printf "textbook %.17g %.17g\n", tau1, tau2
  wrong = ($3 - tau1)^2 + ($4 - tau2)^2 > (64 * 1.8e-15)^2
} END { exit wrong || NR != 1 }' "$work/out" || fail 'tau is not that of the textbook'

# the installed program, away from sources and build
(cd "$work" && env -u DYNWITNESS_DATA installed/bin/dynwitness version) || fail 'dynwitness version'
