#!/usr/bin/env bash
# Chooses the inputs of a target that are kept in git: its own, and among what fuzzing found those that cover most, first
# come first kept. See docs/fuzzing.md.
#
# fuzz/keep.sh [TARGET...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PATH="$PWD/target/tools/bin:$PATH"

# Besides those of the target itself; the bounds that the tests hold are 60 files and 200 kB.
readonly MOST_FILES=36
readonly MOST_BYTES=100000

# Whether a file is one that the target makes itself.
is_own() {
    local own
    for own in "$2"/seed-*; do
        ! cmp --quiet "$own" "$1" || return 0
    done
    return 1
}

# Puts the inputs chosen of a target into a folder.
keep() {
    local target=$1 chosen name files=0 bytes=0 size
    local kept=$work/seeds/$target
    chosen=$work/chosen/$target
    mkdir -p "$chosen" "$work/keep/$target" "fuzz/corpus/$target"
    # Greedy: libFuzzer writes the input first that covers most of what no input before it does.
    cargo +nightly fuzz run "$target" -- -set_cover_merge=1 "$chosen" "$kept" "fuzz/corpus/$target" >"$work/log" 2>&1 ||
        { tail -20 "$work/log" >&2 && return 1; }
    while read -r name; do
        size=$(stat --format=%s "$chosen/$name")
        [[ $files -lt $MOST_FILES ]] || break
        [[ $((bytes + size)) -le $MOST_BYTES ]] || continue
        ! is_own "$chosen/$name" "$kept" || continue
        cp "$chosen/$name" "$work/keep/$target/"
        files=$((files + 1)) bytes=$((bytes + size))
    done < <(find "$chosen" -type f -printf '%T@ %f\n' | sort --numeric-sort | cut --delimiter=' ' --fields=2)
    echo "$target: $files files, $bytes B"
}

work=$(mktemp --directory)
trap 'rm -r "$work"' EXIT
python3 -m zipfile --extract fuzz/seeds.zip "$work/seeds"
mapfile -t all < <(cargo +nightly fuzz list)
[[ $# -gt 0 ]] || set -- "${all[@]}"
for target in "$@"; do
    keep "$target"
done
UPDATE_FUZZ_SEEDS=$work/keep cargo test --quiet -p videg-fuzz-targets
