#!/usr/bin/env bash
# Builds the libraries of both FMUs as they are released: libraries.sh PLATFORM FOLDER puts them into FOLDER/PLATFORM.
#
#   linux64   needs no C library newer than 2.17; needs cargo-zigbuild and zig (release/zig.sh installs them)
#   win64     needs mingw-w64 and the Rust target
#   darwin64  one file for Intel and Apple silicon, since FMI 2.0 has one name for both; on a Mac
#   host      for this Linux machine and its C library, into FOLDER/linux64: to try a release out
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 2 ]] || fail "wants a platform (linux64, win64, darwin64) and a folder"
platform=$1
place=${platform/host/linux64}
mkdir -p "$2/$place"
folder=$(cd "$2/$place" && pwd)
cd "$root"
built=${CARGO_TARGET_DIR:-target}

# build SUBCOMMAND TARGET: Cargo's subcommand, for its name of the target.
build() {
    cargo "$1" --profile dist --locked ${2:+--target "$2"} -p videg-fmu-harvester -p videg-fmu-circuit
}

case $platform in
    linux64)
        build zigbuild x86_64-unknown-linux-gnu.2.17
        parts=(x86_64-unknown-linux-gnu)
        ;;
    win64)
        build build x86_64-pc-windows-gnu
        parts=(x86_64-pc-windows-gnu)
        ;;
    darwin64)
        # The oldest macOS for Intel that Rust supports; for Apple silicon it is 11.0, whatever is asked for.
        export MACOSX_DEPLOYMENT_TARGET=10.12
        parts=(x86_64-apple-darwin aarch64-apple-darwin)
        for part in "${parts[@]}"; do build build "$part"; done
        ;;
    host)
        build build ""
        parts=(.)
        ;;
    *) fail "no way to build for \"$platform\"; there are linux64, win64 and darwin64" ;;
esac
for fmu in "${FMUS[@]}"; do
    name=$(library_name "$place" "$fmu")
    if [[ ${#parts[@]} -eq 1 ]]; then
        cp "$built/${parts[0]}/dist/$name" "$folder/"
    else
        lipo -create -output "$folder/$name" "$built/${parts[0]}/dist/$name" "$built/${parts[1]}/dist/$name"
    fi
    echo "$folder/$name"
done
