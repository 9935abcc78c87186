"""FMU Manipulation Toolbox: generic and semantic checks of the archive."""

import subprocess
import sys
from importlib.metadata import version as version_of
from pathlib import Path

NAME = "fmutool"
PROVES = "archive, XML and semantic rules, by another implementation"
COMPLIANT = ("This FMU seems to be compliant with FMI-2.0", "No semantic error against the FMI-2 standard")


def version() -> str:
    return version_of("fmu_manipulation_toolbox")


def check(fmu: str) -> None:
    command = [Path(sys.executable).parent / "fmutool", "-input", fmu, "-check"]
    run = subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    # It ends with 0 even if it finds something.
    found = [line for line in run.stdout.splitlines() if not line.startswith("INFO")]
    missing = [words for words in COMPLIANT if words not in run.stdout]
    if found or missing:
        raise ValueError(run.stdout)
