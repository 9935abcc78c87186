"""The types that the package tells: those of the extension module are what is there, and a user's program is checked with them."""

import subprocess
import sys
from pathlib import Path

PROGRAM = """
import numpy as np
import videg
run = videg.simulate("fig14", until=1.0, set={"membrane.restitution": np.float64(0.5)}, record=["left.capacitance"])
reveal_type(run["left.capacitance"].max())
reveal_type(videg.cosim().net_power)
reveal_type(videg.evaluate({"ball.mass": np.linspace(1e-3, 2e-3, 3)})["impacts"].shape)
videg.sweep(vary={"membrane.restitution": videg.Range(0.1, 0.9, 3), "ball.mass": [1e-3, 2e-3], "load.resistance": "1e8:1e9:2"})
with videg.Harvester() as harvester:
    reveal_type(harvester.save())
"""

MISTAKES = ["videg.simulate(until='1')", "videg.simulate('fig14', 5.0)", "videg.Harvester().save().data + 1", "videg.fmu(3)"]


def mypy(folder: Path, program: str) -> subprocess.CompletedProcess[str]:
    (folder / "program.py").write_text(program)
    command = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "program.py"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_a_program_is_checked(tmp_path: Path) -> None:
    found = mypy(tmp_path, PROGRAM)
    assert found.returncode == 0, found.stdout
    for said in ("float", "tuple[", "State"):
        assert said in found.stdout, found.stdout


def test_mistakes_are_seen(tmp_path: Path) -> None:
    found = mypy(tmp_path, "\n".join(["import videg", *MISTAKES]) + "\n")
    assert found.returncode == 1, found.stdout
    for line, mistake in enumerate(MISTAKES, start=2):
        assert f"program.py:{line}: error" in found.stdout, f"{mistake}\n{found.stdout}"


def test_the_stubs_are_those_of_the_module(tmp_path: Path) -> None:
    allowed = tmp_path / "allowed"
    # The list that PyO3 makes of all names.
    allowed.write_text("videg._videg.__all__\n")
    command = [sys.executable, "-m", "mypy.stubtest", "videg._videg", "--allowlist", allowed]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout
