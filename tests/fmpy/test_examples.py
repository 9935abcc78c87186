"""The tutorials as scripts, as a reader runs them: in the root of the source tree, with the tool on the PATH and no screen."""

import os
import shutil
import subprocess
import sys

import pytest

import harness

PROGRAMS = harness.ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "release"


@pytest.mark.parametrize(
    "script, figures",
    [("fmpy_tutorial", ["capacitance.svg", "energy.svg"]), ("ngspice_coupling", ["storage.svg"]), ("own_membrane", [])],
)
def test_a_tutorial_runs_and_draws_its_figures(fmus, tmp_path, script, figures):
    if script == "ngspice_coupling" and not shutil.which("ngspice"):
        assert "VIDEG_ALL_TOOLS" not in os.environ, "ngspice is not there"
        pytest.skip("ngspice is not there")
    places = [os.path.dirname(sys.executable), str(PROGRAMS), os.environ["PATH"]]
    # FMPy leaves what it has unpacked where an FMU refuses a value.
    drawn, temporary = tmp_path / "figures", tmp_path / "temporary"
    drawn.mkdir()
    temporary.mkdir()
    environment = {**os.environ, "PATH": os.pathsep.join(places), "MPLBACKEND": "Agg"}
    environment |= {"FIGURES": str(drawn), "TMPDIR": str(temporary)}
    script = harness.ROOT / "examples" / f"{script}.py"
    run = subprocess.run([sys.executable, script], cwd=harness.ROOT, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert sorted(path.name for path in drawn.iterdir()) == sorted(figures)
    for figure in figures:
        assert "<path" in (drawn / figure).read_text(), f"{figure} is empty"
