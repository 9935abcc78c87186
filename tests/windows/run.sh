#!/bin/sh
# The win64 library of the harvester FMU, run under Wine: it must load, give the results of the Linux library (as a slave
# and as differential equations), and turn a panic into fmi2Error instead of ending the host. Installs what is missing
# (Debian, Ubuntu): mingw-w64, Wine, the Rust target.
#
# Environment: TOLERANCE, the largest relative difference of a result that passes (default 1e-12).
set -eu
cd "$(dirname "$0")/../.."
target=x86_64-pc-windows-gnu
built=$(realpath -m "${CARGO_TARGET_DIR:-target}")
work="$built/windows-test"
rm -rf "$work"
mkdir -p "$work"

install_package() {
    as_root=
    [ "$(id -u)" -eq 0 ] || as_root=sudo
    $as_root apt-get install -y --no-install-recommends "$@" ||
        { $as_root apt-get update && $as_root apt-get install -y --no-install-recommends "$@"; }
}

find_wine() {
    # The wrapper `wine` of Debian complains that there is no 32-bit Wine; what it wraps does not.
    for wine in /usr/lib/wine/wine64 wine64 wine; do
        if command -v "$wine"; then return; fi
    done
}

command -v x86_64-w64-mingw32-gcc >/dev/null || install_package gcc-mingw-w64-x86-64
[ -n "$(find_wine)" ] || install_package wine64
[ -d "$(rustc --print sysroot)/lib/rustlib/$target/lib" ] || rustup target add "$target"
wine=$(find_wine)
export WINEPREFIX="$work/prefix" WINEDEBUG=-all
x86_64-w64-mingw32-gcc -shared -O1 -o "$work/bcryptprimitives.dll" tests/windows/bcryptprimitives.c -ladvapi32
# Windows looks for libraries in the folders of PATH, to which Wine adds these; Z: is the root folder.
WINEPATH="Z:$(printf %s "$work" | sed 's,/,\\,g')"
export WINEPATH

echo "building the FMUs for this machine and for win64, and the client for both"
cargo run -q --release -- fmu build --output "$work/linux"
cargo run -q --release -- fmu build --target win64 --output "$work/windows"
cargo build -q --release -p videg-fmu-client
cargo build -q --release -p videg-fmu-client --target "$target"
echo "the program compiles for Windows"
cargo check -q --target "$target" -p videg
python3 - "$work" <<'END'
import sys, zipfile
for system in ("linux", "windows"):
    archive = zipfile.ZipFile(f"{sys.argv[1]}/{system}/VibroImpactHarvester.fmu")
    archive.extractall(f"{sys.argv[1]}/{system}/unpacked")
END

echo "running Fig. 14 for 10 s in steps of 1 ms, and evaluating it as differential equations: here, and under $("$wine" --version)"
name=VibroImpactHarvester
"$built/release/videg-fmu-client" "$work/linux/unpacked/binaries/linux64/$name.so" \
    "$work/linux/unpacked/modelDescription.xml" >"$work/linux.txt"
"$wine" "$built/$target/release/videg-fmu-client.exe" "$work/windows/unpacked/binaries/win64/$name.dll" \
    "$work/windows/unpacked/modelDescription.xml" >"$work/windows.txt"
tr -d '\r' <"$work/windows.txt" | paste -d ' ' "$work/linux.txt" - | awk -v tolerance="${TOLERANCE:-1e-12}" '
    {
        if (NF != 4 || $1 != $3) { print "the outputs differ in form: " $0; failed = 1; next }
        difference = $2 - $4; if (difference < 0) difference = -difference
        size = $2 < 0 ? -$2 : $2
        relative = difference == 0 ? 0 : size == 0 ? 1 : difference / size
        printf "%-26s linux64 %-24s win64 %-24s relative difference %.2g\n", $1, $2, $4, relative
        if (relative > tolerance) failed = 1
        if (relative > largest) largest = relative
    }
    END {
        if (NR == 0) { print "no output"; failed = 1 }
        printf "largest relative difference %.2g, allowed %g\n", largest, tolerance
        exit failed
    }'

echo "running the tests of the panic guard under Wine"
CARGO_TARGET_X86_64_PC_WINDOWS_GNU_RUNNER=$wine cargo test -q -p fmu-export --target "$target" --test functions panics
echo "the win64 library works"
