#!/bin/bash
# Fuzzes the readers of TOML, URDF, MJCF and of states: tests/fuzz/run.sh FOLDER SECONDS [READER...]
#
# Builds them with clang in FOLDER, and lets each run for SECONDS on the seeds, which are the bundled
# scenes and the files of the tests, and on what earlier runs have found worth keeping
# (FOLDER/corpus). A text that is neither refused in words nor read, that crashes, hangs for 20 s or
# takes 2 GB is kept in FOLDER/found: 1. There is no clang with libFuzzer: 77.
set -u
cd "$(dirname "$0")/../.."
folder=${1:?"a folder for the build"}
seconds=${2:?"seconds for each reader"}
shift 2
readers=${*:-toml urdf mjcf states}

if ! echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' |
    clang++ -fsanitize=fuzzer,address -x c++ - -o /dev/null 2>/dev/null; then
  echo "skipped: no clang++ with libFuzzer (Debian: clang, libclang-rt-dev)"
  exit 77
fi
mkdir -p "$folder/found" || exit
log=$folder/build.log
if ! { cmake --preset check -B "$folder" && cmake --build "$folder" -j "$(nproc)" --target fuzzers; } > "$log" 2>&1; then
  tail -n 40 "$log"
  exit 1
fi

wrong=0
for reader in $readers; do
  corpus=$folder/corpus/$reader seeds=$folder/seeds/$reader
  mkdir -p "$corpus" "$seeds"
  "$folder/fuzz_$reader" --seeds="$seeds" || exit
  if ! "$folder/fuzz_$reader" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=20000 \
      -print_final_stats=1 -artifact_prefix="$folder/found/$reader-" "$corpus" "$seeds" > "$folder/$reader.log" 2>&1; then
    wrong=1
    tail -n 60 "$folder/$reader.log"
    echo "$reader: see $folder/found"
  fi
  echo "$reader: $(grep -o 'number_of_executed_units: *[0-9]*' "$folder/$reader.log" | tr -s ' ') in $seconds s," \
    "$(ls "$corpus" | wc -l) texts worth keeping"
done
exit $wrong
