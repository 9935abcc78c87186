#!/bin/sh
# The linux64 libraries as they are released: they must need no symbol of a C library newer than 2.17 (the oldest that
# simulation tools still support), nor libgcc_s, which is not everywhere. Installs what is missing: cargo-zigbuild and zig
# as for a release (release/zig.sh), binutils from the distribution.
#
# Environment: GLIBC, the newest version that passes (default 2.17).
set -eu
cd "$(dirname "$0")/../.."
allowed=${GLIBC:-2.17}
built=$(realpath -m "${CARGO_TARGET_DIR:-target}")
work="$built/glibc-test"
rm -rf "$work"
mkdir -p "$work"

if ! command -v readelf >/dev/null; then
    as_root=
    [ "$(id -u)" -eq 0 ] || as_root=sudo
    $as_root apt-get install -y --no-install-recommends binutils
fi
tools=$(release/zig.sh)
PATH="$tools:$PATH"
export PATH

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
