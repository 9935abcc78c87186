"""videg's own importer, with the same fixed-step master as the others."""

import re
import tempfile
from pathlib import Path

import harness
import job

NAME = "videg"
PROVES = "loads and runs both FMUs: the reference for the other importers"


def version() -> str:
    return re.search(r'^version = "(.*)"', (harness.ROOT / "Cargo.toml").read_text(), re.MULTILINE).group(1)


def simulate(fmus: dict[str, str]) -> dict[str, job.Series]:
    program = job.build_program("videg-fixed-step", "--release", "--package", "videg-fixed-step")
    with tempfile.TemporaryDirectory() as folder:
        return job.run_program(program, fmus, Path(folder))
