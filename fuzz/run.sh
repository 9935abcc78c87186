#!/usr/bin/env bash
# Fuzzes targets and puts down what that came to. See docs/fuzzing.md.
#
# fuzz/run.sh [SECONDS] [TARGET...]
#
# Each target, or those named, for SECONDS (default 3600), from the kept inputs and the working corpus in fuzz/corpus, which
# takes what is new. Ends with 1 if something was found; its input then stands in fuzz/artifacts.
#
# Environment: JOBS, so many targets at once (default 1); RECORD, the file that takes a line for each target (default
# fuzz/record.csv, from which the table of docs/fuzzing.md is made anew).
set -euo pipefail
shopt -s nullglob
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PATH="$PWD/target/tools/bin:$PATH"

readonly KEPT=fuzz/record.csv
# What libFuzzer exits with after an input that took too long.
readonly TIMEOUT=70
record=${RECORD:-$KEPT}
jobs=${JOBS:-1}
seconds=3600
if [[ ${1:-} =~ ^[0-9]+$ ]]; then
    seconds=$1
    shift
fi

# Ends what is still running, and removes what is of this run alone.
finish() {
    local running
    mapfile -t running < <(jobs -rp)
    if [[ ${#running[@]} -gt 0 ]]; then
        kill "${running[@]}" || true
        wait
    fi 2>/dev/null
    rm -rf "$scratch" "$programs"
}

# Small files in memory, where there is such a place: some targets write them.
place=/dev/shm
[[ -d $place && -w $place ]] || place=${TMPDIR:-/tmp}
scratch=$(mktemp --directory --tmpdir="$place" videg-fuzz-XXXXXX)
# Programs on disk: all of them take some 700 MB, and containers often have 64 MB of memory to write to.
mkdir -p fuzz/target
programs=$(mktemp --directory fuzz/target/programs-XXXXXX)
trap finish EXIT
trap 'exit 129' HUP
trap 'exit 130' INT
trap 'exit 143' TERM
export TMPDIR=$scratch/files ASAN_OPTIONS=detect_leaks=1:detect_odr_violation=0

# The programs, where no later build changes them.
build() {
    local started=$SECONDS
    cargo +nightly fuzz build >"$scratch/build" 2>&1 || { cat "$scratch/build" >&2 && exit 2; }
    mkdir -p "$scratch/files"
    for target in "$@"; do
        cp "fuzz/target/$(rustc +nightly --print host-tuple)/release/$target" "$programs/$target"
    done
    echo "built in $((SECONDS - started)) s"
}

# Has a subshell become the program of a target, which ends with the shell that waits for it: a signal would end that one alone.
become() {
    exec setpriv --pdeathsig KILL "$programs/$1" "${@:2}"
}

program() {
    (become "$@")
}

# The last number behind a word in what libFuzzer printed, a file.
last() {
    local found
    found=$(grep --only-matching --extended-regexp "$1 +[0-9]+" "$2" | tail -1)
    echo "${found##* }"
}

# The input that was written last in what libFuzzer printed took long on the wall, where programs wait for a processor. Whether
# it ends within 10 s of the processor, and so is no finding.
is_quick() {
    local input
    input=$(sed --quiet 's/.*Test unit written to //p' "$scratch/$1.log" | tail -1)
    [[ -f $input ]] && (ulimit -t 10 && become "$1" "$input" >"$scratch/$1.again" 2>&1) && rm "$input"
}

# Fuzzes a target until the time is over or something is found, and sets code, real, processor and executions.
run() {
    local target=$1 ended=$((SECONDS + seconds)) folders=("fuzz/corpus/$1") kept count user system TIMEFORMAT='%0R %0U %0S'
    local artifacts=fuzz/artifacts/$target/ log=$scratch/$target.log
    mkdir -p "${folders[0]}" "$artifacts"
    for kept in "$scratch/seeds" fuzz/regressions; do
        [[ ! -d $kept/$target ]] || folders+=("$kept/$target")
    done
    real=0 processor=0 executions=0
    while [[ $SECONDS -lt $ended ]]; do
        code=0
        # What interrupts this script ends the program, too, which must not take that for a finding of its own.
        { time program "$target" "${folders[@]}" -max_total_time="$((ended - SECONDS))" -timeout="$((10 * jobs))" -handle_int=0 \
            -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$artifacts" >"$log" 2>&1 || code=$?; } 2>"$log.time"
        # Behind what the shell says of a program that was killed.
        read -r count user system < <(tail -1 "$log.time")
        real=$((real + count)) processor=$((processor + user + system))
        count=$(last 'stat::number_of_executed_units:' "$log")
        [[ -n $count ]] || return 0 # it did not even run
        executions=$((executions + count))
        [[ $code -eq $TIMEOUT ]] || return 0
        is_quick "$target" || return 0
        code=0
    done
}

# Fuzzes a target and adds its line.
fuzz() {
    local target=$1 code=0 real processor executions log=$scratch/$1.log
    # Until it is known that it did not.
    touch "$scratch/$target.failed"
    run "$target"
    if [[ $code -ne 0 ]]; then
        grep --invert-match '^#[0-9]' "$log" | tail -60 >&2
        [[ $executions -gt 0 ]] || return 0
    else
        rm "$scratch/$target.failed"
    fi
    echo "$(date --utc +%F),$commit,$target,$real,$processor,$executions,$(last cov: "$log"),$(last ft: "$log"),$((code != 0))" |
        tee --append "$record"
}

mapfile -t all < <(cargo +nightly fuzz list)
[[ $# -gt 0 ]] || set -- "${all[@]}"
commit=$(git rev-parse --short=10 HEAD)
build "$@"
python3 -m zipfile --extract fuzz/seeds.zip "$scratch/seeds"
[[ -s $record ]] || echo date,commit,target,seconds,cpu_seconds,executions,edges,features,findings >"$record"
for target in "$@"; do
    [[ $(jobs -rp | wc --lines) -lt $jobs ]] || wait -n || true
    fuzz "$target" &
done
wait
[[ $record != "$KEPT" ]] || UPDATE_FUZZ_TABLE=1 cargo test --quiet -p videg-fuzz-targets --test record
failed=("$scratch"/*.failed)
if [[ ${#failed[@]} -gt 0 ]]; then
    echo "found something: $(basename --suffix=.failed "${failed[@]}" | paste --serial --delimiters=' ')" >&2
    exit 1
fi
