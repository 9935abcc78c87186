"""What is published, and what the package brings."""

from __future__ import annotations

import atexit
import json
import multiprocessing.util
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from . import _arguments, _videg
from ._arguments import Settings



def _close_at_end(_: object = None) -> None:
    """Removes the folder in which the FMUs are unpacked at the end of the process; those of multiprocessing end without atexit."""
    multiprocessing.util.Finalize(None, _videg.close, exitpriority=0)


atexit.register(_videg.close)
_close_at_end()
multiprocessing.util.register_after_fork(_videg, _close_at_end)

_FOLDER = Path(__file__).parent
_FMUS = ("VibroImpactHarvester", "HarvestingCircuit")


@dataclass(frozen=True)
class Case:
    """A published case."""

    name: str
    description: str
    source: str
    paper_voltage_gain: float | None
    """`<U>` as the paper prints it, V/s."""
    paper_power: float | None
    """P as the paper prints it, W."""


@dataclass(frozen=True)
class StartValue:
    """A parameter of the harvester with its value in a case."""

    name: str
    value: float | int | bool | str
    """An item of an enumeration is its name."""
    fmi: float | int | bool | str
    """The same as FMI tools take it: an item of an enumeration is its number."""
    unit: str | None
    description: str


def cases() -> list[Case]:
    """The published cases: figures and tables of the paper, and the inclined capsule of later papers."""
    return [Case(**case) for case in json.loads(_videg.cases())]


def start_values(
    case: str | os.PathLike[str] | None = None,
    *,
    set: Settings | None = None,  # noqa: A002
) -> dict[str, StartValue]:
    """All parameters of the harvester in a case, by name.

    `{name: it.fmi for name, it in videg.start_values("fig14").items()}` are the `start_values` of FMPy.

    Args:
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        set: Values of variables on top of those of the case, by name.

    Raises:
        Error: No such case; a value that its variable cannot have.
    """
    values = _videg.start_values(_arguments.run(case, set, None, None, None))
    return {value[0]: StartValue(*value) for value in values}


def fmu(name: str = "VibroImpactHarvester") -> str:
    """Path of an FMU that the package brings, for FMPy and other tools: FMI 2.0, co-simulation and model exchange.

    Args:
        name: VibroImpactHarvester or HarvestingCircuit.

    Raises:
        Error: The package has no such FMU.
    """
    if name not in _FMUS:
        raise _videg.Error(f"name = {name!r:.80}: there are {' and '.join(_FMUS)}")
    return str(_FOLDER / "fmus" / f"{name}.fmu")


def ssp() -> str:
    """Path of the system package (SSP 1.0) that the package brings: both FMUs, connected, with the parameters of Fig. 14."""
    return str(_FOLDER / "fmus" / "Harvester.ssp")


def program() -> str:
    """Path of the command-line tool that the package brings."""
    return str(_FOLDER / "bin" / ("videg.exe" if sys.platform == "win32" else "videg"))


def main() -> None:
    """The command `videg`: hands over to the command-line tool."""
    path, arguments = program(), sys.argv[1:]
    if sys.platform == "win32":
        import subprocess

        sys.exit(subprocess.call([path, *arguments]))
    os.execv(path, ["videg", *arguments])
