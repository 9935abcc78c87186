"""VDMCheck, the standard's rules as a formal model, where its jar is at hand: the environment variable VDMCHECK_JAR names it."""

import os
import re
import shutil
import subprocess
from pathlib import Path

NAME = "VDMCheck"
PROVES = "the static semantics of FMI 2.0, as VDM-SL has them"
CLEAN = "No errors found"


def jar() -> Path | None:
    name = os.environ.get("VDMCHECK_JAR")
    return Path(name) if name else None


def is_available() -> bool:
    return jar() is not None and jar().exists() and shutil.which("java") is not None


def version() -> str:
    found = re.search(r"\d+(\.\d+)+", jar().name)
    return found.group() if found else "unknown"


def check(fmu: str) -> None:
    command = ["java", "-jar", jar(), fmu]
    run = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if run.returncode != 0 or CLEAN not in run.stdout:
        raise ValueError(run.stdout)
