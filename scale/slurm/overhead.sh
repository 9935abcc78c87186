#!/usr/bin/env bash
# Measures what a task of an array costs on the cluster at hand: N tasks that do nothing, from submission to the end of the last
# (Slurm tells that within a few seconds), and the same with videg started in each. Argument: N [20].
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tasks=${1:-20}
[[ $tasks =~ ^[1-9][0-9]*$ ]] || { echo "overhead.sh: $tasks: must be a number of tasks" >&2; exit 2; }
videg=$(realpath "$(command -v videg || echo "$here/../../target/release/videg")")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# Milliseconds a task, from submission to the end of the last, which leaves a mark.
measure() {
    local begun ended job
    begun=$(date +%s%N)
    job=$(sbatch --parsable --array="1-$tasks" --output=/dev/null --wrap="$1")
    sbatch --quiet --wait --dependency="afterok:$job" --output=/dev/null --wrap="date +%s%N >$folder/ended"
    ended=$(<"$folder/ended")
    echo "$(((ended - begun) / 1000000 / tasks))"
}

echo "empty task: $(measure true) ms"
echo "task that starts videg: $(measure "$videg --version") ms"
