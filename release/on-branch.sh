#!/usr/bin/env bash
# Fails unless the commit that is checked out belongs to a branch: on-branch.sh BRANCH
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ $# -eq 1 ]] || fail "wants the name of a branch"
cd "$root"
git rev-parse --quiet --verify "$1^{commit}" >/dev/null || fail "there is no branch $1"
commit=$(git rev-parse HEAD)
git merge-base --is-ancestor HEAD "$1" || fail "commit $commit is not on $1"
echo "commit $commit is on $1"
