#!/usr/bin/env bash
# Installs what the tests need and runs them, stage by stage. See ./test.sh --help.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# Setup comes first, then the others, the longest first.
readonly STAGES=(setup unit lint fmpy valgrind)
readonly VENV=.venv
# Each takes the one before in.
readonly REQUIREMENTS=(
    tests/requirements.txt
    scale/requirements.txt
    tests/requirements-conformance.txt
    tests/requirements-browser.txt
    tests/requirements-release.txt
)
# Stretches the brackets of the book's equations.
readonly MATH_FONT=/usr/share/fonts/truetype/dejavu/DejaVuMathTeXGyre.ttf
# A workspace of its own, see its Cargo.toml.
readonly FMI_CRATE=tests/fmi-crate/Cargo.toml

# Setup has installed all tools, so that no test may pass over what it needs.
export VIDEG_ALL_TOOLS=1

# Random tests draw the same parameters on every machine, so that a change is judged by what it changes; the stage soak and
# PROPTEST_RNG_SEED draw others.
export PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-20250101}

# What the stage slow is made of, the longest first.
readonly SLOW_STAGES=(unit-slow python browser book exporter scale conformance)
# These take longer still, install Wine and cross compilers, or need a nightly compiler.
readonly EXTRA_STAGES=(slow "${SLOW_STAGES[@]}" conformance-slow portability soak fuzz sanitizers miri release coverage)

usage() {
    cat <<'EOF'
Usage: ./test.sh [STAGE...]

Runs the stages named one after the other. Without a name it runs setup while the tests are compiled, and then those of the following that
have not passed yet on the same files, two at a time. A stage that fails runs again, alone:
  setup        install what the tests need: system packages that are missing (apt), Python packages into .venv
  unit         the tests of all Rust packages, but for the slow ones
  lint         cargo fmt, clippy and rustdoc, with warnings as errors; one version everywhere, shell scripts, workflows
  fmpy         FMPy simulates the FMUs and agrees with the command line, and under valgrind no library of theirs errs
  valgrind     random calls on the FMUs' libraries: no memory error, no leak

CI runs this one, too:
  slow         all of the following, two at a time as well; each runs alone, too:
  unit-slow    those tests of the Rust packages that are marked #[ignore = "slow"]
  scale        HELICS federates and sweeps on Dask and Slurm, each on this machine alone, give the bytes of one process
  conformance  a C program, importers and checkers take the FMUs; writes docs/conformance.md, and docs/coupling.md
               on how masters converge and circuits agree
  exporter     the README of fmu-export, followed outside of the source tree with the packaged crates, ends with an FMU that FMPy runs;
               so do the exporter's examples
  browser      reports and the page of `videg explore` in headless Chromium: drawn, without errors or requests, on a phone and a
               desktop, on paper; the page has the numbers of the command line; screenshots go to target/screenshots
  book         every code block of the book and the README runs and prints what is shown there; mdBook builds
               target/book/html, which headless Chromium looks at
  python       the wheel for Python, in an environment where no Rust is: it gives the bits of the command line, refuses bad input, its
               recipes run

Only when named:
  conformance-slow
               conformance with fmi-sim, too, which takes ten minutes to build; clippy for the reader with the crate `fmi`
  soak         runs of 1e6 s, and sweeps and outputs on failing disks, in full: the figures of docs/soak.md; random tests of
               model and circuit with parameters that no run has drawn before; optima of more cases in Python; pages at
               each width in both schemes
  portability  the FMUs for Windows under Wine, and for Linux against an old C library; installs what that takes
  fuzz         each fuzz target for 20 s, from inputs that the stage unit replays anyway; needs a nightly compiler
  sanitizers   the FMUs with AddressSanitizer, and ThreadSanitizer on many threads; needs a nightly compiler
  miri         unit tests of the model, and the tests of the exporter, in the interpreter Miri, which sees undefined behaviour; needs a
               nightly compiler
  release      a release as far as one machine can make it: FMUs of several platforms, the program without its source tree,
               licences of the dependencies, every library from its package; installs mingw and builds cargo-deny
  coverage     lines of model, circuit, coupled run, exporter and FMUs that their tests reach, into docs/coverage.md; builds cargo-llvm-cov

Needs a Rust toolchain with a C linker, and Python 3.11 or later. Stages after setup need it to have run once.
EOF
}

