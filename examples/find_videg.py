"""Finds the FMUs and the command-line tool for the scripts in this folder. It compiles nothing."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FMUS = Path(os.environ.get("VIDEG_FMUS") or ROOT / "target" / "fmu")
RELEASE = Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target") / "release"

# A tool on the PATH comes before that of the source tree, which does not build the libraries anew.
os.environ["PATH"] = os.pathsep.join([os.environ.get("PATH", ""), str(RELEASE)])
os.environ["VIDEG_NO_BUILD"] = "1"


def find() -> str | None:
    """The command-line tool, or None."""
    return shutil.which("videg")


def fmu(name: str) -> str:
    """The FMU of this name in the folder VIDEG_FMUS, else in target/fmu, where the tool writes it if it is missing."""
    path = FMUS / f"{name}.fmu"
    if not path.is_file():
        need(f"there is no {path}, and videg", f"set VIDEG_FMUS to the folder of {path.name}, or ")
        run(f'videg fmu build --output "{FMUS}"')
    return str(path)


def run(command: str) -> None:
    """Run a shell command that calls the tool."""
    need("videg", "")
    ended = subprocess.run(command, shell=True).returncode
    if ended:
        sys.exit(f"{command}: exit code {ended}")


def need(what: str, other: str) -> None:
    """End the script, and say what to do, unless the tool is there."""
    if find() is None:
        way = "put the videg of a release on the PATH, or run `cargo run --release -- fmu build` in the source tree"
        sys.exit(f"{what} is neither on the PATH nor in {RELEASE}; {other}{way}")
