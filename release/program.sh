#!/usr/bin/env bash
# Builds videg as it is released, with FMUs and the page of the explorer inside: program.sh NAME FMUS FOLDER takes FMUS/*.fmu and
# FMUS/explorer.html, and writes FOLDER/videg, or videg.exe.
#
#   linux-x86_64     needs no C library newer than 2.17; needs cargo-zigbuild and zig (release/zig.sh installs them)
#   windows-x86_64   needs no runtime library to be installed; on Windows
#   macos-universal  one file for Intel and Apple silicon; on a Mac
#   host             for this machine and its C library: to try a release out
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 3 ]] || fail "wants a name (linux-x86_64, windows-x86_64, macos-universal), the folder of the FMUs and a folder"
for part in "${FMUS[@]/%/.fmu}" explorer.html; do [[ -f $2/$part ]] || fail "$2/$part is missing"; done
VIDEG_FMUS=$(cd "$2" && pwd)
mkdir -p "$3"
folder=$(cd "$3" && pwd)
cd "$root"
built=${CARGO_TARGET_DIR:-target}

# build SUBCOMMAND TARGET: Cargo's subcommand, for its name of the target.
build() {
    VIDEG_EXPLORER=$VIDEG_FMUS/explorer.html cargo "$1" --profile dist --locked ${2:+--target "$2"} -p videg --bin videg --features embedded-fmus,embedded-explorer
}

case $1 in
    linux-x86_64)
        export VIDEG_FMUS
        build zigbuild x86_64-unknown-linux-gnu.2.17
        cp "$built/x86_64-unknown-linux-gnu/dist/videg" "$folder/"
        ;;
    windows-x86_64)
        # The compiler wants a path of Windows, this shell uses its own.
        VIDEG_FMUS=$(cygpath -m "$VIDEG_FMUS")
        export VIDEG_FMUS RUSTFLAGS="-C target-feature=+crt-static"
        build build x86_64-pc-windows-msvc
        cp "$built/x86_64-pc-windows-msvc/dist/videg.exe" "$folder/"
        ;;
    macos-universal)
        export VIDEG_FMUS MACOSX_DEPLOYMENT_TARGET=10.12
        build build x86_64-apple-darwin
        build build aarch64-apple-darwin
        lipo -create -output "$folder/videg" "$built"/{x86_64,aarch64}-apple-darwin/dist/videg
        ;;
    host)
        export VIDEG_FMUS
        build build ""
        cp "$built/dist/videg" "$folder/"
        ;;
    *) fail "no program is called \"$1\"; there are linux-x86_64, windows-x86_64 and macos-universal" ;;
esac
