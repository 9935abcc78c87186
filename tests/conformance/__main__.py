"""The conformance matrix: every tool on every FMU. Ends with 1 if one finds something to complain about.

    python tests/conformance
"""

import importlib
import re
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import numpy as np

import job
import record
from job import harness

CHECKERS = ("xsd", "fmpy_validate", "fmutool", "fmucheck", "fmi_sim")
REFERENCE = "videg"
IMPORTERS = (REFERENCE, "fmi_crate", "fmpy_master", "libcosim", "ecos")
"""The first is what the others are compared with."""

COMPLAINT = re.compile(r"warn|error|fatal|critical|fail|exception|assert", re.IGNORECASE)
PAGE = harness.ROOT / "docs" / "conformance.md"


def run(tool: str, folder: Path, *fmus: str) -> tuple[list[str], list[str], float]:
    """Runs a tool; returns its complaints, what it says about itself, and the seconds that it took."""
    started = time.monotonic()
    command = [sys.executable, Path(__file__).parent / "worker.py", tool, folder, *fmus]
    finished = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    seconds = time.monotonic() - started
    lines = finished.stdout.splitlines()
    complaints = lines if finished.returncode != 0 else [line for line in lines if COMPLAINT.search(line)]
    if finished.returncode != 0:
        complaints.append(f"ended with {finished.returncode}")
    table = getattr(importlib.import_module(f"tools.{tool}"), "KNOWN", {})
    known = [reason for words, reason in table.items() if any(words in line for line in complaints)]
    complaints = [line for line in complaints if not any(words in line for words in table)]
    return complaints, known, seconds


def describe(tool: str) -> dict:
    module = importlib.import_module(f"tools.{tool}")
    optional = hasattr(module, "is_available")
    return {"tool": module.NAME, "version": module.version(), "proves": module.PROVES, "optional": optional}


def is_available(tool: str) -> bool:
    return getattr(importlib.import_module(f"tools.{tool}"), "is_available", lambda: True)()


def break_fmu(fmu: str, folder: Path) -> str:
    """A copy of an FMU whose description lacks its GUID and the start value of its first input."""
    broken = folder / Path(fmu).name
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(broken, "w") as target:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename == "modelDescription.xml":
                content = re.sub(rb' guid="[^"]*"', b"", content, count=1)
                content = re.sub(rb'(causality="input".*?) start="[^"]*"', rb"\1", content, count=1, flags=re.DOTALL)
            target.writestr(entry, content)
    return str(broken)


def check(tool: str, fmus: dict[str, str], folder: Path) -> list[record.Record]:
    """What a checker finds. One that has nothing to say about a broken FMU is of no use."""
    records = []
    for name, fmu in fmus.items():
        complaints, known, seconds = run(tool, folder, fmu)
        if not run(tool, folder, break_fmu(fmu, folder))[0]:
            complaints.append("does not notice that the GUID and the start value of an input are missing")
        records.append(record.Record(**describe(tool), fmu=name, seconds=seconds, complaints=complaints, known=known))
    return records


def simulate(tool: str, fmus: dict[str, str], folder: Path, expected: dict[str, job.Series]) -> list[record.Record]:
    """What an importer makes of both FMUs, compared with the series expected of each, if any."""
    complaints, known, seconds = run(tool, folder, *fmus.values())
    records = []
    for name in fmus:
        found = record.Record(**describe(tool), fmu=name, seconds=seconds, complaints=complaints, known=known)
        if name in expected and not complaints:
            found.worst = job.worst_difference(np.load(folder / f"{name}.npz"), expected[name])
        records.append(found)
    return records


def importers(fmus: dict[str, str], folder: Path) -> list[record.Record]:
    """The first runs on its own, the others are compared with it."""
    expected, records = {}, []
    for tool in IMPORTERS:
        own = folder / tool
        own.mkdir()
        records += simulate(tool, fmus, own, expected)
        if tool == REFERENCE and all(found.passed for found in records):
            expected = {name: dict(np.load(own / f"{name}.npz")) for name in fmus}
    return records


def main() -> int:
    fmus = harness.build_fmus()
    records = []
    with tempfile.TemporaryDirectory() as folder:
        for tool in filter(is_available, CHECKERS):
            records += check(tool, fmus, Path(folder))
        records += importers(fmus, Path(folder))
    for found in records:
        print(found.line())
        for line in found.complaints:
            print(f"    {line}")
    outputs = sum(len(job.outputs(fmu)) for fmu in fmus.values())
    record.write(PAGE, record.table(records, seconds=job.STEP * job.STEPS, step=job.STEP, outputs=outputs))
    failed = sum(not found.passed for found in records)
    print(f"conformance: {len(records) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
