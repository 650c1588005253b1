#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The wrapper script, at work on a small project instead of dynwitness, in a PATH where apt-get and
# sudo are what a test puts there: nothing is installed and no network is needed.
set -euo pipefail

wrapper=$(dirname -- "$(readlink -f -- "$0")")/../../dynwitness
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tools=$work/tools project=$work/project
mkdir -p "$tools" "$project/crosscheck/cli" "$work/elsewhere"

# everything that is on the PATH, less what the tests decide about
IFS=: read -ra folders <<<"$PATH"
for ((i = ${#folders[@]} - 1; i >= 0; --i)); do
  find "${folders[i]}/" -maxdepth 1 ! -type d -exec ln -sft "$tools" {} + 2>/dev/null || true
done
rm -f "$tools"/{apt-get,sudo,gnuplot,ccache,node,npm}
PATH=$tools
# the project is configured afresh here, whatever build this test is part of
unset CXXFLAGS LDFLAGS CMAKE_GENERATOR DESTDIR

fake() {  # NAME, commands on standard input
  { printf '#!%s/bash\n' "$tools" && cat; } >"$work/fake" && chmod +x "$work/fake"
  mv -f "$work/fake" "$tools/$1"
}
fake gnuplot </dev/null

cp "$wrapper" "$project/dynwitness"
cat >"$project/crosscheck/cli/commands.txt" <<'END'
# a comment
exit     dynwitness          Some words
readers  dynwitness-readers  Some words; others
END
cat >"$project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(dynwitness VERSION 1.2.3 LANGUAGES CXX)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
file(GLOB sources CONFIGURE_DEPENDS *.cpp)
add_executable(dynwitness_cli ${sources})
set_target_properties(dynwitness_cli PROPERTIES OUTPUT_NAME dynwitness)
add_executable(dynwitness_benchmarks main.cpp)
add_executable(dynwitness_readers_program EXCLUDE_FROM_ALL main.cpp)
set_target_properties(dynwitness_readers_program PROPERTIES OUTPUT_NAME dynwitness-readers)
target_compile_definitions(dynwitness_readers_program PRIVATE BEFORE_IT="readers: ")
enable_testing()
add_test(NAME passes COMMAND dynwitness_cli exit 0)
END
# prints where it runs and what it was told, and who it is; "exit N" exits with N, another first word with 2
cat >"$project/main.cpp" <<'END'
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
int main(int argc, char** argv) {
#ifdef BEFORE_IT
  std::printf(BEFORE_IT);
#endif
  std::printf("%s", std::filesystem::current_path().c_str());
  for (int i = 1; i < argc; ++i) std::printf("|%s", argv[i]);
  std::printf("\n");
  return argc > 2 && !std::strcmp(argv[1], "exit") ? std::atoi(argv[2]) : argc > 1 ? 2 : 0;
}
END

checks=0 failures=0
call() {  # ARGUMENT...: runs the wrapper (or $as) elsewhere; sets status, leaves files out and err
  status=0
  (cd "$work/elsewhere" && exec "${as:-$project/dynwitness}" "$@") >"$work/out" 2>"$work/err" || status=$?
}
check() {  # SENTENCE, then a command that is true when the sentence is
  local sentence=$1
  shift
  checks=$((checks + 1))
  "$@" && return
  failures=$((failures + 1))
  printf 'FAILED: %s\n  status %s\n' "$sentence" "$status"
  sed 's/^/  stdout: /' "$work/out"
  sed 's/^/  stderr: /' "$work/err"
}
exits() { [[ $status == "$1" ]]; }
prints() { [[ $(<"$work/out") == "$1" ]]; }
is_silent() { [[ ! -s $work/err ]]; }
says() { grep -qF -- "$1" "$work/err"; }
does_not_say() { ! says "$1"; }

# --- help, before anything is built ---
builds_nothing() { [[ ! -e $project/build ]]; }
for words in --help -h help '' 'exit --help' 'bench --help' 'test --help' 'help readers'; do
  # shellcheck disable=SC2086  # the words are several
  call $words
  check "'$words' is answered" exits 0
  check "'$words' builds nothing" builds_nothing
  check "'$words' is told on standard output" grep -q 'Usage: ./dynwitness' "$work/out"
done
call readers --help
check 'help names what the command does' grep -qx 'readers: Some words; others' "$work/out"
call --version
check 'the version is that of the project' prints 'dynwitness 1.2.3'
check 'and builds nothing' builds_nothing
call reader
check 'a word that is no command is refused' exits 2
check 'with what is near' \
  says '"reader" is no command (did you mean readers?), allowed: those that `dynwitness --help` lists'
check 'and no list of all' does_not_say package
check 'and builds nothing' builds_nothing
call --frobnicate
check 'an option that is none is refused' exits 2
call pckage
check 'a letter that is missing is not missed' says '(did you mean package?)'
for words in -x frobnicate; do
  call "$words"
  check "'$words' is like no command" does_not_say 'did you mean'
done

# --- build and run ---
call exit 0 'two words' ''
check 'the first call builds and runs the program' exits 0
check 'the program runs in the folder of the caller, with the arguments as they were' \
  prints "$work/elsewhere|exit|0|two words|"
check 'progress is told' says 'building'

before=$(stat -c %y "$project/build/bin/dynwitness")
call exit 7
check 'the exit status is that of the program' exits 7
check 'a second call has nothing to tell' is_silent
check 'a second call leaves the program as it is' \
  test "$before" = "$(stat -c %y "$project/build/bin/dynwitness")"

call pckage
check 'a word that is no command is refused when the program is there, too' exits 2
check 'with the words that the wrapper alone knows' says '(did you mean package?)'
call --nonsense
check 'an option that is none goes to the program that is there' prints "$work/elsewhere|--nonsense"

ln -s "$project/dynwitness" "$work/link"
as=$work/link call exit 5
check 'the wrapper works through a symbolic link' exits 5

call
check 'a call without arguments goes to the program' prints "$work/elsewhere"
call exit --help
check 'help comes from the program that is there' prints "$work/elsewhere|exit|--help"

# --- beside another build ---
exec 8>"$project/build/.lock"
flock 8
call exit 6
check 'a program that is there does not wait for another build' exits 6
check 'and says so' says 'another build is under way: dynwitness runs as it stands'
flock -u 8
exec 8>&-

# --- commands in programs of their own ---
rm "$project/build/bin/dynwitness"
call readers file
check 'a command goes to the program that has it' prints "readers: $work/elsewhere|readers|file"
check 'no other program is built for it' test ! -e "$project/build/bin/dynwitness"
call '#' a
check 'a comment of the list is no command' exits 2
call exit 0
mv "$project/crosscheck/cli/commands.txt" "$work/commands.txt"
call exit 0
check 'without the list the wrapper fails' exits 3
check 'and says what it misses' says 'crosscheck/cli/commands.txt cannot be read'
mv "$work/commands.txt" "$project/crosscheck/cli/commands.txt"

# --- test and bench ---
call test
check 'test runs ctest' grep -q '100% tests passed' "$work/out"
check 'test exits with the status of ctest' exits 0
call test -R no_such_test
check 'options of test go to ctest, and running no test is a failure' test "$status" -ne 0
call bench exit 4
check 'bench runs the benchmarks with the arguments that follow' \
  prints "$work/elsewhere|exit|4"

# --- MuJoCo of today, by npm ---
call readers
check 'readers goes to the program without npm' prints "readers: $work/elsewhere|readers"
check 'and what is missing is said' says 'no node or no npm (Debian: nodejs npm)'
fake node </dev/null
fake npm <<<'echo "npm error: no network" >&2; exit 1'
call readers
check 'a package that cannot be had is left out' prints "readers: $work/elsewhere|readers"
check 'with what npm says' says 'npm does not give mujoco-js@0.0.7: npm error: no network'
fake npm <<<'echo something >mujoco-js-0.0.7.tgz'
call readers
check 'a package that is not the pinned one is not used' test ! -e "$project/build/engines"
check 'and that is said' says 'is not what is pinned here'
check 'nothing of it is left' test -z "$(compgen -G "$project/build/mujoco-js*")"
rm "$tools"/{node,npm}

# --- failures of the build ---
cp "$project/main.cpp" "$work/main.cpp"
echo 'this is no C++' >>"$project/main.cpp"
call exit 0
check 'a build that fails gives exit status 3' exits 3
check 'the compiler is quoted' says 'main.cpp:14'
check 'the log is named' says "$project/build/build.log"
check 'the old program does not run instead' prints ''
cp "$work/main.cpp" "$project/main.cpp"
call exit 0
check 'the next call builds again' exits 0

# --- packages ---
rm "$tools/gnuplot"
call exit 0
check 'without apt, a missing package gives exit status 2' exits 2
check 'it is named with its purpose' says 'gnuplot-nox: charts'
check 'what is there is not named' does_not_say 'cmake'
check 'nothing runs' prints ''

fake id <<<'echo 1000'
fake apt-get <<<'echo "apt-get must not run" >&2'
call exit 0
check 'with apt but neither root nor sudo the list is the answer' exits 2
check 'the command to type is given' \
  says 'apt-get install --no-install-recommends gnuplot-nox'
check 'apt-get does not run' does_not_say 'must not run'

fake id <<<'echo 0'
call --no-install exit 0
check 'with --no-install the list is the answer' exits 2
check 'and apt-get does not run' does_not_say 'must not run'
DYNWITNESS_NO_INSTALL=1 call exit 0
check 'the same by a variable' exits 2
fake id <<<'echo 1000'

fake sudo <<'END'
echo "$*" >>"$0.calls"
exec "$@"
END
fake apt-get <<'END'
echo "$DEBIAN_FRONTEND $*" >>"$0.calls"
if [[ $* == *gnuplot-nox* ]]; then printf '#!/bin/sh\n' >"${0%/*}/gnuplot" && chmod +x "${0%/*}/gnuplot"; fi
END
call exit 0
check 'with sudo the missing package is installed and the program runs' exits 0
check 'sudo is used' test -s "$tools/sudo.calls"
check 'package lists are fetched first' \
  grep -qE '^noninteractive .*update' "$tools/apt-get.calls"
check 'only what is missing is installed, without recommendations, without questions' \
  grep -qE '^noninteractive .*install -y --no-install-recommends gnuplot-nox$' "$tools/apt-get.calls"
check 'the build is configured again' says 'configuring'

rm "$tools"/{gnuplot,id,sudo}
fake id <<<'echo 0'
fake apt-get <<<'echo "E: no network"; exit 100'
call exit 0
check 'an installation that fails gives exit status 2' exits 2
check 'the end of what apt-get said is quoted' says 'E: no network'
rm "$tools/apt-get"
fake gnuplot </dev/null

# --- two at a time, and a checkout that moved ---
rm -rf "$project/build"
(cd / && "$project/dynwitness" exit 0 >/dev/null 2>&1; echo $? >"$work/first") &
call exit 0
wait
check 'two calls at a time build once each in turn' test "$status$(<"$work/first")" = 00

mv "$project" "$work/moved"
as=$work/moved/dynwitness call exit 0
check 'a checkout that was moved is configured again' exits 0

# --- for the reader: no limit, since machines differ ---
start=$EPOCHREALTIME
as=$work/moved/dynwitness call exit 0
end=$EPOCHREALTIME
printf 'a call with nothing to build: %d ms\n' "$(((${end/[.,]/} - ${start/[.,]/}) / 1000))"

printf '%d checks, %d failures\n' "$checks" "$failures"
((failures == 0))
