#!/usr/bin/env bash
# Holds files that one job of the release hands to another to what they were: an artifact can be put in the place of another by
# any job of the run, an output of a job cannot.
#
#   sums.sh FOLDER             prints the checksums of all files below FOLDER, on one line, as an output must be
#   sums.sh FOLDER SUMS...     fails unless the files below FOLDER are those of all SUMS, which such calls printed, and no others
#
# For Linux, Windows and macOS, whose tools have few options in common.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
export LC_ALL=C
[[ $# -gt 0 && -d $1 ]] || fail "wants a folder, and the checksums that its files must have"
sum=(sha256sum)
command -v sha256sum >/dev/null || sum=(shasum -a 256)

found=$(cd "$1" && find . ! -type d -exec "${sum[@]}" --binary {} + | sort)
[[ -n $found ]] || fail "no file in $1"
if [[ $# -eq 1 ]]; then
    base64 <<<"$found" | tr -d '\r\n'
    exit
fi
wanted=
for sums in "${@:2}"; do
    [[ -n $sums ]] || fail "a job has handed on no checksums"
    lines=$(base64 --decode <<<"$sums")
    wanted+=$lines$'\n'
done
wanted=$(sort <<<"${wanted%$'\n'}")
if [[ $found != "$wanted" ]]; then
    diff <(echo "$wanted") <(echo "$found") >&2 || true
    fail "the files in $1 (>) are not those that were made (<)"
fi
echo "$found"
