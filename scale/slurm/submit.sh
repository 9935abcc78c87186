#!/usr/bin/env bash
# Submits a sweep to Slurm: an array of shards, and a job that merges them. See --help.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

usage() {
    cat <<'EOF'
Usage: submit.sh --shards N [--output DIR] [--videg FILE] [--only LIST] [--sbatch OPTION]... -- SWEEP...

Submits `videg sweep SWEEP...` as an array of N tasks, and a job that merges their shards into DIR once all have succeeded.
Prints the ids of both jobs. The result is that of one undivided sweep, byte for byte.

  --shards N       number of tasks; each should take minutes
  --output DIR     folder that all nodes see; its shards go to DIR/shards, messages to DIR/log [out/sweep]
  --videg FILE     the command-line tool, at a path that all nodes see [PATH, or target/release]
  --only LIST      submit these tasks again, e.g. 3,7-9: they go on where they ended
  --sbatch OPTION  an option for the array, e.g. --sbatch --time=2:00:00 --sbatch --cpus-per-task=8; may be repeated

Exit codes: 0 submitted, 2 not.
EOF
}

fail() {
    echo "submit.sh: $*" >&2
    exit 2
}

shards='' output=out/sweep videg='' only='' options=()
while [[ $# -gt 0 && $1 != -- ]]; do
    case $1 in
        -h | --help)
            usage
            exit
            ;;
        --shards | --output | --videg | --only | --sbatch)
            [[ $# -ge 2 ]] || fail "$1: needs a value"
            ;;&
        --shards) shards=$2 ;;
        --output) output=$2 ;;
        --videg) videg=$2 ;;
        --only) only=$2 ;;
        --sbatch) options+=("$2") ;;
        *) fail "$1: no such option; see --help" ;;
    esac
    shift 2
done
[[ ${1:-} == -- ]] || fail "what to sweep is missing; it stands behind --"
shift

[[ $shards =~ ^[1-9][0-9]{0,5}$ ]] || fail "--shards ${shards:-(missing)}: must be a number from 1 to 999999"
videg=${videg:-$(command -v videg || echo "$here/../../target/release/videg")}
videg=$(command -v "$videg") || fail "videg is neither on the PATH nor in target/release; --videg FILE says where it is"
videg=$(realpath "$videg")
command -v sbatch >/dev/null || fail "sbatch is not there: this is no machine that submits to Slurm"
largest=$(scontrol show config | sed -n 's/^MaxArraySize *= *//p') || fail "the controller of Slurm does not answer"
[[ $shards -lt ${largest:-1001} ]] || fail "--shards $shards: must be below the MaxArraySize of this cluster, $largest"

# What videg refuses is found here, not in N log files: the first of a million shards has no run.
trial=$(mktemp -d)
trap 'rm -rf "$trial"' EXIT
"$videg" sweep "$@" --shard 1/1000000 --output "$trial" >/dev/null || fail "videg refuses this sweep"

mkdir -p "$output/log"
output=$(realpath "$output")
array=$(sbatch --parsable --array="${only:-1-$shards}" --output="$output/log/shard-%a.log" "${options[@]}" \
    "$here/sweep.sbatch" "$videg" "$output" "$shards" "$@") || fail "sbatch refuses the array"
array=${array%%;*}
merge=$(sbatch --parsable --dependency="afterok:$array" --kill-on-invalid-dep=yes --output="$output/log/merge.log" \
    "$here/merge.sbatch" "$videg" "$output") || fail "sbatch refuses the merge of job $array"
echo "array $array"
echo "merge ${merge%%;*}"
