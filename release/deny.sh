#!/usr/bin/env bash
# Checks the dependencies of all three workspaces after deny.toml: deny.sh [CHECK...], of advisories, licenses, bans, sources
# (default: all but advisories, which ask a server). Installs cargo-deny below target/tools, of the version named here,
# unless it is there already.
#
# Environment: CONFIG, the rules in place of deny.toml.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
deny_version=0.20.2
config=$(realpath "${CONFIG:-$root/deny.toml}")
cd "$root"
tools=${CARGO_TARGET_DIR:-target}/tools
PATH="$(pwd)/target/tools/bin:$tools/bin:$PATH"
[[ $# -gt 0 ]] || set -- licenses bans sources

if [[ $(cargo-deny --version 2>/dev/null) != "cargo-deny $deny_version" ]]; then
    cargo install --quiet --locked --root "$tools" --version "$deny_version" cargo-deny
fi
# Each workspace needs some of the exceptions only.
for manifest in Cargo.toml fuzz/Cargo.toml tests/fmi-crate/Cargo.toml; do
    echo "+ cargo deny --manifest-path $manifest check $*"
    cargo deny --locked --workspace --all-features --manifest-path "$manifest" --config "$config" check \
        --hide-inclusion-graph --allow license-exception-not-encountered "$@"
done
