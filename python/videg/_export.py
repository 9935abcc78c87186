"""C(t) of a run for other programs."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass

from . import _arguments, _videg
from ._arguments import Settings
from ._cases import fmu
from ._progress import bar
from ._runs import recorded


@dataclass(frozen=True)
class Exported:
    """What was written."""

    files: list[str]
    """Paths of the files."""
    rows: int
    """Points of the table."""
    rest_capacitance: float
    """Capacitance of a flat membrane, F."""
    initial_capacitance: tuple[float, float]
    """Capacitances (left, right) at 0 s, F."""
    warnings: list[str]
    """What to know of it."""


def _write(
    path: str | os.PathLike[str], format: str, run: dict, points: tuple[str, float], columns: list[str], progress: bool | None
) -> Exported:
    with bar(progress, "export") as told:
        written = json.loads(_videg.export(fmu(), run, os.fspath(path), format, points, columns, told))
    left, right = written["initial_capacitance"]
    return Exported(written["files"], written["rows"], written["rest_capacitance"], (left, right), written["warnings"])


def netlist(
    path: str | os.PathLike[str],
    case: str | os.PathLike[str] | None = None,
    *,
    simulator: str = "ngspice",
    until: float | None = None,
    set: Settings | None = None,  # noqa: A002
    knots: float | None = None,
    sample: float | None = None,
    progress: bool | None = False,
) -> Exported:
    """Writes both membranes as subcircuits `deg_left` and `deg_right` with C(t), for a netlist of your own.

    Args:
        path: File to write; ngspice and KiCad get a table beside it.
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        simulator: What reads it: ngspice, ltspice, qspice or kicad.
        until: End of the run, s; 100 if left out.
        set: Values of variables on top of those of the case, by name.
        knots: Error of the straight lines between the points, relative to the height of the largest pulse so far; 1e-4 if left out.
        sample: In place of `knots`, distance of the points, s.
        progress: Whether to show a bar (tqdm); None: if stderr is a terminal.

    Raises:
        Error: No such case, variable or simulator; a value out of bounds; a file that cannot be written.
        KeyboardInterrupt: Ctrl-C.
    """
    simulators = ("ngspice", "ltspice", "qspice", "kicad")
    if simulator not in simulators:
        raise _videg.Error(f"simulator = {simulator!r:.80}: allowed are {', '.join(simulators)}")
    points = _arguments.points(sample, knots, ("knots", 1e-4))
    return _write(path, simulator, _arguments.run(case, set, until, None, None), points, [], progress)


def export(
    path: str | os.PathLike[str],
    case: str | os.PathLike[str] | None = None,
    *,
    format: str = "csv",  # noqa: A002
    until: float | None = None,
    set: Settings | None = None,  # noqa: A002
    columns: str | Sequence[str] | None = None,
    sample: float | None = None,
    knots: float | None = None,
    progress: bool | None = False,
) -> Exported:
    """Writes variables of the harvester as a table.

    Args:
        path: File to write.
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        format: csv, parquet or mat.
        until: End of the run, s; 100 if left out.
        set: Values of variables on top of those of the case, by name.
        columns: Names of variables beside the time; both capacitances if left out.
        sample: Distance of the rows, s; 1e-3, or the end of a shorter run, if left out.
        knots: In place of `sample`, as few rows as straight lines between them need for this error of C(t).
        progress: Whether to show a bar (tqdm); None: if stderr is a terminal.

    Raises:
        Error: No such case, variable or format; a value out of bounds; a file that cannot be written.
        KeyboardInterrupt: Ctrl-C.
    """
    formats = ("csv", "parquet", "mat")
    if format not in formats:
        raise _videg.Error(f"format = {format!r:.80}: allowed are {', '.join(formats)}; netlist writes those of simulators")
    points = _arguments.points(sample, knots)
    run = _arguments.run(case, set, until, None, None)
    return _write(path, format, run, points, recorded(columns, "columns"), progress)
