#!/usr/bin/env bash
# Fuzzes targets one after the other and puts down what that came to. See docs/fuzzing.md.
#
# fuzz/run.sh [SECONDS] [TARGET...]
#
# Each target, or those named, for SECONDS (default 3600), from the kept inputs and the working corpus in fuzz/corpus, which
# takes what is new. Ends with 1 if something was found; its input then stands in fuzz/artifacts.
#
# Environment: RECORD, the file that takes a line for each target (default fuzz/record.csv, from which the table of
# docs/fuzzing.md is made anew).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PATH="$PWD/target/tools/bin:$PATH"

readonly KEPT=fuzz/record.csv
record=${RECORD:-$KEPT}
seconds=3600
if [[ ${1:-} =~ ^[0-9]+$ ]]; then
    seconds=$1
    shift
fi

# In memory, where there is such a place: some targets write files.
place=/dev/shm
[[ -d $place && -w $place ]] || place=${TMPDIR:-/tmp}
scratch=$(mktemp --directory --tmpdir="$place" videg-fuzz-XXXXXX)
trap 'rm -rf "$scratch"' EXIT
export TMPDIR=$scratch/files ASAN_OPTIONS=detect_leaks=1:detect_odr_violation=0

# The programs, where no later build changes them.
build() {
    local started=$SECONDS
    cargo +nightly fuzz build >"$scratch/build" 2>&1 || { cat "$scratch/build" >&2 && exit 2; }
    mkdir -p "$scratch/files"
    for target in "$@"; do
        cp "fuzz/target/$(rustc +nightly --print host-tuple)/release/$target" "$scratch/$target"
    done
    echo "built in $((SECONDS - started)) s"
}

# The last number behind a word in what libFuzzer printed.
last() {
    local found
    found=$(grep --only-matching --extended-regexp "$1 +[0-9]+" "$scratch/log" | tail -1)
    echo "${found##* }"
}

# Runs a target and adds its line; fails if it found something.
fuzz() {
    local target=$1 code=0 real user system executions TIMEFORMAT='%0R %0U %0S'
    local folders=("fuzz/corpus/$target") artifacts=fuzz/artifacts/$target/
    mkdir -p "${folders[0]}" "$artifacts"
    for kind in seeds regressions; do
        [[ ! -d fuzz/$kind/$target ]] || folders+=("fuzz/$kind/$target")
    done
    { time "$scratch/$target" "${folders[@]}" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 \
        -print_final_stats=1 -artifact_prefix="$artifacts" >"$scratch/log" 2>&1 || code=$?; } 2>"$scratch/time"
    read -r real user system <"$scratch/time"
    executions=$(last 'stat::number_of_executed_units:')
    if [[ $code -ne 0 ]]; then
        grep --invert-match '^#[0-9]' "$scratch/log" | tail -60 >&2
        [[ -n $executions ]] || exit 2 # it did not even run
    fi
    echo "$(date --utc +%F),$commit,$target,$real,$((user + system)),$executions,$(last cov:),$(last ft:),$((code != 0))" |
        tee --append "$record"
    return "$((code != 0))"
}

mapfile -t all < <(cargo +nightly fuzz list)
[[ $# -gt 0 ]] || set -- "${all[@]}"
commit=$(git rev-parse --short=10 HEAD)
build "$@"
[[ -s $record ]] || echo date,commit,target,seconds,cpu_seconds,executions,edges,features,findings >"$record"
failed=()
for target in "$@"; do
    fuzz "$target" || failed+=("$target")
done
[[ $record != "$KEPT" ]] || UPDATE_FUZZ_TABLE=1 cargo test --quiet -p videg-fuzz-targets --test record
if [[ ${#failed[@]} -gt 0 ]]; then
    echo "found something: ${failed[*]}" >&2
    exit 1
fi
