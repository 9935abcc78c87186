"""FMU Manipulation Toolbox: generic and semantic checks of the archive."""

import re
import subprocess
import sys
from importlib.metadata import version as version_of
from pathlib import Path

NAME = "fmutool"
PROVES = "archive, XML and semantic rules, by another implementation"
FMI_3 = True
COMPLIANT = re.compile(
    r"This FMU seems to be compliant with FMI-([23])\.0.*No semantic error against the FMI-\1 standard", re.DOTALL
)


def version() -> str:
    return version_of("fmu_manipulation_toolbox")


def check(fmu: str) -> None:
    command = [Path(sys.executable).parent / "fmutool", "-input", fmu, "-check"]
    run = subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    # It ends with 0 even if it finds something.
    found = [line for line in run.stdout.splitlines() if not line.startswith("INFO")]
    if found or not COMPLIANT.search(run.stdout):
        raise ValueError(run.stdout)
