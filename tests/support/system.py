"""The coupled system in several tools: series of harvester and circuit at the end of each step, by name."""

import csv
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import harness

NAMES = {
    "harvester": ["left.capacitance", "right.capacitance", "relativeDisplacement", "gain.voltage"],
    "circuit": [
        "left.voltage",
        "right.voltage",
        "supply.energy",
        "load.energy",
        "zener.energy",
        "stored.energy",
        "mechanical.energy",
    ],
}
"""What is compared, by component."""

PATHS = [f"{component}.{name}" for component, names in NAMES.items() for name in names]

Series = dict[str, np.ndarray]


def videg(step: float, steps: int, *arguments: str, master: str = "plain") -> Series:
    """`videg cosim`, at the points of the grid."""
    with tempfile.TemporaryDirectory() as folder:
        until = ("--until", repr(steps * step), "--step", repr(step), "--sample", "step")
        harness.videg("cosim", "--master", master, *until, "--output", folder, *arguments)
        with open(Path(folder) / "timeseries.csv", newline="") as file:
            rows = {float(row["time"]): row for row in csv.DictReader(file)}
    on_grid = [rows[index * step] for index in range(1, steps)] + [rows[max(rows)]]
    return {path: np.array([float(row[path.split(".", 1)[1]]) for row in on_grid]) for path in PATHS}


def fmpy_ssp(package: str, step: float, steps: int) -> Series:
    """FMPy's master. It takes parameters by their full names and does not follow the bindings of the components."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssv

    parameters = read_ssv(package, resource="resources/system.ssv")
    # Half a step less: it adds up its steps, and must not do one more.
    result = simulate_ssp(package, stop_time=(steps - 0.5) * step, step_size=step, parameter_set=parameters)
    return {path: result[path] for path in PATHS}


@contextmanager
def temporary_files() -> Iterator[None]:
    """Libraries put their temporary files into a folder that goes away afterwards."""
    before = os.environ.get("TMPDIR")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["TMPDIR"] = folder
        try:
            yield
        finally:
            del os.environ["TMPDIR"]
            if before is not None:
                os.environ["TMPDIR"] = before


def ecos_ssp(package: str, step: float, steps: int) -> Series:
    """Ecos's master. Parameter sets of a package go by the name of the case. It never removes what it unpacks."""
    from ecospy import EcosLib, EcosSimulation

    EcosLib.set_log_level("warn")
    read = [f"{component}::{name}" for component, names in NAMES.items() for name in names]
    rows = []
    with temporary_files(), EcosSimulation(ssp_path=package, step_size=step) as simulation:
        assert simulation.init(parameter_set="fig14"), EcosLib.get_last_error()
        for _ in range(steps):
            simulation.step()
            rows.append([simulation.get_real(name) for name in read])
        simulation.terminate()
    return dict(zip(PATHS, np.array(rows).T))
