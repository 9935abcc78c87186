#!/bin/sh
# The linux64 libraries as they are released: they must need no symbol of a C library newer than 2.17 (the oldest that
# simulation tools still support), nor libgcc_s, which is not everywhere. Installs what is missing: cargo-zigbuild from
# crates.io, zig from PyPI, both below the target folder and of the versions named here; binutils from the distribution.
#
# Environment: GLIBC, the newest version that passes (default 2.17).
set -eu
cd "$(dirname "$0")/../.."
zigbuild_version=0.24.1
ziglang_version=0.17.0
allowed=${GLIBC:-2.17}
built=$(realpath -m "${CARGO_TARGET_DIR:-target}")
tools="$built/tools"
work="$built/glibc-test"
rm -rf "$work"
mkdir -p "$work" "$tools"

if ! command -v readelf >/dev/null; then
    as_root=
    [ "$(id -u)" -eq 0 ] || as_root=sudo
    $as_root apt-get install -y --no-install-recommends binutils
fi
PATH="$tools/zig/bin:$tools/bin:$PATH"
export PATH
if [ "$(cargo-zigbuild --version 2>/dev/null)" != "cargo-zigbuild $zigbuild_version" ]; then
    cargo install -q --locked --root "$tools" --version "$zigbuild_version" cargo-zigbuild
fi
if [ "$(python3 -m ziglang version 2>/dev/null)" != "$ziglang_version" ]; then
    [ -x "$tools/zig/bin/python3" ] || python3 -m venv "$tools/zig"
    "$tools/zig/bin/pip" install -q --disable-pip-version-check "ziglang==$ziglang_version"
fi

echo "building the FMUs for linux64"
cargo run -q --release -- fmu build --target linux64 --output "$work"
for name in VibroImpactHarvester HarvestingCircuit; do
    library="$work/$name.so"
    python3 - "$work" "$name" <<'END'
import sys, zipfile
folder, name = sys.argv[1:]
archive = zipfile.ZipFile(f"{folder}/{name}.fmu")
with open(f"{folder}/{name}.so", "wb") as file:
    file.write(archive.read(f"binaries/linux64/{name}.so"))
END
    newest=$(readelf --version-info --wide "$library" | grep -o 'GLIBC_[0-9.]*' | sort -u -V | tail -n 1)
    needed=$(readelf --dynamic --wide "$library" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | tr '\n' ' ')
    echo "$name: newest symbol version $newest, allowed GLIBC_$allowed; needs $needed"
    if [ -z "$newest" ]; then
        echo "$name: no symbol version found, so nothing was checked" >&2
        exit 1
    fi
    if [ "$(printf '%s\n' "$newest" "GLIBC_$allowed" | sort -V | tail -n 1)" != "GLIBC_$allowed" ]; then
        echo "$name: needs $newest, newer than GLIBC_$allowed" >&2
        exit 1
    fi
    case "$needed" in
        *libgcc_s*)
            echo "$name: needs libgcc_s" >&2
            exit 1
            ;;
    esac
done
echo "the linux64 libraries run with glibc $allowed and later"
