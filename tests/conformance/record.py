"""What was found about one FMU with one tool, and the table of all that."""

from dataclasses import dataclass, field
from pathlib import Path

import differences

BOUND = 1e-9
"""Largest difference that passes, relative to the largest value of an output."""


@dataclass
class Record:
    tool: str
    version: str
    proves: str
    fmu: str
    seconds: float
    complaints: list[str]
    known: list[str] = field(default_factory=list)
    worst: float | None = None
    calls: str = ""
    optional: bool = False

    @property
    def passed(self) -> bool:
        return not self.complaints and (self.worst is None or self.worst <= BOUND)

    def difference(self) -> str:
        """The worst difference, as the page has it."""
        return "" if self.worst is None else differences.rounded(self.worst)

    def line(self) -> str:
        """A line for the terminal."""
        worst = "" if self.worst is None else f", worst difference {self.worst:.1e}"
        result = "passed" if self.passed else "FAILED"
        return f"{result}  {self.tool} {self.version}, {self.fmu}{worst}, {self.seconds:.1f} s"


HEADER = """\
# Conformance of the FMUs

Written by `./test.sh conformance`; do not edit. Checkers must report no error and no warning, and must
detect a broken FMU. Importers run the paper's Fig. 14 for {seconds:g} s in steps of {step:g} s, with the capacitances
of the harvester connected to the circuit. At every communication point each of the {outputs} outputs must agree with
videg's own importer within {bound:.0e} of its largest value. One column has the largest difference.

A library between tool and FMU of FMI 2.0 counts the return values of all calls; any value except `fmi2OK` fails the tool. The
last column has these values and the number of different functions.

`tests/fmpy/test_recording.py` sets the String parameter `excitation.file` in FMPy, libcosim and Ecos and compares their runs.

| tool | version | what the test shows | FMU | result | worst difference | status of each call |
|---|---|---|---|---|---|---|
"""


def table(records: list[Record], **facts) -> str:
    """The page: the same on every machine, so optional tools are not on it."""
    text = HEADER.format(bound=BOUND, **facts)
    shown = [record for record in records if not record.optional]
    for record in shown:
        result = "passed" if record.passed else "failed"
        cells = [record.tool, record.version, record.proves, record.fmu, result, record.difference(), record.calls]
        text += f"| {' | '.join(cells)} |\n"
    known = sorted({f"- {record.tool}: {reason}." for record in shown for reason in record.known})
    if known:
        text += "\nMessages of tools about themselves, not about the FMUs:\n\n" + "\n".join(known) + "\n"
    return text


def write(path: Path, text: str) -> None:
    """Writes the page if it says something new."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
        print(f"{path} has changed: commit it if that is right")
