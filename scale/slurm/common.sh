# shellcheck shell=bash
# What the scripts of this folder share; they source it.

fail() {
    echo "${0##*/}: $*" >&2
    exit 2
}

# The path of videg: as given, or the environment's VIDEG, or that of the PATH, or that of the source tree.
find_videg() {
    local wanted=${1:-${VIDEG:-}} root built found
    root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
    built=${CARGO_TARGET_DIR:-$root/target}/release/videg
    found=$(command -v "${wanted:-videg}" || { [[ -z $wanted ]] && command -v "$built"; }) ||
        fail "${wanted:-videg} is neither a program nor on the PATH; cargo build --release makes $built"
    realpath "$found"
}
