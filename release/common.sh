# shellcheck shell=bash
# What the scripts of this folder share; sourced by them.

# Where all paths begin.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# Names of the FMUs.
# shellcheck disable=SC2034
readonly FMUS=(VibroImpactHarvester HarvestingCircuit)

fail() {
    echo "$(basename "$0"): $*" >&2
    exit 1
}

# The version of all packages of the workspace.
version() {
    sed -n '/^\[workspace\.package\]/,/^\[/s/^version = "\(.*\)"$/\1/p' "$root/Cargo.toml"
}

# The name that Cargo gives to the library of FMU $2 for platform $1.
library_name() {
    case $1 in
        linux*) echo "lib$2.so" ;;
        darwin*) echo "lib$2.dylib" ;;
        win*) echo "$2.dll" ;;
        *) fail "no platform of FMI 2.0 is called \"$1\"" ;;
    esac
}
