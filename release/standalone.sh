#!/usr/bin/env bash
# Runs the program of a packed archive on Linux as somebody has it who has nothing else: standalone.sh ARCHIVE unpacks it in an
# empty folder, hides this source tree and Cargo, and does the program's main jobs there. Then does the same with the FMUs
# of the archive: what the program packages must have their bytes.
# Environment: PLAIN, a program without the feature embedded-fmus, which must say what it lacks.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 1 && -f $1 ]] || fail "wants a packed archive"
archive=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tar -xzf "$archive" -C "$work" --strip-components 1
[[ -z ${PLAIN:-} ]] || cp "$PLAIN" "$work/plain"

cat >"$work/jobs.sh" <<'END'
set -eu
root=$1
[ -z "$(ls -A "$root")" ] || { echo "the source tree is still there" >&2; exit 1; }
! command -v cargo >/dev/null || { echo "cargo is still there" >&2; exit 1; }
mkdir user
cd user
run() { echo "+ videg $*"; ../videg "$@" >log || { cat log; exit 1; }; }
run --version
run cosim --until 5 --output cosim
run cosim --circuit fmu --until 5 --output both
run simulate --until 5
run fmu build --output fmu
run fmu check fmu/VibroImpactHarvester.fmu
run fmu check fmu/HarvestingCircuit.fmu
run ssp
run explore --output explorer.html
run sweep --vary membrane.restitution=0.3:0.9:2 --until 2 --output sweep
run reproduce table1 fig7 --quick --output reproduce
for file in explorer.html cosim/report.html both/report.html sweep/sweep.csv reproduce/report.html target/fmu/Harvester.ssp; do
    [ -s "$file" ] || { echo "$file is missing" >&2; exit 1; }
done
for name in VibroImpactHarvester HarvestingCircuit; do
    cmp "fmu/$name.fmu" "../fmu/$name.fmu"
done
if [ -f ../plain ]; then
    code=0
    message=$(../plain fmu build 2>&1) || code=$?
    case $code:$message in
        2:*"without the feature embedded-fmus"*) echo "without FMUs inside: $message" ;;
        *) echo "without FMUs inside: exit code $code, $message" >&2; exit 1 ;;
    esac
fi
END
# An empty folder in place of the source tree, for this process and those that it starts.
# shellcheck disable=SC2016 # The inner shell takes its own arguments.
hide='mount -t tmpfs none "$1" && shift && exec "$@"'
jobs=(env -i PATH=/usr/bin:/bin HOME="$work" sh jobs.sh "$root")
as_root=(unshare --map-root-user --mount)
if ! "${as_root[@]}" true 2>/dev/null; then
    as_root=(sudo unshare --mount)
    # Back to the user, who could not remove the files of root afterwards.
    jobs=(setpriv --reuid "$(id -u)" --regid "$(id -g)" --clear-groups "${jobs[@]}")
fi
cd "$work"
"${as_root[@]}" sh -c "$hide" sh "$root" "${jobs[@]}"
echo "$(basename "$archive") works without its source tree"
