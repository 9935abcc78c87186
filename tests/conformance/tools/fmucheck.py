"""FMU Compliance Checker, where somebody has built it: it is not to be had ready-made."""

import re
import shutil
import subprocess

NAME = "fmuCheck"
PROVES = "XML, order of calls, start values in each interface, by the checker of the Modelica Association"


def is_available() -> bool:
    return shutil.which("fmuCheck") is not None


def version() -> str:
    run = subprocess.run(["fmuCheck"], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    found = re.search(r"FMI compliance checker\D*([\d.]+\w*)", run.stdout, re.IGNORECASE)
    return found.group(1) if found else "unknown"


def check(fmu: str) -> None:
    """Runs each interface that the FMU has."""
    command = ["fmuCheck", "-h", "1e-2", "-s", "1", "-o", "/dev/null", fmu]
    run = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    counts = re.findall(r"(\d+) (?:warning|error)", run.stdout, re.IGNORECASE)
    if run.returncode != 0 or any(int(count) for count in counts):
        raise ValueError(run.stdout)
