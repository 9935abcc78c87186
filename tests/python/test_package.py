"""What the package brings: FMUs for FMPy, the program, types; memory and threads."""

import inspect
import resource
import subprocess
import sys
import zipfile
from importlib.metadata import version
from pathlib import Path

import fmpy
import numpy as np
import pytest
import videg


def test_fmpy_runs_the_fmu_as_the_package_does() -> None:
    values = {name: it.fmi for name, it in videg.start_values("fig14").items()}
    result = fmpy.simulate_fmu(
        videg.fmu(), stop_time=3.0, output_interval=0.01, start_values=values, output=["left.capacitance", "ball.position"]
    )
    ours = videg.simulate("fig14", until=3.0, sample=0.01, record=["left.capacitance", "ball.position"])
    for name in ours:
        # The times of FMPy are rounded otherwise.
        np.testing.assert_allclose(result[name][: len(ours.time)], ours[name], rtol=1e-6, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("name", ["VibroImpactHarvester", "HarvestingCircuit"])
def test_the_fmus_are_valid(name: str) -> None:
    assert fmpy.validation.validate_fmu(videg.fmu(name)) == []


def test_the_system_package_has_both_fmus() -> None:
    with zipfile.ZipFile(videg.ssp()) as archive:
        names = archive.namelist()
    assert "SystemStructure.ssd" in names and sum(name.endswith(".fmu") for name in names) == 2, names


def test_the_program_is_there() -> None:
    said = subprocess.run(["videg", "--version"], capture_output=True, text=True, check=True).stdout
    assert said == f"videg {videg.__version__}\n" and version("videg") == videg.__version__
    said = subprocess.run([sys.executable, "-m", "videg", "cosim", "--help"], capture_output=True, text=True, check=True)
    assert "--circuit" in said.stdout
    failed = subprocess.run(["videg", "cosim", "--until", "x"], capture_output=True, text=True, check=False)
    assert failed.returncode == 2


def test_nothing_is_written_into_the_package(tmp_path: Path) -> None:
    folder = Path(videg.__file__).parent
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.suffix != ".pyc"}
    subprocess.run(["videg", "cosim", "--until", "1"], cwd=tmp_path, capture_output=True, check=True)
    videg.cosim(until=1.0)
    after = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.suffix != ".pyc"}
    assert before == after
    assert (folder / "py.typed").is_file()


def test_everything_public_is_documented() -> None:
    for name in videg.__all__:
        thing = getattr(videg, name)
        assert inspect.getdoc(thing), name
        if not inspect.isfunction(thing):
            continue
        said = inspect.getdoc(thing)
        for parameter in inspect.signature(thing).parameters:
            assert f"    {parameter}: " in said, f"{name}: {parameter}"


def test_memory_does_not_grow_with_the_number_of_runs() -> None:
    def run(count: int) -> None:
        for _ in range(count):
            videg.simulate(until=0.01, sample=0.01, record=[])

    run(300)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    run(3000)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert grown < 8 * 1024, f"{grown} KiB"


def test_a_figure(tmp_path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    run = videg.simulate(until=2.0)
    figure = run.plot(window=(1.0, 2.0))
    assert len(figure.axes) == 2 and figure.axes[0].get_ylabel() == "left.capacitance\nF"
    figure.savefig(tmp_path / "it.png")
    with pytest.raises(KeyError, match="nothing: not recorded"):
        run.plot("nothing")


def test_export_and_netlist(tmp_path: Path) -> None:
    written = videg.netlist(tmp_path / "membranes.lib", until=2.0)
    assert [Path(file).exists() for file in written.files] == [True] * len(written.files)
    assert ".subckt deg_left" in Path(written.files[0]).read_text().lower()
    for form in ("csv", "parquet", "mat"):
        path = tmp_path / f"table.{form}"
        assert videg.export(path, format=form, until=1.0).rows == 1001 and path.is_file()
