#!/usr/bin/env bash
# Random calls on the shared libraries of both FMUs under valgrind: memory errors and leaks fail. Shows first that both
# would be seen, by a host that leaks an instance and one that has an array read beyond its end.
#
# Environment: SEQUENCES, random call sequences of each FMU (default 1000); PROFILE, dev or release (default dev).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
sequences=${SEQUENCES:-1000}
profile=${PROFILE:-dev}
built=${CARGO_TARGET_DIR:-target}/$([[ $profile == dev ]] && echo debug || echo "$profile")

cargo build --quiet --profile "$profile" -p fmi2-host -p videg-fmu-harvester -p videg-fmu-circuit

# The seed that comes first is that of the first sequence.
watched() {
    local name=$1
    shift
    valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,indirect \
        --show-leak-kinds=definite,indirect "$built/fmi2-host" "$built/lib$name.so" "modelDescription/$name.xml" "$@"
}

for fault in leak overrun; do
    code=0
    watched VibroImpactHarvester 0 1 "$fault" >/dev/null 2>&1 || code=$?
    if [[ $code -ne 99 ]]; then
        echo "valgrind did not see a deliberate $fault (exit code $code)" >&2
        exit 1
    fi
    echo "a deliberate $fault is seen"
done
for name in VibroImpactHarvester HarvestingCircuit; do
    watched "$name" 0 "$sequences"
done
echo "no memory errors, no leaks"
