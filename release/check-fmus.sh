#!/usr/bin/env bash
# Checks FMUs before they are released: check-fmus.sh FOLDER PLATFORM... fails unless both FMUs in FOLDER hold a library for
# each of these platforms and no other, load and run here, and are valid for FMPy and against the schema of FMI 2.0.
# Environment: VIDEG, the command-line tool (default: `cargo run --release`); PYTHON, one with FMPy (default .venv/bin/python).
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -ge 2 ]] || fail "wants a folder and the platforms that its FMUs must hold"
folder=$1
shift
wanted=$(printf '%s\n' "$@" | sort | paste -s -d ' ')
python=${PYTHON:-$root/.venv/bin/python}
videg=("${VIDEG:-}")
[[ -n ${VIDEG:-} ]] || videg=(cargo run --quiet --release --locked --manifest-path "$root/Cargo.toml" --)

for fmu in "${FMUS[@]}"; do
    file=$folder/$fmu.fmu
    found=$("${videg[@]}" fmu info --json "$file" |
        python3 -c 'import json, sys; print(*sorted(json.load(sys.stdin)["platforms"]))')
    [[ $found == "$wanted" ]] || fail "$file holds libraries for \"$found\", wanted is \"$wanted\""
    "${videg[@]}" fmu check "$file" >/dev/null || fail "$file does not keep what its model description promises"
    PYTHONPATH=$root/tests/conformance "$python" -c '
import sys
from tools import fmpy_validate, xsd
for tool in (fmpy_validate, xsd):
    tool.check(sys.argv[1])' "$file"
    echo "$file: valid, runs here, $found"
done
