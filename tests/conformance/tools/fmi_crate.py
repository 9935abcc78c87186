"""The crate `fmi`, an importer in Rust. Its program also goes back half-way, from a saved and from a serialised state,
and fails unless the rest comes out the same to the last bit.

Built without optimisation: compiling takes far longer than running.
"""

import re
import tempfile
from pathlib import Path

import harness
import job
import rust_reader

NAME = "fmi (Rust)"
PROVES = "loads and runs both FMUs, goes back to saved and serialised states (FMI 2.0) to the last bit"
FMI_3 = True
MANIFEST = harness.ROOT / "tests" / "fmi-crate" / "Cargo.toml"

KNOWN = rust_reader.KNOWN


def version() -> str:
    return re.search(r'^fmi = .*version = "=([^"]*)"', MANIFEST.read_text(), re.MULTILINE).group(1)


def simulate(fmus: dict[str, str]) -> dict[str, job.Series]:
    is_fmi_3 = job.is_fmi_3(fmus[job.HARVESTER])
    name = "videg-fmi3-crate" if is_fmi_3 else "videg-fmi-crate"
    program = job.build_program(name, "--locked", "--manifest-path", str(MANIFEST))
    with tempfile.TemporaryDirectory() as folder:
        if is_fmi_3:
            fmus = {name: job.edited(fmu, Path(folder), rust_reader.without_units) for name, fmu in fmus.items()}
        return job.run_program(program, fmus, Path(folder))
