"""The job that every importer does: the paper's Fig. 14, the harvester connected with the circuit."""

import csv
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harness  # noqa: E402

HARVESTER, CIRCUIT = "VibroImpactHarvester", "HarvestingCircuit"
FMUS = (HARVESTER, CIRCUIT)

STEP, STEPS = 1e-3, 10_000
START_VALUES = harness.fig14()
CONNECTED = ("left.capacitance", "right.capacitance")
"""Outputs of the harvester and inputs of the circuit. The values at the start of a step go in, as in any fixed-step
master (Jacobi)."""

OUTPUTS = {
    HARVESTER: ("gain.voltage", "left.capacitance", "right.capacitance", "ball.position"),
    CIRCUIT: ("left.voltage", "load.energy", "zener.energy", "supply.energy"),
}
"""What is compared, at the end of each step."""

Series = dict[str, np.ndarray]
"""Values of one FMU's outputs at the end of each step, by name."""


def command_line_series(folder: Path) -> Series:
    """The harvester as the command-line tool runs it, at the points of the grid."""
    arguments = ["--case", "fig14", "--until", repr(STEP * STEPS), "--step", repr(STEP), "--output", str(folder)]
    harness.videg("simulate", *arguments)
    with open(folder / "timeseries.csv", newline="") as file:
        rows = {float(row["time"]): row for row in csv.DictReader(file)}
    grid = [rows[index * STEP] for index in range(1, STEPS + 1)]
    return {name: np.array([float(row[name]) for row in grid]) for name in OUTPUTS[HARVESTER]}


def worst_difference(found: Series, expected: Series) -> float:
    """Largest difference of any output, relative to the largest value of that output."""
    differences = [np.abs(found[name] - values).max() / np.abs(values).max() for name, values in expected.items()]
    return float(np.max(differences))
