#!/usr/bin/env bash
# Packs the archive that users unpack: pack.sh NAME PROGRAM FMUS NOTICES FOLDER writes FOLDER/videg-VERSION-NAME.tar.gz, or .zip
# for a program of Windows. PROGRAM is videg with the FMUs inside, FMUS the folder of the same FMUs as files, NOTICES the
# licenses of what the program contains, as notices.py writes them.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 5 ]] || fail "wants a name, the program, the folder of the FMUs, the notices and a folder"
name=videg-$(version)-$1
program=$2 fmus=$3 notices=$4
mkdir -p "$5"
folder=$(cd "$5" && pwd)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/$name/fmu"
cp "$program" "$work/$name/"
for fmu in "${FMUS[@]}"; do cp "$fmus/$fmu.fmu" "$work/$name/fmu/"; done
cp "$root"/{README.md,CHANGELOG.md,LICENSE-MIT,LICENSE-APACHE} "$work/$name/"
cp "$notices" "$work/$name/THIRD-PARTY.md"
# Python writes both forms on every system, and the same bytes from the same files.
python3 - "$work" "$name" "$folder" "${program##*.}" <<'END'
import gzip, io, pathlib, sys, tarfile, zipfile

work, name, folder, suffix = sys.argv[1:]
files = sorted(path for path in pathlib.Path(work, name).rglob("*") if path.is_file())
entries = [(path.relative_to(work).as_posix(), path.read_bytes(), path.stem == "videg") for path in files]
if suffix == "exe":
    archive = pathlib.Path(folder, f"{name}.zip")
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as out:
        for entry, data, _ in entries:
            out.writestr(zipfile.ZipInfo(entry), data, zipfile.ZIP_DEFLATED)
else:
    archive = pathlib.Path(folder, f"{name}.tar.gz")
    with gzip.GzipFile(archive, "wb", mtime=0) as packed, tarfile.open(fileobj=packed, mode="w") as out:
        for entry, data, executable in entries:
            info = tarfile.TarInfo(entry)
            info.size, info.mode = len(data), 0o755 if executable else 0o644
            out.addfile(info, io.BytesIO(data))
print(archive)
END
