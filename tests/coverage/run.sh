#!/usr/bin/env bash
# Runs the tests of the packages that an FMU is made of, and of the coupled run, with their coverage counted, and writes docs/coverage.md. Installs
# cargo-llvm-cov below target/tools. Needs the tools of the LLVM that the compiler is made with: the component llvm-tools of
# rustup, or a package of the system such as llvm-22.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
llvm_cov_version=0.9.1
built=${CARGO_TARGET_DIR:-target}
PATH="$PWD/target/tools/bin:$built/tools/bin:$PATH"

if [[ $(cargo-llvm-cov llvm-cov --version 2>/dev/null) != "cargo-llvm-cov $llvm_cov_version" ]]; then
    cargo install --quiet --locked --root "$built/tools" --version "$llvm_cov_version" cargo-llvm-cov
fi
sysroot=$(rustc --print sysroot)
# Where rustup keeps the compiler, it has the tools, too.
if [[ -d $sysroot/lib/rustlib ]] && command -v rustup >/dev/null; then
    rustup component add llvm-tools >/dev/null 2>&1 || true
fi
if ! compgen -G "$sysroot/lib/rustlib/*/bin/llvm-profdata*" >/dev/null; then
    major=$(rustc --version --verbose | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p')
    tools=/usr/lib/llvm-$major/bin
    if [[ ! -x $tools/llvm-profdata ]]; then
        echo "coverage: no llvm-profdata of LLVM $major; rustup component add llvm-tools, or apt-get install llvm-$major" >&2
        exit 1
    fi
    export LLVM_COV=$tools/llvm-cov LLVM_PROFDATA=$tools/llvm-profdata
fi

# Without it small functions are compiled into each package that calls them, and are counted where none is called.
export CARGO_INCREMENTAL=1
packages=(-p videg-model -p videg-circuit -p videg-coupled -p fmu-abi -p fmu-export -p videg-fmu-harvester -p videg-fmu-circuit)
cargo llvm-cov clean --workspace
cargo llvm-cov --no-report --quiet "${packages[@]}"
# By itself: together with the FMUs its feature would get into them.
cargo llvm-cov --no-report --quiet -p fmu-export --all-features
cargo llvm-cov report "${packages[@]}" --lcov --output-path "$built/coverage.lcov"
python3 tests/coverage "$built/coverage.lcov"
