#!/usr/bin/env bash
# Prints the version, or with `check` sees that all places that name it agree. See --help.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<'EOT'
Usage: version.sh [check [TAG]]

Without an argument prints the version of the workspace. With `check` sees that the packages of the workspace, what they ask
of each other, what fuzz/ locks of them, the model descriptions and the changelog agree on it. TAG, such as v1.2.3, must be
that version, and the changelog must have a section for it with a date and nothing under "Unreleased".
EOT
}

# Every package of the workspace, every requirement among them, and those of them that the workspace of fuzz/ locks.
check_packages() {
    local wanted=$1 found
    found=$(cd "$root" && cargo metadata --format-version 1 --no-deps --locked | python3 -c '
import json, sys, tomllib
wanted, packages = sys.argv[1], json.load(sys.stdin)["packages"]
names = [package["name"] for package in packages]
for package in tomllib.load(open("fuzz/Cargo.lock", "rb"))["package"]:
    if package["name"] in names and package["version"] != wanted:
        remedy = "cargo update --workspace --manifest-path fuzz/Cargo.toml"
        print("fuzz/Cargo.lock has {name} {version}; {remedy} mends that".format(remedy=remedy, **package))
for package in packages:
    if package["version"] != wanted:
        print("package {name} has version {version}".format(**package))
    for it in package["dependencies"]:
        if it.get("path") and it["req"] not in ("*", f"^{wanted}"):
            print("package {} asks for {name} {req}".format(package["name"], **it))' "$wanted")
    [[ -z $found ]] || fail "the version is $wanted, but $(head -n 1 <<<"$found")"
}

check_model_descriptions() {
    local wanted=$1 name file
    for name in "${FMUS[@]}"; do
        file=$root/modelDescription/$name.xml
        grep --quiet --fixed-strings " version=\"$wanted\" " "$file" ||
            fail "the version is $wanted, but not in modelDescription/$name.xml; UPDATE_MODEL_DESCRIPTION=1 cargo test writes it"
        grep --quiet --fixed-strings " generationTool=\"videg $wanted\"" "$file" ||
            fail "the version is $wanted, but modelDescription/$name.xml names another generationTool"
    done
}

# Sections from the newest to the oldest, as "## [Unreleased]" and "## [1.2.3] - 2026-01-31".
check_changelog() {
    local headings
    headings=$(grep '^## ' "$root/CHANGELOG.md" || true)
    [[ $(head -n 1 <<<"$headings") == "## [Unreleased]" ]] ||
        fail "CHANGELOG.md: the first section is \"$(head -n 1 <<<"$headings")\", wanted is \"## [Unreleased]\""
    while read -r heading; do
        [[ $heading =~ ^##\ \[[0-9]+\.[0-9]+\.[0-9]+(-[0-9A-Za-z.-]+)?\]\ -\ [0-9]{4}-[0-9]{2}-[0-9]{2}$ ]] ||
            fail "CHANGELOG.md: the section \"$heading\" has not the form \"## [1.2.3] - 2026-01-31\""
    done < <(tail -n +2 <<<"$headings")
}

check_tag() {
    local tag=$1 wanted=$2 left
    [[ $tag == "v$wanted" ]] || fail "the tag is $tag, wanted is v$wanted, after the version in Cargo.toml"
    "$root/release/notes.sh" "$wanted" >/dev/null
    left=$("$root/release/notes.sh" Unreleased 2>/dev/null || true)
    [[ -z $left ]] || fail "CHANGELOG.md: there are changes under \"Unreleased\", which belong under $wanted"
}

case ${1:-} in
    -h | --help) usage ;;
    "") version ;;
    check)
        [[ $# -le 2 ]] || fail "too many arguments (see --help)"
        wanted=$(version)
        [[ -n $wanted ]] || fail "Cargo.toml: [workspace.package] has no version"
        check_packages "$wanted"
        check_model_descriptions "$wanted"
        check_changelog
        [[ $# -lt 2 ]] || check_tag "$2" "$wanted"
        echo "version $wanted everywhere"
        ;;
    *) fail "unknown argument \"$1\" (see --help)" ;;
esac
