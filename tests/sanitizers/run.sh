#!/usr/bin/env bash
# The libraries of both FMUs and a host that calls their C functions at random, compiled by a nightly compiler with a
# sanitizer: AddressSanitizer with its search for leaks on one thread, ThreadSanitizer with instances on eight threads at
# once. Shows then that each would have seen a fault. See docs/fuzzing.md.
#
# Environment: SEQUENCES, random call sequences of each FMU, on each thread (default 2000).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
sequences=${SEQUENCES:-2000}
platform=$(rustc +nightly --print host-tuple)
names=(VibroImpactHarvester HarvestingCircuit)

# What is built for a sanitizer; the standard library is not, so that the compiler must be told to link the two. The libraries
# take the functions of the sanitizer from the host.
build() {
    RUSTFLAGS="-Zsanitizer=$1 -Cunsafe-allow-abi-mismatch=sanitizer -Clink-arg=-Wl,--export-dynamic" \
        cargo +nightly build --quiet --locked \
        --target "$platform" --target-dir "target/sanitizers/$1" -p fmu-host -p videg-fmu-harvester -p videg-fmu-circuit
}

# host SANITIZER FMU SEQUENCES [WORD]
host() {
    local built="target/sanitizers/$1/$platform/debug"
    "$built/fmu-host" "$built/lib$2.so" "modelDescription/${folder:-}$2.xml" 0 "${@:3}"
}

# That a fault on purpose is reported: seen SANITIZER WORD REPORT
seen() {
    local report code=0
    report=$(host "$1" "${names[0]}" 1 "$2" 2>&1) || code=$?
    if [[ $code -eq 0 || $report != *"$3"* ]]; then
        printf '%s\n' "$report" "the $1 sanitizer did not see a deliberate $2 (exit code $code)" >&2
        exit 1
    fi
    echo "a deliberate $2 is seen"
}

export ASAN_OPTIONS=detect_leaks=1 TSAN_OPTIONS=halt_on_error=1
build address
for name in "${names[@]}"; do
    host address "$name" "$sequences"
    folder=fmi3/ host address "$name" "$sequences"
done
echo "no memory errors, no leaks"
seen address leak "LeakSanitizer: detected memory leaks"
seen address overrun "AddressSanitizer: heap-buffer-overflow"

build thread
for name in "${names[@]}"; do
    host thread "$name" "$sequences" threads
done
echo "no data races"
seen thread race "ThreadSanitizer: data race"
