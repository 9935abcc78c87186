"""The tutorials as scripts, as a reader runs them: in the root of the source tree, without a screen. None of them calls Cargo."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import harness

PROGRAMS = Path(os.environ.get("VIDEG", harness.TARGET / "release" / "videg")).parent


@pytest.fixture
def environment(tmp_path):
    """The variables of a reader who has Python, and a Cargo that fails."""
    cargo = tmp_path / "cargo" / "cargo"
    for name in ("cargo", "figures", "temporary"):
        (tmp_path / name).mkdir()
    cargo.write_text(f"#!/bin/sh\ntouch {tmp_path}/cargo/called\nexit 1\n")
    cargo.chmod(0o755)
    # What is installed beside the tool of a reader's own is of no concern here.
    others = [place for place in os.environ["PATH"].split(os.pathsep) if not shutil.which("videg", path=place)]
    places = [str(cargo.parent), os.path.dirname(sys.executable), *others]
    # FMPy leaves what it has unpacked where an FMU refuses a value.
    variables = {"PATH": os.pathsep.join(places), "FIGURES": str(tmp_path / "figures"), "MPLBACKEND": "Agg"}
    kept = {name: value for name, value in os.environ.items() if name not in ("CARGO", "CARGO_TARGET_DIR", "VIDEG", "VIDEG_FMUS")}
    yield {**kept, **variables, "TMPDIR": str(tmp_path / "temporary")}
    assert not (tmp_path / "cargo" / "called").exists(), "Cargo was called"


@pytest.fixture
def elsewhere(tmp_path):
    """A source tree in which nothing is built."""
    tree = tmp_path / "tree"
    shutil.copytree(harness.ROOT / "examples", tree / "examples", ignore=shutil.ignore_patterns("__pycache__"))
    return tree


def start(script, tree, environment):
    command = [sys.executable, tree / "examples" / f"{script}.py"]
    return subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True)


def assert_drawn(run, environment, figures):
    assert run.returncode == 0, run.stderr
    drawn = Path(environment["FIGURES"])
    assert sorted(path.name for path in drawn.iterdir()) == sorted(figures)
    for figure in figures:
        assert "<path" in (drawn / figure).read_text(), f"{figure} is empty"


@pytest.mark.parametrize(
    "script, figures",
    [("fmpy_tutorial", ["capacitance.svg", "energy.svg"]), ("ngspice_coupling", ["storage.svg"]), ("own_membrane", [])],
)
def test_a_tutorial_runs_and_draws_its_figures(fmus, environment, script, figures):
    if script == "ngspice_coupling" and not shutil.which("ngspice"):
        assert "VIDEG_ALL_TOOLS" not in os.environ, "ngspice is not there"
        pytest.skip("ngspice is not there")
    environment["PATH"] += os.pathsep + str(PROGRAMS)
    assert_drawn(start(script, harness.ROOT, environment), environment, figures)


def test_fmus_that_are_there_are_all_that_the_tutorial_with_fmpy_takes(fmus, environment, elsewhere):
    environment["VIDEG_FMUS"] = str(Path(fmus["VibroImpactHarvester"]).parent)
    run = start("fmpy_tutorial", elsewhere, environment)
    assert_drawn(run, environment, ["capacitance.svg", "energy.svg"])


def test_fmus_that_are_not_there_are_those_of_the_tool(fmus, environment, elsewhere):
    environment["PATH"] += os.pathsep + str(PROGRAMS)
    code = "from find_videg import fmu; print(fmu('HarvestingCircuit'))"
    command = [sys.executable, "-c", code]
    run = subprocess.run(command, cwd=elsewhere / "examples", env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    fmu = elsewhere / "target" / "fmu" / "HarvestingCircuit.fmu"
    assert run.stdout.splitlines()[-1] == str(fmu) and fmu.read_bytes() == Path(fmus["HarvestingCircuit"]).read_bytes()


@pytest.mark.parametrize("script", ["fmpy_tutorial", "ngspice_coupling", "own_membrane"])
def test_with_neither_fmus_nor_tool_a_tutorial_says_what_to_run(environment, elsewhere, script):
    run = start(script, elsewhere, environment)
    said = run.stderr.splitlines()
    assert run.returncode == 1 and len(said) == 1, run.stderr
    assert "neither on the PATH nor in" in said[0] and "run `cargo run --release -- fmu build`" in said[0]
    assert script != "fmpy_tutorial" or "VIDEG_FMUS" in said[0]
