"""FMU Compliance Checker, where somebody has built it: it is not to be had ready-made."""

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import fmpy

NAME = "fmuCheck"
PROVES = "XML, order of calls, start values and an input file in each interface, by the checker of the Modelica Association"
LOADS = True


def is_available() -> bool:
    return shutil.which("fmuCheck") is not None


def version() -> str:
    run = subprocess.run(["fmuCheck"], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    found = re.search(r"FMI compliance checker\D*([\d.]+\w*)", run.stdout, re.IGNORECASE)
    return found.group(1) if found else "unknown"


def check(fmu: str) -> None:
    """Runs each interface that the FMU has: with its start values, and with inputs from a file."""
    with tempfile.TemporaryDirectory() as folder:
        inputs = Path(folder) / "inputs.csv"
        inputs.write_text(swinging_inputs(fmu))
        for options in ([], ["-i", inputs]):
            run([*options, fmu])


def swinging_inputs(fmu: str) -> str:
    """A line of names, and one for each point in time at which every input has moved a little."""
    inputs = [variable for variable in fmpy.read_model_description(fmu).modelVariables if variable.causality == "input"]
    lines = [",".join(["time", *(f'"{variable.name}"' for variable in inputs)])]
    for step in range(11):
        moved = (float(variable.start) * (1.0 + 0.01 * step) for variable in inputs)
        lines.append(",".join([str(0.1 * step), *map(repr, moved)]))
    return "\n".join(lines) + "\n"


def run(arguments: list) -> None:
    command = ["fmuCheck", "-h", "1e-2", "-s", "1", "-o", "/dev/null", *arguments]
    finished = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    counts = re.findall(r"(\d+) (?:warning|error)", finished.stdout, re.IGNORECASE)
    if finished.returncode != 0 or any(int(count) for count in counts):
        raise ValueError(finished.stdout)
