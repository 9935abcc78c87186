#!/usr/bin/env bash
# Installs what builds for an old C library, below target/tools: cargo-zigbuild and, as a Python package, zig, of the
# versions named here, unless they are there already. Prints the folders to put at the beginning of PATH.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
zigbuild_version=0.24.1
ziglang_version=0.17.0
tools=$(realpath -m "${CARGO_TARGET_DIR:-$root/target}")/tools
mkdir -p "$tools"
PATH="$tools/zig/bin:$tools/bin:$PATH"

if [[ $(cargo-zigbuild --version 2>/dev/null) != "cargo-zigbuild $zigbuild_version" ]]; then
    cargo install --quiet --locked --root "$tools" --version "$zigbuild_version" cargo-zigbuild >&2
fi
if [[ $(python3 -m ziglang version 2>/dev/null) != "$ziglang_version" ]]; then
    [[ -x $tools/zig/bin/python3 ]] || python3 -m venv "$tools/zig"
    "$tools/zig/bin/pip" install --quiet --disable-pip-version-check "ziglang==$ziglang_version" >&2
fi
echo "$tools/zig/bin:$tools/bin"
