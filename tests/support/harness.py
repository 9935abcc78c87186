"""What the Python tests share: the command-line tool, the FMUs, and the paper's Fig. 14."""

import json
import math
import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")

VIDEG = [os.environ["VIDEG"]] if "VIDEG" in os.environ else ["cargo", "run", "--quiet", "--release", "--"]
"""The command-line tool: that of the environment, or that of this tree."""


def videg(*arguments: str) -> dict:
    """Run the command-line tool with --json and return the object that it prints."""
    run = subprocess.run([*VIDEG, *arguments, "--json"], cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True)
    return json.loads(run.stdout)


def example(name: str) -> Path:
    """The program of an example of this tree, built as the tests are: by itself, its dependencies would get other features, and Cargo
    would compile them again."""
    subprocess.run(["cargo", "build", "--quiet", "--workspace", "--example", name], cwd=ROOT, check=True)
    return TARGET / "debug" / "examples" / name


def build_fmus(*options: str) -> dict[str, str]:
    """Package the FMUs; return their files by model identifier."""
    files = videg("fmu", "build", *options)["fmus"]
    return {Path(file).stem: file for file in files}


def fig14() -> dict[str, float]:
    """Start values of Fig. 14 (Section 4.2): the parameters are the defaults, the motion starts as the saw-tooth does.

    Evaluated in the order of model/src/cases.rs, so that even the last bit is the same.
    """
    amplitude, frequency, cylinder_mass = 0.5, 2.0, 0.1245
    travel = 0.042 + 2.0 * 0.006 - 2.0 * 0.005
    omega = math.tau * frequency
    cylinder_position = -(amplitude / (cylinder_mass * omega * omega))
    ball_position = cylinder_position + travel / 2.0
    return {
        "initial.cylinderPosition": cylinder_position,
        "initial.ballPosition": ball_position,
        "initial.ballVelocity": -4.0 * frequency * ball_position,
    }
