#!/usr/bin/env bash
# Packs the wheel for Python: wheel.sh NAME PROGRAM FMUS NOTICES FOLDER writes FOLDER/videg-VERSION-*.whl. PROGRAM is videg with the
# FMUs inside, FMUS the folder of the same FMUs as files, NOTICES the licences of what the program contains, as notices.py writes
# them; what the extension module contains is among it. Only that module is built here, for the systems of program.sh:
#
#   linux-x86_64     manylinux2014: no C library newer than 2.17; needs zig (release/zig.sh installs it)
#   windows-x86_64   on Windows
#   macos-universal  one file for Intel and Apple silicon; on a Mac
#   host             for this machine and its C library: to try a release out
#   source           the source distribution in place of a wheel; PROGRAM, FMUS and NOTICES are not looked at
#
# Installs maturin below target/tools, unless it is there.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 5 ]] || fail "wants a name, the program, the folder of the FMUs, the notices and a folder"
maturin_version=1.16.0
name=$1
program=$(realpath -m "$2") archives=$(realpath -m "$3") notices=$(realpath -m "$4")
mkdir -p "$5"
folder=$(cd "$5" && pwd)
cd "$root"

tools=${CARGO_TARGET_DIR:-target}/tools/maturin
python=$tools/bin/python
if [[ $name == windows-* ]]; then
    python=$tools/Scripts/python.exe
fi
[[ -x $python ]] || python3 -m venv "$tools" 2>/dev/null || python -m venv "$tools"
"$python" -m pip install --quiet --disable-pip-version-check "maturin==$maturin_version"

if [[ $name == source ]]; then
    "$tools/bin/maturin" sdist --out "$folder"
    ls "$folder"/videg-*.tar.gz
    exit
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$program" "$work/"
for fmu in "${FMUS[@]}"; do cp "$archives/$fmu.fmu" "$work/"; done
cp "$notices" "$work/THIRD-PARTY.md"
# From outside of the source tree it takes the FMUs inside.
"$work/$(basename "$program")" ssp --output "$work" >/dev/null
case $name in
    linux-x86_64) arguments="--zig --target x86_64-unknown-linux-gnu --compatibility manylinux2014" ;;
    windows-x86_64) arguments="--target x86_64-pc-windows-msvc" && export RUSTFLAGS="-C target-feature=+crt-static" ;;
    macos-universal) arguments="--target universal2-apple-darwin" && export MACOSX_DEPLOYMENT_TARGET=10.12 ;;
    host) arguments="" ;;
    *) fail "no wheel is called \"$name\"; there are linux-x86_64, windows-x86_64 and macos-universal" ;;
esac
if [[ $name == windows-* ]]; then
    # Python wants a path of Windows.
    work=$(cygpath -m "$work")
fi
# Behind the others, of which one may have zig.
PATH="$PATH:$(dirname "$python")" VIDEG_PROFILE=dist VIDEG_PARTS=$work "$python" -m pip wheel --quiet --disable-pip-version-check \
    --no-build-isolation --no-deps --config-settings "build-args=$arguments" --wheel-dir "$folder" "$root"
ls "$folder"/videg-*.whl
