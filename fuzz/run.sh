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

scratch=$(mktemp --directory)
trap 'rm -rf "$scratch"' EXIT
# Files of the targets themselves: in memory, where there is such a place.
if [[ -d /dev/shm && -w /dev/shm ]]; then
    TMPDIR=$(mktemp --directory --tmpdir=/dev/shm videg-fuzz-XXXXXX)
    export TMPDIR
    trap 'rm -rf "$scratch" "$TMPDIR"' EXIT
fi

# The last number behind a word in what libFuzzer printed.
last() {
    local found
    found=$(grep --only-matching --extended-regexp "$1 [0-9]+" "$scratch/log" | tail -1)
    echo "${found##* }"
}

# Runs a target; 1 if it found something.
fuzz() {
    local target=$1 code=0 cpu folders=("fuzz/corpus/$1")
    mkdir -p "fuzz/corpus/$target"
    for kind in seeds regressions; do
        [[ ! -d fuzz/$kind/$target ]] || folders+=("fuzz/$kind/$target")
    done
    echo "--- $target: $seconds s"
    local TIMEFORMAT='%R %U %S' real
    { time cargo +nightly fuzz run "$target" "${folders[@]}" -- -max_total_time="$seconds" -timeout=10 \
        -rss_limit_mb=2048 -print_final_stats=1 >"$scratch/log" 2>&1 || code=$?; } 2>"$scratch/time"
    real=$(awk '{ printf "%.0f", $1 }' "$scratch/time")
    cpu=$(awk '{ printf "%.0f", $2 + $3 }' "$scratch/time")
    local executions
    executions=$(last 'stat::number_of_executed_units:')
    if [[ -z $executions ]]; then
        tail -30 "$scratch/log" >&2
        echo "$target did not run" >&2
        exit 2
    fi
    echo "$(date --utc +%F),$(git rev-parse --short=10 HEAD),$target,$real,$cpu,$executions,$(last 'cov:'),$(last 'ft:'),$((code != 0))" >>"$record"
    tail -1 "$record"
    if [[ $code -ne 0 ]]; then
        grep --invert-match '^#' "$scratch/log" | tail -60 >&2
        return 1
    fi
}

mapfile -t all < <(cargo +nightly fuzz list)
[[ $# -gt 0 ]] || set -- "${all[@]}"
echo "building"
started=$SECONDS
cargo +nightly fuzz build >"$scratch/build" 2>&1 || { cat "$scratch/build" >&2 && exit 2; }
echo "built in $((SECONDS - started)) s"
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
