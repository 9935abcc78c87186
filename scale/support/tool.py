"""What the scripts beyond one machine share: the command-line tool, and errors as one line with exit code 2."""

import importlib
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import NoReturn

ROOT = Path(__file__).resolve().parents[2]


class Problem(Exception):
    """Why a script cannot run: names the thing, the value and the bound."""

    at_once = False
    """Whether the process is to end without giving libraries, which hang, the word."""


def main(run: Callable[[], int]) -> None:
    """Run a script and end it: with its exit code, or with 2 and one line on stderr."""
    try:
        code = run()
    except Problem as problem:
        if problem.at_once:
            tell(problem)
            sys.stderr.flush()
            os._exit(2)
        give_up(problem)
    except OSError as error:
        give_up(error)
    sys.exit(code)


def give_up(reason: object) -> NoReturn:
    tell(reason)
    sys.exit(2)


def tell(reason: object) -> None:
    print(f"{Path(sys.argv[0]).name}: {reason}", file=sys.stderr)


def need(module: str) -> ModuleType:
    """The Python module; without it the script ends, and says how to get it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        give_up(f"{module}: {error}; pip install -r scale/requirements.txt")


def find_videg(given: str | None) -> str:
    """The command-line tool: as given, or the environment's VIDEG, or that of the PATH, or that of the source tree."""
    wanted = given or os.environ.get("VIDEG")
    if wanted:
        found = shutil.which(wanted)
        if found is None:
            raise Problem(f"videg: {wanted} is not there or cannot be run")
        return str(Path(found).resolve())
    built = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "videg"
    found = shutil.which("videg") or shutil.which(built)
    if found is None:
        raise Problem(f"videg is neither on the PATH nor at {built}; cargo build --release makes it")
    return str(Path(found).resolve())


def videg(program: str, *arguments: str) -> str:
    """What the command-line tool prints on stdout; what it says on stderr is told if it could not run."""
    run = subprocess.run([program, *arguments], capture_output=True, text=True)
    if run.returncode not in (0, 1):  # 1: a check failed, which what it prints tells as well.
        complaint = run.stderr.strip() or f"exit code {run.returncode}"
        raise Problem(f"{' '.join(['videg', *arguments[:1]])}: {complaint}")
    return run.stdout
