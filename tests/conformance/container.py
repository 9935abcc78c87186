"""Containers of both FMUs, made by the FMU Manipulation Toolbox and run by FMPy."""

import json
import shutil
import subprocess
import sys
import tempfile
from importlib.metadata import version as version_of
from pathlib import Path

import fmpy
import numpy as np

import job

PROVES = "a container of both FMUs, with FMI {version} outside, runs in FMPy"
KNOWN = {
    "FMUContainer 'V": "the container logs its version as a warning",
    "Solver configure": "the container logs its progress as an error",
    "PARALLEL mode": "the container warns of its default mode",
}


def version() -> str:
    return version_of("fmu_manipulation_toolbox")


def make(fmus: dict[str, str], interface: int, folder: Path) -> str:
    """A container with the capacitances connected, all outputs and all parameters."""
    files = {name: Path(fmu).name for name, fmu in fmus.items()}
    source, sink = (files[name] for name in job.FMUS)
    description = {
        "name": "both.fmu",
        "auto_link": False,
        "auto_input": True,
        "auto_output": False,
        "auto_parameter": True,
        "step_size": job.STEP,
        "fmu": list(files.values()),
        "link": [[source, name, sink, name] for name in job.CONNECTED],
        "output": [[files[name], output, f"{name}.{output}"] for name in job.FMUS for output in job.outputs(fmus[name])],
    }
    (folder / "both.json").write_text(json.dumps(description))
    for fmu in fmus.values():
        shutil.copy(fmu, folder)
    command = [Path(sys.executable).parent / "fmucontainer", "-container", "both.json", "-fmi", str(interface)]
    made = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    container = folder / "both.fmu"
    if made.returncode != 0 or not container.exists():
        raise ValueError(made.stdout)
    assert fmpy.read_model_description(container).fmiVersion.startswith(str(interface))
    return str(container)


def simulate(fmus: dict[str, str], interface: int) -> dict[str, job.Series]:
    with tempfile.TemporaryDirectory() as folder:
        fmu = make(fmus, interface, Path(folder))
        start = {f"{job.HARVESTER.lower()}.{name}": value for name, value in job.START_VALUES.items()}
        outputs = {name: job.outputs(fmus[name]) for name in job.FMUS}
        result = fmpy.simulate_fmu(
            fmu,
            stop_time=job.STEP * job.STEPS,
            step_size=job.STEP,
            output_interval=job.STEP,
            start_values=start,
            output=[f"{name}.{output}" for name, names in outputs.items() for output in names],
        )
    rows = result[1:]
    return {name: {it: np.array(rows[f"{name}.{it}"]) for it in names} for name, names in outputs.items()}
