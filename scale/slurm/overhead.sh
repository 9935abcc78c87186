#!/usr/bin/env bash
# Measures what a task of an array costs on the cluster at hand: N tasks that do nothing, from submission to the end of the last
# (Slurm tells that within a few seconds), and the same with videg started in each. Argument: N [20].
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$here/common.sh"
tasks=${1:-20}
[[ $tasks =~ ^[1-9][0-9]*$ ]] || fail "$tasks: must be a number of tasks"
videg=$(find_videg '')
# Where the nodes see it, too.
folder=$(mktemp -d -p "$PWD")
trap 'rm -rf "$folder"' EXIT

# Milliseconds a task, from submission to the end of the last, which leaves a mark.
measure() {
    local begun ended job
    begun=$(date +%s%N)
    job=$(sbatch --parsable --array="1-$tasks" --output=/dev/null --wrap="$1") || fail "sbatch refuses the array"
    sbatch --quiet --wait --dependency="afterok:$job" --kill-on-invalid-dep=yes --output=/dev/null \
        --wrap="date +%s%N >$(printf %q "$folder/ended")" || fail "a task of job $job failed"
    ended=$(<"$folder/ended")
    echo "$(((ended - begun) / 1000000 / tasks))"
}

# Not within the arguments of a command, whose end would be that of the command.
empty=$(measure true)
echo "empty task: $empty ms"
starting=$(measure "$(printf %q "$videg") --version")
echo "task that starts videg: $starting ms"
