#!/usr/bin/env bash
# Writes FOLDER/SHA256SUMS over all other files in FOLDER, in the form that `sha256sum --check` reads: checksums.sh FOLDER.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 1 && -d $1 ]] || fail "wants a folder"
cd "$1"
rm -f SHA256SUMS
files=(*)
[[ -f ${files[0]} ]] || fail "no file in $1"
sha256sum --binary -- "${files[@]}" >SHA256SUMS
cat SHA256SUMS
