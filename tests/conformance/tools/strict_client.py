"""Our own client in C, to which anything but fmi2OK is a failure and which traps floating-point exceptions."""

import sys
import tempfile
from pathlib import Path

import harness

sys.path.insert(0, str(harness.ROOT / "tests" / "c"))

NAME = "strict client in C"
PROVES = "all ordinary sequences of both interfaces, everything read everywhere, no floating-point exception"
LOADS = True


def version() -> str:
    return "own"


def check(fmu: str) -> None:
    import strict

    with tempfile.TemporaryDirectory() as folder:
        code, lines = strict.run(fmu, Path(folder))
    if code != 0:
        raise ValueError("\n".join(lines))
