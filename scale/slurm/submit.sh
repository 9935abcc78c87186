#!/usr/bin/env bash
# Submits a sweep to Slurm: an array of shards, and a job that merges them. See --help.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$here/common.sh"

usage() {
    cat <<'EOF'
Usage: submit.sh --shards N [--output DIR] [--videg FILE] [--only LIST] [--sbatch OPTION]... -- SWEEP...

Submits `videg sweep SWEEP...` as an array of N tasks, and a job that merges their shards into DIR once all have succeeded.
Prints the ids of both jobs. The result is that of one undivided sweep, byte for byte.

  --shards N       number of tasks; each should take minutes
  --output DIR     folder that all nodes see; its shards go to DIR/shards, messages to DIR/log [out/sweep]
  --videg FILE     the command-line tool, at a path that all nodes see [VIDEG, PATH, or target/release]
  --only LIST      submit these tasks again, e.g. 3,7-9: they go on where they ended
  --sbatch OPTION  an option for the array, e.g. --sbatch --time=2:00:00 --sbatch --cpus-per-task=8; may be repeated
  --sbatch-merge OPTION
                   an option for the merge, e.g. --sbatch-merge --account=me; may be repeated

Exit codes: 0 submitted, 2 not.
EOF
}

# That the tasks to be submitted again are tasks of the array.
check_only() {
    local last
    [[ $only =~ ^[0-9]+(-[0-9]+)?(,[0-9]+(-[0-9]+)?)*$ ]] || fail "--only $only: must be a list such as 3,7-9"
    last=$(tr ',-' '\n' <<<"$only" | sort --numeric-sort | tail --lines=1)
    [[ $last -le $shards ]] || fail "--only $only: the last task is $shards"
}

# That what is in the folder was divided in the same way.
check_division() {
    local file before
    for file in "$output"/shards/sweep.*-of-*.csv*; do
        before=${file##*-of-}
        before=${before%%.*}
        [[ ! -e $file || $before == "$shards" ]] || fail "--shards $shards: $output/shards was begun with $before"
    done
}

shards='' output=out/sweep videg='' only='' options=() merge_options=()
while [[ $# -gt 0 && $1 != -- ]]; do
    case $1 in
        -h | --help)
            usage
            exit
            ;;
        --shards | --output | --videg | --only | --sbatch | --sbatch-merge)
            [[ $# -ge 2 ]] || fail "$1: needs a value"
            ;;&
        --shards) shards=$2 ;;
        --output) output=$2 ;;
        --videg) videg=$2 ;;
        --only) only=$2 ;;
        --sbatch) options+=("$2") ;;
        --sbatch-merge) merge_options+=("$2") ;;
        *) fail "$1: no such option; see --help" ;;
    esac
    shift 2
done
[[ ${1:-} == -- ]] || fail "what to sweep is missing; it stands behind --"
shift

[[ $shards =~ ^[1-9][0-9]{0,5}$ ]] || fail "--shards ${shards:-(missing)}: must be a number from 1 to 999999"
[[ -z $only ]] || check_only
[[ " $* " != *" --fresh "* ]] || fail "--fresh: a task that runs again would begin anew; choose another --output"
check_division
videg=$(find_videg "$videg")
command -v sbatch >/dev/null || fail "sbatch is not there: this is no machine that submits to Slurm"
largest=$(scontrol show config | sed -n 's/^MaxArraySize *= *//p') || fail "the controller of Slurm does not answer"
[[ $shards -lt ${largest:-1001} ]] || fail "--shards $shards: must be below the MaxArraySize of this cluster, $largest"

# What videg refuses is found here, not in N log files.
"$videg" sweep "$@" --check >/dev/null || fail "videg refuses this sweep"

mkdir -p "$output/log"
output=$(realpath "$output")
array=$(sbatch --parsable --array="${only:-1-$shards}" --output="$output/log/shard-%a.log" "${options[@]}" \
    "$here/sweep.sbatch" "$videg" "$output" "$shards" "$@") || fail "sbatch refuses the array"
array=${array%%;*}
merge=$(sbatch --parsable --dependency="afterok:$array" --kill-on-invalid-dep=yes --output="$output/log/merge.log" \
    "${merge_options[@]}" "$here/merge.sbatch" "$videg" "$output") || {
    scancel "$array" || true
    fail "sbatch refuses the merge, so the array $array was cancelled"
}
echo "array $array"
echo "merge ${merge%%;*}"