fail() {
    echo "test.sh: $*" >&2
    exit 1
}

# --- setup -----------------------------------------------------------------------------------------------------------

has_command() {
    command -v "$1" >/dev/null
}

has_daemon() {
    PATH="$PATH:/usr/sbin:/sbin" has_command "$1"
}

has_library() {
    # Not grep --quiet: it leaves early, and the broken pipe would count as a failure.
    PATH="$PATH:/usr/sbin:/sbin" ldconfig -p | grep --fixed-strings "$1" >/dev/null
}

# libclang, and the headers that belong to it.
has_libclang() {
    compgen -G '/usr/lib/llvm-*/lib/libclang.so*' >/dev/null &&
        compgen -G '/usr/lib/llvm-*/lib/clang/*/include/stddef.h' >/dev/null
}

has_venv() {
    python3 -c 'import ensurepip, venv' 2>/dev/null
}

# The Debian packages of those things that are not there.
missing_packages() {
    has_command cc || echo gcc libc6-dev
    has_command git || echo git
    has_command python3 || echo python3
    has_venv || echo python3-venv
    has_command xmllint || echo libxml2-utils
    has_library libtbb.so.12 || echo libtbb12
    has_libclang || echo libclang-dev
    has_command valgrind || echo valgrind
    has_command ngspice || echo ngspice
    has_library libngspice.so.0 || echo libngspice0
    has_command chromium-headless-shell || has_command chromium || echo chromium-headless-shell
    [[ -f $MATH_FONT ]] || echo fonts-dejavu-extra
    has_command shellcheck || echo shellcheck
    has_daemon slurmctld || echo slurmctld
    has_daemon slurmd || echo slurmd
    has_command sbatch || echo slurm-client
    has_daemon munged || echo munge
}

install_packages() {
    local as_root=()
    if [[ $(id -u) -ne 0 ]]; then
        has_command sudo || fail "these packages are missing, and neither root nor sudo is at hand: $*"
        as_root=(sudo)
    fi
    has_command apt-get || fail "these Debian packages are missing, and there is no apt-get to install them: $*"
    echo "installing $*"
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get)
    "${apt[@]}" update --quiet=2
    "${apt[@]}" install --quiet=2 --yes --no-install-recommends "$@" >/dev/null
}

# Installs the pinned Python packages, unless those of this very list are there already.
# Python compiles what it imports when it does, which is a small part.
install_python_packages() {
    local stamp="$VENV/requirements.sha256" wanted
    wanted=$(cat "${REQUIREMENTS[@]}" <(python3 --version) | sha256sum)
    if [[ -f $stamp && $(<"$stamp") == "$wanted" ]]; then
        echo "Python packages: up to date"
        return
    fi
    echo "installing Python packages into $VENV"
    python3 -m venv --clear "$VENV"
    "$VENV/bin/pip" install --quiet --disable-pip-version-check --no-compile --requirement "${REQUIREMENTS[-1]}"
    "$VENV/bin/pip" check
    echo "$wanted" >"$stamp"
}

