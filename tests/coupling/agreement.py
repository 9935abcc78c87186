"""The circuit as solver, as FMU, in ngspice and in a system package."""

from dataclasses import dataclass

import numpy as np

import differences
import harness
import system

STEP, STEPS = 1e-3, 5000

FMU = 1e-9
"""The same algorithms; how the end of a ramp of C(t) is rounded differs."""

CLOCK = 1e-9
"""The same algorithms; FMPy and Ecos add up their steps, which puts communication points off the grid by some 1e-12 s."""

DIODES = 1e-3
"""The diodes of ngspice are exponential and nearly ideal, and it takes time steps of its own."""


@dataclass
class Comparison:
    what: str
    reference: str
    bound: float
    reason: str
    worst: float

    @property
    def passed(self) -> bool:
        return self.worst <= self.bound

    def line(self) -> str:
        result = "passed" if self.passed else "FAILED"
        return f"{result}  {self.what} against {self.reference}: {self.worst:.1e} of {self.bound:.0e}"

    def row(self) -> str:
        result, worst = "agrees" if self.passed else "DIFFERS", differences.rounded(self.worst)
        return f"| {self.what} | {self.reference} | {result} | {self.bound:.0e} | {worst} | {self.reason} |\n"


def worst_difference(found: system.Series, expected: system.Series) -> float:
    """Largest difference of any series, relative to the largest value of that series; of an energy, to the largest energy."""
    largest = {name: float(np.abs(values).max()) for name, values in expected.items()}
    energy = max(value for name, value in largest.items() if name.endswith(".energy"))
    scale = {name: energy if name.endswith(".energy") else value for name, value in largest.items()}
    return differences.worst(np.abs(found[name] - values).max() / scale[name] for name, values in expected.items())


def compare() -> list[Comparison]:
    def cosim(circuit: str, master: str) -> system.Series:
        return system.videg(STEP, STEPS, "--circuit", circuit, master=master)

    package = harness.videg("ssp")["ssp"]
    embedded, plain = cosim("embedded", "gauss-seidel"), cosim("embedded", "plain")
    fmu, plain_fmu = "`--circuit fmu`", "`--circuit fmu --master plain`"
    rows = [
        (fmu, "`--circuit embedded`", FMU, "rounding", cosim("fmu", "gauss-seidel"), embedded),
        ("`--circuit ngspice`", "`--circuit embedded`", DIODES, "diodes", cosim("ngspice", "gauss-seidel"), embedded),
    ]
    connected = cosim("fmu", "plain")
    rows += [
        (plain_fmu, "`--circuit embedded --master plain`", FMU, "rounding", connected, plain),
        ("`Harvester.ssp` in FMPy", plain_fmu, CLOCK, "clock", system.fmpy_ssp(package, STEP, STEPS), connected),
        ("`Harvester.ssp` in Ecos", plain_fmu, CLOCK, "clock", system.ecos_ssp(package, STEP, STEPS), connected),
    ]
    return [
        Comparison(what, reference, bound, reason, worst_difference(found, expected))
        for what, reference, bound, reason, found, expected in rows
    ]


TEXT = """\
## Agreement

The table compares `videg cosim` with three solvers of the circuit, and the system package of `videg ssp` in two other tools, for
{seconds:g} s in steps of {step:g} s. It compares C(t), motion, voltages and energies at every point of the grid, relative to
their largest value (energies: to the largest energy).

| run | compared with | result | bound | largest difference | reason for the bound |
|---|---|---|---|---|---|
"""

REASONS = """
Rounding: the end of a ramp of C(t) is given as a value or as a rate. Clock: FMPy and Ecos add up their steps, so their
communication points are off the grid by some 1e-12 s. Diodes: those of ngspice are exponential and nearly ideal.

FMPy's master for system packages and that of Ecos pass on values once a step and know neither dC/dt nor impacts. The
circuit therefore follows C(t) with a delay of one step. `--master plain` does the same; the next section compares it with the other masters.
"""


def section(comparisons: list[Comparison]) -> str:
    rows = "".join(found.row() for found in comparisons)
    return TEXT.format(seconds=STEP * STEPS, step=STEP) + rows + REASONS
