"""The job that every importer does: the paper's Fig. 14, the harvester connected with the circuit."""

import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import differences  # noqa: E402
import harness  # noqa: E402

HARVESTER, CIRCUIT = "VibroImpactHarvester", "HarvestingCircuit"
FMUS = (HARVESTER, CIRCUIT)

STEP, STEPS = 1e-3, 10_000
START_VALUES = harness.fig14()
CONNECTED = ("left.capacitance", "right.capacitance")
"""Outputs of the harvester and inputs of the circuit. The values at the start of a step go in, as in any fixed-step
master (Jacobi)."""

NEVER = 1e300
"""Times from here on mean that nothing is foreseen."""

Series = dict[str, np.ndarray]
"""Values of one FMU's outputs at the end of each step, by name."""


def outputs(fmu: str) -> list[str]:
    """What is compared, at the end of each step: every Real output."""
    variables = fmpy.read_model_description(fmu).modelVariables
    reals = (it for it in variables if it.causality == "output" and it.type in ("Real", "Float64") and not it.clocks)
    return [variable.name for variable in reals]


def is_fmi_3(fmu: str) -> bool:
    return fmpy.read_model_description(fmu).fmiVersion == "3.0"


def edited(fmu: str, folder: Path, edit: Callable[[bytes], bytes]) -> str:
    """A copy of an FMU, in the folder, with an edited description."""
    path = folder / Path(fmu).name
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(path, "w") as target:
        for entry in source.infolist():
            content = source.read(entry)
            target.writestr(entry, edit(content) if entry.filename == "modelDescription.xml" else content)
    return str(path)


def build_program(name: str, *arguments: str) -> Path:
    """Has Cargo build a program that does this job; returns its file."""
    command = ["cargo", "build", "--quiet", "--target-dir", harness.TARGET, *arguments]
    subprocess.run(command, cwd=harness.ROOT, check=True)
    return harness.TARGET / ("release" if "--release" in arguments else "debug") / name


def run_program(program: Path, fmus: dict[str, str], folder: Path) -> dict[str, Series]:
    """The series that a program writes, as tables with a row a step."""
    values = [f"{name}={value!r}" for name, value in START_VALUES.items()]
    subprocess.run([program, *(fmus[name] for name in FMUS), folder, repr(STEP), str(STEPS), *values], check=True)
    return {name: read_table(folder / f"{name}.csv") for name in FMUS}


def read_table(path: Path) -> Series:
    with open(path) as file:
        names = file.readline().strip().split(",")
        return dict(zip(names, np.loadtxt(file, delimiter=",").T))


def worst_difference(found: Series, expected: Series) -> float:
    """Largest difference of any output, relative to the largest value of that output."""
    return differences.worst(difference(found[name], values) for name, values in expected.items())


def difference(found: np.ndarray, expected: np.ndarray) -> float:
    if np.array_equal(found, expected):
        return 0.0
    foreseen = np.abs(expected) < NEVER
    if not np.array_equal(found[~foreseen], expected[~foreseen]):
        return np.inf
    return float(np.abs(found - expected)[foreseen].max() / np.abs(expected[foreseen]).max())