stage_setup() {
    local packages
    read -r -d '' -a packages < <(missing_packages && printf '\0')
    if [[ ${#packages[@]} -eq 0 ]]; then
        echo "system packages: up to date"
    else
        install_packages "${packages[@]}"
    fi
    # What compiles the page of the explorer.
    if has_command rustup; then
        rustup target add wasm32-unknown-unknown
    fi
    has_venv || fail "the python3 on the PATH ($(command -v python3)) cannot make virtual environments"
    install_python_packages
}

# --- checks ----------------------------------------------------------------------------------------------------------

run() {
    echo "+ $*"
    "$@"
}

# A check that cannot run here; in continuous integration it must.
skip() {
    [[ -z ${CI:-} ]] || fail "$*"
    echo "skipped: $*"
}

# The tests of the FMUs ask for the feature model-description of fmu-export, so that the whole workspace checks and tests it with that;
# release builds of the FMUs are without.
stage_lint() {
    if cargo fmt --version >/dev/null 2>&1; then
        run cargo fmt --all --check
        run cargo fmt --manifest-path "$FMI_CRATE" --check
    else
        skip "cargo fmt is not installed"
    fi
    if cargo clippy --version >/dev/null 2>&1; then
        run cargo clippy --quiet --workspace --all-targets -- -D warnings
    else
        skip "cargo clippy is not installed"
    fi
    # Its workspace is of its own, so that nothing else looks whether what it locks is what the packages ask for.
    run cargo tree --quiet --locked --manifest-path fuzz/Cargo.toml --prefix none --depth 0
    # With the examples, for which Cargo gives dependencies the features that clippy has checked them with; without, it checks them again.
    run env RUSTDOCFLAGS="-D warnings" cargo doc --quiet --workspace --no-deps --lib --bins --examples
    run release/version.sh check
    run python3 release/interface.py check
    lint_workflows
}

# All in git or about to be, or where this is no clone, those in the places where scripts are.
shell_scripts() {
    git ls-files --cached --others --exclude-standard -- '*.sh' '*.sbatch' .ci/run 2>/dev/null ||
        ls -- *.sh {fuzz,release,scale/slurm,tests/*}/*.sh scale/slurm/*.sbatch .ci/run
}

lint_workflows() {
    local scripts
    if has_command shellcheck; then
        mapfile -t scripts < <(shell_scripts)
        run shellcheck "${scripts[@]}"
    else
        skip "shellcheck is not installed"
    fi
    if [[ -x $VENV/bin/zizmor ]]; then
        run "$VENV/bin/check-jsonschema" --builtin-schema vendor.github-workflows .github/workflows/*.yml
        run "$VENV/bin/zizmor" --quiet --offline .github/workflows
    else
        skip "check-jsonschema and zizmor are not in $VENV"
    fi
}

# Examples have no tests, and the stage lint compiles them.
readonly TESTED=(--workspace --tests)

# Needs nothing of what setup installs.
stage_compile() {
    run cargo test --quiet "${TESTED[@]}" --no-run
}

stage_unit() {
    run cargo test "${TESTED[@]}"
    run cargo test --workspace --doc
}

# Not the doc tests, where the mark means that they do not compile. The stage book runs the book.
stage_unit-slow() {
    run cargo test "${TESTED[@]}" -- --ignored --skip every_block_of_every_page
}

stage_slow() {
    run_side_by_side "${SLOW_STAGES[@]}"
}

stage_valgrind() {
    run tests/valgrind/run.sh
}

need_python() {
    [[ -x $VENV/bin/python ]] || fail "$VENV is not there; run ./test.sh setup first"
}

build_fmus() {
    run cargo build --release
    run cargo run --quiet --release -- fmu build
}

# With the program that the stage unit tests: optimising it would take minutes, and built by itself, it would get other features of its
# dependencies, which Cargo would compile again. FMUs are always optimised.
stage_fmpy() {
    need_python
    run cargo test "${TESTED[@]}" --no-run
    local program=${CARGO_TARGET_DIR:-$PWD/target}/debug/videg
    run "$program" fmu build
    run env VIDEG="$program" "$VENV/bin/python" -m pytest tests/fmpy
    run "$VENV/bin/python" tests/valgrind/fmpy_run.py
}

has_nightly() {
    cargo +nightly --version >/dev/null 2>&1
}

# A record of its own: the one in git is of long runs.
stage_fuzz() {
    has_nightly || fail "no nightly compiler, which fuzzing needs (rustup toolchain install nightly)"
    PATH="$PWD/target/tools/bin:$PATH" has_command cargo-fuzz ||
        run cargo install --quiet --locked --root target/tools cargo-fuzz --version 0.13.2
    run env RECORD=/dev/null fuzz/run.sh 20
}

stage_scale() {
    need_python
    build_fmus
    run "$VENV/bin/python" -m pytest tests/scale
}

stage_conformance() {
    need_python
    build_fmus
    run "$VENV/bin/python" -m pytest tests/c tests/conformance tests/coupling tests/netlists
    run "$VENV/bin/python" tests/conformance
    run "$VENV/bin/python" tests/coupling
}

stage_exporter() {
    need_python
    run "$VENV/bin/python" -m pytest tests/exporter
}

stage_browser() {
    need_python
    run cargo build --release
    run "$VENV/bin/python" -m pytest tests/browser
}

# mdBook is built from source once and then kept in target/tools; it is built faster than optimised by more than it takes longer.
stage_book() {
    need_python
    run cargo test --workspace --test book --test verbs -- --ignored # as the stage unit builds it, and `cargo fmu`
    run env CARGO_PROFILE_DEV_DEBUG=0 cargo install --quiet --locked --debug --root target/tools mdbook --version 0.5.4 --no-default-features --features search
    run target/tools/bin/mdbook build
    run cargo run --quiet --release -- explore --no-open --output target/book/html/explorer.html
    run "$VENV/bin/python" -m pytest tests/book
}

stage_python() {
    run cargo build --release
    run cargo run --quiet --release -- explore --no-open --output "${CARGO_TARGET_DIR:-target}/explorer.html"
    run tests/python/run.sh
}

stage_conformance-slow() {
    run cargo clippy --quiet --locked --manifest-path "$FMI_CRATE" --target-dir "${CARGO_TARGET_DIR:-target}" -- -D warnings
    run cargo install --quiet --locked --root target/tools fmi-sim --version 0.7.0
    PATH="$PWD/target/tools/bin:$PATH" stage_conformance
}

stage_portability() {
    run tests/linux-glibc/run.sh
    run tests/windows/run.sh
}

stage_sanitizers() {
    has_nightly || fail "no nightly compiler, which sanitizers need (rustup toolchain install nightly)"
    run tests/sanitizers/run.sh
}

# Under Miri tests take some thousand times as long: long ones have fewer cases there, or are left out with a reason. Some read files, so
# they are not isolated; some compare bits, so Miri must not vary the last digit of powers and logarithms.
stage_miri() {
    has_nightly || fail "no nightly compiler, which Miri needs (rustup toolchain install nightly)"
    cargo +nightly miri --version >/dev/null 2>&1 || run rustup component add miri rust-src --toolchain nightly
    export MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-deterministic-floats" PROPTEST_CASES=4
    run cargo +nightly miri test --locked -p videg-model --lib
    run cargo +nightly miri test --locked -p fmu-abi -p fmu-export --lib --tests
}

stage_release() {
    need_python
    run "$VENV/bin/python" -m pytest tests/release
    run release/deny.sh
    run tests/release/run.sh
}

stage_coverage() {
    run tests/coverage/run.sh
}

stage_soak() {
    run env VIDEG_SOAK=full cargo test --release --test long_run --test soak -- --include-ignored --nocapture --test-threads 1
    run env VIDEG_SOAK=full cargo test --release -p videg-model --test hostile -- --ignored
    run env VIDEG_SOAK=full cargo test --release --test crosscheck --test ngspice -- --ignored solvers_agree
    PROPTEST_RNG_SEED=$(date +%s) && echo "PROPTEST_RNG_SEED=$PROPTEST_RNG_SEED"
    run cargo test --release -p videg-model -p videg-circuit
    VIDEG_SOAK=full stage_python
    VIDEG_SOAK=full stage_browser
}

# --- main ------------------------------------------------------------------------------------------------------------

is_stage() {
    local stage
    for stage in "${STAGES[@]}" "${EXTRA_STAGES[@]}"; do
        [[ $stage == "$1" ]] && return
    done
    return 1
}

# What a result depends on: every file that git knows or would add, the compiler, Python and the seed of random tests. Nothing where
# this is no clone.
state() {
    git rev-parse --git-dir >/dev/null 2>&1 || return 0
    {
        # A file that git knows may be gone.
        git ls-files -z --cached --others --exclude-standard | xargs -0 sha256sum 2>/dev/null || true
        rustc --version
        python3 --version
        env | grep -E '^(PROPTEST|RUST|CARGO|VIDEG)' | sort
    } | sha256sum
}

# The state in which a stage last passed.
record() {
    echo "${CARGO_TARGET_DIR:-target}/passed/$1"
}

has_passed() {
    local now
    now=$(state)
    [[ -n $now && -f $(record "$1") && $(<"$(record "$1")") == "$now" ]]
}

run_stages() {
    local stage started before
    for stage in "$@"; do
        started=$SECONDS
        echo "=== $stage"
        before=$(state)
        "stage_$stage"
        mkdir -p "$(dirname "$(record "$stage")")"
        # A file that changed meanwhile was tested before or after.
        [[ $(state) == "$before" ]] && echo "$before" >"$(record "$stage")"
        echo "=== $stage: passed in $((SECONDS - started)) s"
    done
}

# The stages that run now, by the number of their process, those that failed, and the folder of what they print.
declare -A running=()
failed=()
printed=

end_running() {
    local numbers=("${!running[@]}")
    [[ ${#numbers[@]} -eq 0 ]] || kill -- "${numbers[@]/#/-}" 2>/dev/null || true
    rm -rf "$printed"
}

# Waits for one of the stages that run and prints what it printed.
await_stage() {
    local number code=0 stage
    wait -n -p number "${!running[@]}" || code=$?
    stage=${running[$number]}
    unset "running[$number]"
    cat "$printed/$stage"
    if [[ $code -ne 0 ]]; then
        echo "=== $stage: failed beside others; runs again alone"
        failed+=("$stage")
    fi
}

# Runs stages two at a time, since most of them keep one core busy. What failed may have waited too long for a core that another stage
# had: it runs again alone, and must pass.
run_side_by_side() {
    local stage
    failed=()
    printed=$(mktemp -d)
    trap end_running EXIT
    trap 'exit 130' INT
    trap 'exit 143' TERM
    set -m # a process group each, which is ended as a whole
    for stage in "$@"; do
        [[ ${#running[@]} -lt 2 ]] || await_stage
        echo "=== $stage: begins"
        run_stages "$stage" </dev/null >"$printed/$stage" 2>&1 &
        running[$!]=$stage
    done
    while [[ ${#running[@]} -gt 0 ]]; do
        await_stage
    done
    set +m
    end_running
    [[ ${#failed[@]} -eq 0 ]] || run_stages "${failed[@]}"
}

main() {
    local stage left=()
    for stage in "$@"; do
        case $stage in
            -h | --help)
                usage
                return
                ;;
            *) is_stage "$stage" || fail "no stage is called \"$stage\"; there are: ${STAGES[*]} ${EXTRA_STAGES[*]}" ;;
        esac
    done
    if [[ $# -gt 0 ]]; then
        run_stages "$@"
        echo "=== all passed: $*"
        return
    fi
    if has_passed unit; then
        run_stages setup
    else
        run_side_by_side setup compile
    fi
    for stage in "${STAGES[@]:1}"; do
        if has_passed "$stage"; then
            echo "=== $stage: passed before on the same files; ./test.sh $stage runs it again"
        else
            left+=("$stage")
        fi
    done
    [[ ${#left[@]} -eq 0 ]] || run_side_by_side "${left[@]}"
    echo "=== all passed: ${STAGES[*]}"
}

main "$@"
