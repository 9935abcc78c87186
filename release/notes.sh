#!/usr/bin/env bash
# Prints what the changelog says about a version: notes.sh 1.2.3, or notes.sh Unreleased. Fails if that is nothing.
# Environment: CHANGELOG, the file (default CHANGELOG.md of the source tree).
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 1 ]] || fail "wants a version, such as $(version), or Unreleased"
changelog=${CHANGELOG:-$root/CHANGELOG.md}

notes=$(awk -v heading="## [$1]" '
    # The end of the sections: definitions of links.
    /^## / || /^\[[^]]+\]: / { inside = 0 }
    inside { print }
    index($0, heading) == 1 { inside = 1 }' "$changelog")
[[ $notes =~ [^[:space:]] ]] || fail "$changelog: nothing under \"## [$1]\""
# The command substitution has removed empty lines at the end; this removes those at the beginning.
sed '/./,$!d' <<<"$notes"
