#!/usr/bin/env bash
# A release made on this machine, as far as that goes: libraries for Linux and Windows, one that stands in for macOS, merged into
# FMUs, checked, put inside the program, packed, summed up, and run without source tree and Cargo. Installs what is missing to
# build for Windows (mingw-w64, the Rust target).
#
# Environment: OLD_GLIBC=1 builds for Linux as released, which takes zig and a second build of everything.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
built=$(realpath -m "${CARGO_TARGET_DIR:-target}")
work=$built/release-test
rm -rf "$work"
mkdir -p "$work/libraries"
version=$(release/version.sh)

echo "libraries"
if ! command -v x86_64-w64-mingw32-gcc >/dev/null; then
    as_root=()
    [[ $(id -u) -eq 0 ]] || as_root=(sudo)
    "${as_root[@]}" apt-get install --quiet=2 --yes --no-install-recommends gcc-mingw-w64-x86-64 >/dev/null
fi
[[ -d $(rustc --print sysroot)/lib/rustlib/x86_64-pc-windows-gnu/lib ]] || rustup target add x86_64-pc-windows-gnu
release/libraries.sh win64 "$work/libraries"
program=host
if [[ -n ${OLD_GLIBC:-} ]]; then
    PATH="$(release/zig.sh):$PATH"
    program=linux-x86_64
    release/libraries.sh linux64 "$work/libraries"
else
    release/libraries.sh host "$work/libraries"
fi
mkdir "$work/libraries/darwin64"
for fmu in VibroImpactHarvester HarvestingCircuit; do
    python3 tests/release/fake_macho.py "$work/libraries/darwin64/lib$fmu.dylib"
done

echo "FMUs for all platforms"
cargo build --quiet --release --locked --bin videg
export VIDEG=$built/release/videg
release/fmus.sh "$work/libraries" "$work/fmu"
release/check-fmus.sh "$work/fmu" linux64 win64 darwin64
if release/check-fmus.sh "$work/fmu" linux64 win64 2>"$work/refused"; then
    echo "an FMU with a library too many was not refused" >&2
    exit 1
fi
rm "$work/libraries/win64/HarvestingCircuit.dll"
if release/fmus.sh "$work/libraries" "$work/incomplete" 2>"$work/refused"; then
    echo "FMUs with a library missing were packaged" >&2
    exit 1
fi
cat "$work/refused"

echo "program with these FMUs inside"
cp "$VIDEG" "$work/plain"
release/program.sh "$program" "$work/fmu" "$work/program"
python3 release/notices.py >"$work/THIRD-PARTY.md"
release/pack.sh linux-x86_64 "$work/program/videg" "$work/fmu" "$work/THIRD-PARTY.md" "$work/packed"
cp "$work"/fmu/*.fmu "$work/packed/"
release/checksums.sh "$work/packed"
(cd "$work/packed" && sha256sum --check --quiet SHA256SUMS)
PLAIN=$work/plain release/standalone.sh "$work/packed/videg-$version-linux-x86_64.tar.gz"
ls -l "$work/packed" "$work/program" "$work/plain"

echo "wheel with the same program and FMUs"
release/wheel.sh "$program" "$work/program/videg" "$work/fmu" "$work/THIRD-PARTY.md" "$work/wheel"
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check "$work"/wheel/videg-*.whl
# Outside of the source tree, as a user has it: in here the program would package the FMUs from the sources.
alone=$(mktemp -d)
trap 'rm -rf "$alone"' EXIT
"$work/venv/bin/python" - "$work" "$alone" <<'END'
import pathlib, shutil, subprocess, sys, videg

work, alone = map(pathlib.Path, sys.argv[1:])
for name in ("VibroImpactHarvester", "HarvestingCircuit"):
    assert pathlib.Path(videg.fmu(name)).read_bytes() == (work / f"fmu/{name}.fmu").read_bytes(), name
program = shutil.copy(videg.program(), alone)
assert pathlib.Path(program).read_bytes() == (work / "program/videg").read_bytes(), "another program"
subprocess.run([program, "cosim", "--until", "2"], cwd=alone, check=True, capture_output=True)
print("impacts in 5 s:", videg.simulate(until=5).impacts)
END

echo "every library builds from its package"
# The tool and its runs need the source tree around them, and what is not published has no version.
mapfile -t libraries < <(cargo metadata --no-deps --format-version 1 | python3 -c '
import json, sys
for package in json.load(sys.stdin)["packages"]:
    if package["publish"] is None and package["name"] not in ("videg", "videg-run"):
        print("--package=" + package["name"])')
CARGO_TARGET_DIR=$work/packages cargo package --quiet --allow-dirty "${libraries[@]}"
