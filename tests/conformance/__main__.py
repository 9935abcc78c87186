"""The conformance matrix: every tool on every FMU. Ends with 1 if one finds something to complain about.

    python tests/conformance
"""

import importlib
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import job
import record
import recorded
from job import harness

CHECKERS = ("xsd", "fmpy_validate", "fmutool", "vdmcheck", "fmucheck", "fmi_sim", "strict_client", "casadi_exchange")
REFERENCE = "videg"
IMPORTERS = (REFERENCE, "fmi_crate", "fmpy_master", "libcosim", "ecos", "container2", "container3")
"""The first is what the others are compared with."""

FMI_3 = ", FMI 3.0"
"""What the page says of an FMU of FMI 3.0."""

COMPLAINT = re.compile(r"warn|error|fatal|critical|fail|exception|assert", re.IGNORECASE)
PAGE = harness.ROOT / "docs" / "conformance.md"


def run(tool: str, folder: Path, *fmus: str, calls: Path | None = None) -> tuple[list[str], list[str], float]:
    """Runs a tool; returns its complaints, what it says about itself, and the seconds that it took. Calls of recorded FMUs are
    written into the folder `calls`."""
    started = time.monotonic()
    command = [sys.executable, Path(__file__).parent / "worker.py", tool, folder, *fmus]
    environment = recorded.environment(calls) if calls else None
    finished = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment)
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
    version = module.version() if is_available(tool) else ""
    return {"tool": module.NAME, "version": version, "proves": module.PROVES, "optional": optional}


def is_available(tool: str) -> bool:
    return getattr(importlib.import_module(f"tools.{tool}"), "is_available", lambda: True)()


def loads(tool: str) -> bool:
    """Whether a checker calls the FMU's library."""
    return getattr(importlib.import_module(f"tools.{tool}"), "LOADS", False)


def broken(description: bytes) -> bytes:
    """The description without its GUID and the start value of its first input."""
    description = re.sub(rb' (guid|instantiationToken)="[^"]*"', b"", description, count=1)
    return re.sub(rb'(causality="input".*?) start="[^"]*"', rb"\1", description, count=1, flags=re.DOTALL)


def takes_fmi_3(tool: str) -> bool:
    return getattr(importlib.import_module(f"tools.{tool}"), "FMI_3", False)


def check(tool: str, fmus: dict[str, str], folder: Path, version: str = "") -> list[record.Record]:
    """What a checker finds. One that has nothing to say about a broken FMU is of no use. The calls of FMI 3.0 are not counted."""
    records = []
    for name, fmu in fmus.items():
        if not takes(tool, name):
            continue
        calls = None if version else folder / f"calls of {tool}, {name}"
        complaints, known, seconds = run(tool, folder, fmu, calls=calls)
        if not run(tool, folder, job.edited(fmu, folder, broken))[0]:
            complaints.append("does not notice that the GUID and the start value of an input are missing")
        label = name + version
        found = record.Record(**describe(tool), fmu=label, seconds=seconds, complaints=complaints, known=known)
        records.append(judge_calls(found, calls, name) if loads(tool) and calls else found)
    return records


def takes(tool: str, fmu: str) -> bool:
    """Whether a checker is for this FMU."""
    return fmu in getattr(importlib.import_module(f"tools.{tool}"), "FMUS", (fmu,))


def judge_calls(found: record.Record, folder: Path, fmu: str) -> record.Record:
    """Takes what the calls of a tool returned into its record."""
    calls = recorded.read(folder, fmu)
    found.complaints += recorded.others(calls) if calls else ["called nothing that was counted"]
    found.calls = recorded.summary(calls)
    return found


def simulate(
    tool: str, fmus: dict[str, str], folder: Path, expected: dict[str, job.Series], version: str = ""
) -> list[record.Record]:
    """What an importer makes of both FMUs, compared with the series expected of each, if any."""
    calls = None if version else folder / "calls"
    complaints, known, seconds = run(tool, folder, *fmus.values(), calls=calls)
    records = []
    for name in fmus:
        label = name + version
        found = record.Record(**describe(tool), fmu=label, seconds=seconds, complaints=list(complaints), known=known)
        if name in expected and not complaints:
            found.worst = job.worst_difference(np.load(folder / f"{name}.npz"), expected[name])
        records.append(judge_calls(found, calls, name) if calls else found)
    return records


def importers(fmus: dict[str, str], fmus3: dict[str, str], folder: Path) -> list[record.Record]:
    """The first runs on its own, the others are compared with it, those of FMI 3.0, too."""
    expected, records = {}, []
    for tool in IMPORTERS:
        own = folder / tool
        own.mkdir()
        records += simulate(tool, fmus, own, expected)
        if tool == REFERENCE and all(found.passed for found in records):
            expected = {name: dict(np.load(own / f"{name}.npz")) for name in fmus}
    for tool in filter(takes_fmi_3, IMPORTERS):
        own = folder / f"{tool} of FMI 3.0"
        own.mkdir()
        records += simulate(tool, fmus3, own, expected, FMI_3)
    return records


def main() -> int:
    fmus, fmus3 = harness.build_fmus(), harness.build_fmus("--fmi", "3")
    records = []
    with tempfile.TemporaryDirectory() as folder:
        recorder = recorded.build(Path(folder))
        (Path(folder) / "recorded").mkdir()
        wrapped = {name: recorded.wrap(fmu, recorder, Path(folder) / "recorded") for name, fmu in fmus.items()}
        for tool in CHECKERS:
            if is_available(tool):
                records += check(tool, wrapped if loads(tool) else fmus, Path(folder))
            else:
                print(f"skipped: {describe(tool)['tool']}, which is not at hand")
        for tool in filter(takes_fmi_3, filter(is_available, CHECKERS)):
            records += check(tool, fmus3, Path(folder), FMI_3)
        records += importers(wrapped, fmus3, Path(folder))
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
