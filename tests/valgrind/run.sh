#!/usr/bin/env bash
# Random calls on the shared libraries of both FMUs under valgrind: memory errors and leaks fail. Shows then that both
# would have been seen, by a host that leaks an instance and one that has an array read beyond its end.
#
# Environment: SEQUENCES, random call sequences of each FMU (default 5000); PROFILE, dev or release (default dev).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
sequences=${SEQUENCES:-5000}
profile=${PROFILE:-dev}
built=${CARGO_TARGET_DIR:-target}/$([[ $profile == dev ]] && echo debug || echo "$profile")

if [[ $profile == dev ]]; then
    # As the stage unit builds them, lest both build them again and again.
    cargo build --quiet --workspace --lib --tests --bin fmu-host
else
    cargo build --quiet --profile "$profile" -p fmu-host -p videg-fmu-harvester -p videg-fmu-circuit
fi

watched() {
    local name=$1
    shift
    local description=modelDescription/${folder:-}$name.xml
    valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,indirect \
        --show-leak-kinds=definite,indirect "$built/fmu-host" "$built/lib$name.so" "$description" "$@"
}

both_standards() {
    watched "$1" 0 "$sequences"
    folder=fmi3/ watched "$1" 0 "$sequences"
}

# Both are waited for, whatever comes of the first.
both_standards HarvestingCircuit &
circuit=$!
both_standards VibroImpactHarvester &
harvester=$!
code=0
wait "$circuit" || code=$?
wait "$harvester" || code=$?
[[ $code -eq 0 ]]
echo "no memory errors, no leaks"

# What was just seen to pass, with one fault.
for fault in leak:"definitely lost" overrun:"Invalid read"; do
    code=0
    report=$(watched VibroImpactHarvester 0 1 "${fault%%:*}" 2>&1) || code=$?
    if [[ $code -ne 99 || $report != *"${fault#*:}"* ]]; then
        printf '%s\n' "$report" "valgrind did not see a deliberate ${fault%%:*} (exit code $code)" >&2
        exit 1
    fi
    echo "a deliberate ${fault%%:*} is seen"
done
