#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the Debian package of a finished build, unpacks it in a folder of its own, and runs what is in
# it, sources and build out of reach. Reads the recipe of the container: there may be no engine for it.
# Usage: test_package.sh BUILD_FOLDER
set -euo pipefail

here=$(dirname -- "$(readlink -f -- "$0")")
build=$(readlink -f -- "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }

for tool in cpack dpkg-deb dpkg-shlibdeps; do
  command -v "$tool" >/dev/null || { echo "skipped: no $tool (Debian: cmake, dpkg-dev)"; exit 77; }
done
cpack --config "$build/CPackConfig.cmake" -B "$work/package" -D CPACK_OUTPUT_FILE_PREFIX="$work/package" >"$work/log" 2>&1 || fail "$(tail -n 40 "$work/log")"
package=$(compgen -G "$work/package/dynwitness_*.deb") || fail "cpack wrote $(ls "$work/package")"
[[ $(wc -w <<<"$package") == 1 ]] || fail "more than one package: $package"
dpkg-deb --info "$package" >"$work/info"
for library in libginac libsimbody; do  # of programs, and of modules
  grep -q "^ Depends: .*$library" "$work/info" || fail "the package does not say what it needs: $(<"$work/info")"
done
dpkg-deb --extract "$package" "$work/root"

# its own data, not that of the sources it was built of
run() { (cd "$work" && env -u DYNWITNESS_DATA "$work/root/usr/bin/dynwitness" "$@"); }
run scenes >"$work/scenes" || fail 'dynwitness scenes'
grep -q double_pendulum "$work/scenes" || fail "no scenes in it: $(<"$work/scenes")"
echo 'title = "x"' >"$work/root/usr/share/dynwitness/scenes/double_pendulum.toml"
! run show double_pendulum >"$work/out" 2>&1 || fail 'the program reads the data of the sources'
grep -q "root/usr/share/dynwitness/scenes/double_pendulum.toml" "$work/out" || fail "$(<"$work/out")"
run crosscheck simple_pendulum --random 5 --no-charts --no-drift -o "$work/report" >"$work/out" 2>&1 ||
  fail "a crosscheck by the packaged program: $(<"$work/out")"
run sweep acrobot >/dev/null || fail 'a command that is in another program'
run version >"$work/out" || fail 'dynwitness version'
grep -q '^witness simbody  *[0-9]' "$work/out" || fail "the module of an engine is not found: $(<"$work/out")"

if command -v python3 >/dev/null; then
  [[ -s $work/root/usr/share/man/man1/dynwitness.1.gz || -s $work/root/usr/share/man/man1/dynwitness.1 ]] || fail 'no man page'
  grep -q "derive" "$work/root/usr/share/bash-completion/completions/dynwitness" || fail 'no completion'
fi

# the recipe: its instructions are such, it takes what the package is called, and starts the program
recipe=$here/../../.ci/Containerfile
while read -r word _; do
  [[ $word =~ ^(FROM|COPY|RUN|WORKDIR|ENTRYPOINT|CMD)$ ]] || fail "Containerfile: $word"
done < <(sed -e '/^#/d' -e '/^$/d' -e '/^ *&&/d' "$recipe")
grep -q '^COPY dynwitness_\*\.deb ' "$recipe" || fail 'Containerfile copies no package'
echo "$(basename "$package"), $(stat -c %s "$package") bytes"
