#!/usr/bin/env bash
# Packages both FMUs with the libraries of all platforms: fmus.sh LIBRARIES FOLDER takes LIBRARIES/PLATFORM/*, as
# libraries.sh leaves them, and writes FOLDER/*.fmu and the page FOLDER/explorer.html, for which Rust needs the target
# wasm32-unknown-unknown.
# Environment: VIDEG, the command-line tool (default: `cargo run --release`).
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 2 ]] || fail "wants the folder of the libraries and one for the FMUs"
libraries=$1
videg=("${VIDEG:-}")
[[ -n ${VIDEG:-} ]] || videg=(cargo run --quiet --release --locked --manifest-path "$root/Cargo.toml" --)

options=()
for folder in "$libraries"/*/; do
    [[ -d $folder ]] || fail "no folder of a platform in $libraries"
    platform=$(basename "$folder")
    for fmu in "${FMUS[@]}"; do
        library=$folder$(library_name "$platform" "$fmu")
        [[ -f $library ]] || fail "$library is missing"
        options+=(--add-binary "$platform=$library")
    done
done
# What lies in LIBRARIES and nothing else is packaged: the library for this machine must be among it.
"${videg[@]}" fmu build --output "$2" "${options[@]}"
"${videg[@]}" explore --no-open --output "$2/explorer.html"
