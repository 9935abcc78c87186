"""What the tests of the installed package share. They need no source tree: the stage runs them where no Rust is."""

import json
import random
import subprocess
from pathlib import Path
from typing import Any

import pytest
import videg

SEED = 20250101


@pytest.fixture
def command(tmp_path: Path):
    """Runs the command-line tool of the package in a folder of its own; what it prints as JSON."""

    def run(*arguments: str) -> Any:
        json_option = [] if arguments[0] == "cases" else ["--json"]
        arguments = [videg.program(), *arguments, *json_option]
        done = subprocess.run(arguments, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


# Ranges of parameters that users change.
RANGES = {
    "membrane.restitution": (0.1, 0.95),
    "membrane.stiffness": (5e4, 1e6),
    "excitation.amplitude": (0.2, 3.0),
    "excitation.frequency": (1.0, 8.0),
    "excitation.phaseNoise": (0.0, 2.0),
    "ball.mass": (1e-3, 5e-3),
    "biasVoltage": (500.0, 3000.0),
}


def draws(count: int) -> list[dict[str, float]]:
    """Random parameters of the harvester, the same in each run of the tests."""
    source = random.Random(SEED)
    names = sorted(videg.start_values())
    assert all(name in names for name in RANGES), [name for name in RANGES if name not in names]
    return [
        {name: source.uniform(*RANGES[name]) for name in source.sample(sorted(RANGES), 4)} | {"excitation.seed": k + 1}
        for k in range(count)
    ]


def options(settings: dict[str, Any]) -> list[str]:
    """The settings as options of the command line."""
    return [part for name, value in settings.items() for part in ("--set", f"{name}={value}")]
