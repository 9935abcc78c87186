#!/usr/bin/env bash
# Builds the wheel, installs it into an environment of its own outside of the source tree, and tests it there with nothing else on the
# PATH: no Rust, no Cargo, no program of this source tree. Prints how long a user waits for the first table. The source distribution
# must have the files that git has, so that what is built from it is the same.
#
# Environment: WHEEL, a wheel to test in place of one that is built here; VIDEG_SOAK=full, for what takes longer.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 -m venv "$work/user"
wheel=${WHEEL:-}
if [[ -z $wheel ]]; then
    release/wheel.sh source - - - "$work"
    diff <(git ls-files | LC_ALL=C sort) \
        <(tar --list --gzip --file "$work"/videg-*.tar.gz | sed 's,^[^/]*/,,; /^PKG-INFO$/d' | LC_ALL=C sort)
    # What is built already is not built again; but not in its place, since the wheel's program has other features.
    target=${CARGO_TARGET_DIR:-$PWD/target}
    mkdir -p "$target/python"
    cp --archive "$target"/{release,wasm,wasm32-unknown-unknown} "$target/python/"
    if ! CARGO_TERM_COLOR=never CARGO_TARGET_DIR=$target/python "$work/user/bin/pip" wheel --verbose --disable-pip-version-check --no-deps --wheel-dir "$work" . \
        >"$work/built" 2>&1; then
        cat "$work/built"
        exit 1
    fi
    if grep "Compiling videg-report" "$work/built"; then
        echo "the wheel compiles again what cargo build has compiled: its dependencies have other features, see build-dependencies in Cargo.toml" >&2
        exit 1
    fi
    wheel=$(ls "$work"/videg-*.whl)
fi
ls -l "$wheel"

alone=(env -i HOME="$work" PATH="$work/user/bin" LANG=C.UTF-8 VIDEG_SOAK="${VIDEG_SOAK:-}")
started=$(date +%s.%N)
"$work/user/bin/pip" install --quiet --disable-pip-version-check "$wheel"
(cd "$work" && "${alone[@]}" videg cosim >"$work/table")
grep --fixed-strings "net power" "$work/table"
echo "from pip install to the first table: $(python3 -c "import time; print(f'{time.time() - $started:.1f}')") s"
if "${alone[@]}" "$BASH" -c 'command -v cargo rustc'; then
    echo "Rust is on the PATH of the environment" >&2
    exit 1
fi

"$work/user/bin/pip" install --quiet --disable-pip-version-check --no-compile --requirement tests/python/requirements.txt
"${alone[@]}" python -m pytest -p no:cacheprovider tests/python
