"""The scripts beyond one machine, run as a user runs them."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import harness

VIDEG = harness.TARGET / "release" / "videg"

SWEEP = [
    *("--vary", "membrane.restitution=0.3:0.9:40", "--vary", "excitation.amplitude=0.4:0.6:10", "--samples", "4"),
    *("--until", "1500", "--window", "750,1500"),
]
"""What is swept: 1600 runs, a few seconds of one core, so that there is time to kill one that is half done."""

COUPLED = [
    *("--vary", "case=fig10,fig14,table3-2hz", "--vary", "zener.voltage=2200:2700:6", "--set", "topology=isolated"),
    *("--set", "excitation.phaseNoise=0.5", "--set", "excitation.noiseHold=1e-3", "--samples", "2", "--until", "4"),
]
"""A sweep of harvester and circuit over cases, of 36 runs."""

PRECISE = [
    *("--vary", "membrane.restitution=0.3:0.9:5", "--set", "excitation.phaseNoise=0.5", "--until", "4"),
    *("--set", "excitation.noiseHold=1e-3", "--until-precision", "0.01", "--samples", "120"),
]
"""A sweep whose points take as many samples as they need."""

RESULTS = ["sweep.csv", "sweep.parquet", "sweep.json", "statistics.csv", "statistics.svg"]
"""Of a sweep with several samples."""


@pytest.fixture
def start() -> Callable[..., subprocess.Popen]:
    """Starts a script of scale/ with arguments; what is left of it, processes and temporary files, ends with the test."""
    processes = []
    temporary = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)

    def begin(script: str, *arguments: object, **environment: str) -> subprocess.Popen:
        path = harness.ROOT / "scale" / script
        command = [sys.executable, path] if path.suffix == ".py" else [path]
        processes.append(
            subprocess.Popen(
                [*command, *map(str, arguments)],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env=os.environ | {"VIDEG": str(VIDEG), "TMPDIR": temporary.name} | environment,
                start_new_session=True,
            )
        )
        return processes[-1]

    with temporary:
        yield begin
        # What it started holds its pipes, too. Once it has been waited for, nothing does, and its number may be another's.
        left = [process for process in processes if process.returncode is None]
        for process in left:
            os.killpg(process.pid, signal.SIGKILL)
        for process in left:
            process.communicate(timeout=30)


@pytest.fixture
def run(start) -> Callable[..., subprocess.CompletedProcess]:
    """Runs a script to its end."""

    def complete(script: str, *arguments: object, **environment: str) -> subprocess.CompletedProcess:
        return end(start(script, *arguments, **environment))

    return complete


def end(process: subprocess.Popen) -> subprocess.CompletedProcess:
    """Waits for a script, which must not hang."""
    out, err = process.communicate(timeout=120)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def wait_for(condition: Callable[[], object]) -> object:
    """What `condition` says as soon as it says something."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        if found := condition():
            return found
        time.sleep(0.02)
    raise AssertionError("it never came to that")


@pytest.fixture(scope="session")
def undivided(tmp_path_factory) -> Path:
    """The folder of the sweep that one process runs."""
    folder = tmp_path_factory.mktemp("undivided")
    subprocess.run([VIDEG, "sweep", *SWEEP, "--output", folder], check=True, stdout=subprocess.DEVNULL)
    return folder


@pytest.fixture(scope="session")
def undivided_coupled(tmp_path_factory) -> Path:
    """The same of the sweep of harvester and circuit."""
    folder = tmp_path_factory.mktemp("undivided-coupled")
    subprocess.run([VIDEG, "sweep", *COUPLED, "--output", folder], check=True, stdout=subprocess.DEVNULL)
    return folder


@pytest.fixture(scope="session")
def undivided_precise(tmp_path_factory) -> Path:
    """The same of the sweep that takes samples until means are precise."""
    folder = tmp_path_factory.mktemp("undivided-precise")
    subprocess.run([VIDEG, "sweep", *PRECISE, "--output", folder], check=True, stdout=subprocess.DEVNULL)
    return folder


def same_bytes(folder: Path, expected: Path) -> bool:
    return all((folder / name).read_bytes() == (expected / name).read_bytes() for name in RESULTS)
