"""Many runs on all cores."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _arguments, _videg
from ._arguments import Settings, Value
from ._cases import fmu
from ._columns import Columns
from ._progress import bar

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Range:
    """Numbers from one to another."""

    start: float
    """First or smallest."""
    stop: float
    """Last or largest."""
    count: int | None = None
    """How many, in a grid; None for the designs lhs and random."""
    log: bool = False
    """Whether ratios are equal, not differences."""

    def _text(self, name: str) -> str:
        ends = [_arguments.text(name, _arguments.number(name, end)) for end in (self.start, self.stop)]
        count = [] if self.count is None else [str(_arguments.integer(f"{name}: count", self.count))]
        return ("log:" if self.log else "") + ":".join([*ends, *count])


def _vary(name: object, values: object) -> str:
    if not isinstance(name, str):
        raise TypeError(f"vary: {name!r:.80} is no name of a variable, but of type {type(name).__name__}")
    if isinstance(values, Range):
        return f"{name}={values._text(name)}"
    if isinstance(values, str):
        return f"{name}={values}"
    if isinstance(values, Mapping) or not isinstance(values, Iterable):
        kind = type(values).__name__
        raise TypeError(f"vary: {name} = {values!r:.80}: must be values, a Range or a text, not of type {kind}")
    texts = [_arguments.text(name, value) for value in values]
    if not texts:
        raise _videg.Error(f"vary: {name}: there are no values")
    for value in texts:
        if "," in value or ":" in value:
            raise _videg.Error(f"vary: {name} = {value!r:.80}: values of a list have no commas and colons")
    return f"{name}={','.join(texts)}"


def _mapping(name: str, value: Any) -> Mapping[str, Any]:
    """Whatever has keys and values for them: a DataFrame, too."""
    if not (hasattr(value, "keys") and hasattr(value, "__getitem__")):
        raise TypeError(f"{name}: must be a dict from names to values, not of type {type(value).__name__}")
    return value


def _optional(name: str, value: object) -> int | None:
    return None if value is None else _arguments.integer(name, value)


def _jobs(value: object) -> int | None:
    jobs = _optional("jobs", value)
    if jobs == 0:
        raise _videg.Error("jobs = 0: must be at least 1")
    return jobs


def sweep(
    case: str | os.PathLike[str] | None = None,
    *,
    vary: Mapping[str, Sequence[Value] | Range | str],
    record: str | Sequence[str] = (),
    until: float | None = None,
    set: Settings | None = None,  # noqa: A002
    step: float | None = None,
    window: tuple[float, float] | None = None,
    design: str | None = None,
    points: int | None = None,
    samples: int | None = None,
    seed: int | None = None,
    common_seeds: bool = False,
    confidence: float | None = None,
    until_precision: float | None = None,
    precision_of: str | None = None,
    jobs: int | None = None,
    output: str | os.PathLike[str] | None = None,
    fresh: bool = False,
    progress: bool | None = None,
) -> pd.DataFrame:
    """Runs the harvester, with a circuit if one of its variables is named, many times; on all cores, without the interpreter's lock.

    Args:
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        vary: Values of each variable: a list or array, a `Range`, or a text as `--vary` of the command line takes it ("0.2:0.9:8").
        record: Variables to record at the end of each run, or net_power, load_power, supply_power over the window.
        until: End of a run, s; 100 if left out.
        set: Values of variables that are the same in all runs, by name.
        step: Communication step, s; from edge to edge of the window if left out.
        window: Averaging window, s; 50 to 100, or the second half of a shorter run, if left out.
        design: How points are chosen: grid (if left out), lhs or random.
        points: Number of points of lhs and random.
        samples: Runs of each point, each with its own noise; 1 if left out.
        seed: Seed of the design, and of the noise of the first run; 1 if left out.
        common_seeds: Whether sample i has the same seed in all points (common random numbers).
        confidence: Probability of the intervals of means in statistics.csv; 0.95 if left out.
        until_precision: Take samples until half the interval of a mean is at most this part of the mean.
        precision_of: The column whose mean that is.
        jobs: Most runs at once; one on each core if left out.
        output: Folder for the results, which the command `videg sweep` reads and goes on with, too: a sweep that was interrupted is
            resumed. If left out, a temporary folder, which is removed.
        fresh: Whether to replace the results in the folder.
        progress: Whether to show a bar (tqdm); None: if stderr is a terminal.

    Returns:
        A row for each run, as in sweep.csv; `attrs` has the number of runs, of failed ones (whose column `error` says why) and the files.

    Raises:
        Error: No such case or variable; a value out of bounds; results of another sweep in the folder.
        ImportError: pandas is not installed.
        KeyboardInterrupt: Ctrl-C; runs that have begun are finished, and with `output` their results stay.
    """
    import pandas as pd

    asked = _arguments.run(case, set, until, step, window) | {
        "vary": [_vary(name, vary[name]) for name in _mapping("vary", vary).keys()],
        "record": _arguments.names("record", record),
        "design": design,
        "points": _optional("points", points),
        "samples": _optional("samples", samples),
        "confidence": None if confidence is None else _arguments.number("confidence", confidence),
        "until_precision": None if until_precision is None else _arguments.number("until_precision", until_precision),
        "precision_of": precision_of,
        "seed": _optional("seed", seed),
        "common_seeds": bool(common_seeds),
    }
    with tempfile.TemporaryDirectory(prefix="videg-sweep-") as temporary, bar(progress, "sweep") as told:
        folder = os.fspath(output) if output is not None else temporary
        done = json.loads(_videg.sweep(fmu(), asked, folder, _jobs(jobs), bool(fresh), told))
        # From pandas 3 on, numbers keep their bits by themselves, and the argument is deprecated.
        exact: dict[str, Any] = {"float_precision": "round_trip"} if int(pd.__version__.split(".")[0]) < 3 else {}
        results = pd.read_csv(done["files"][0], dtype={"error": "object"}, **exact)
    results.attrs = {key: done[key] for key in ("runs", "failed", "resumed_from")}
    if output is not None:
        results.attrs["files"] = done["files"]
    return results


class Evaluation(Columns):
    """Results at points, by name: arrays of shape (points,), or (points, samples) if samples were asked for. NaN where a run failed."""

    def __init__(self, columns: dict[str, npt.NDArray[np.float64]], errors: dict[int, str] | dict[tuple[int, int], str]) -> None:
        super().__init__(columns)
        self.errors = errors
        """Place of each run that failed - the point, or point and sample if samples were asked for -, and why."""

    def __repr__(self) -> str:
        shape = next((values.shape for values in self._columns.values()), ())
        return f"<Evaluation of shape {shape}: {', '.join(self._columns)}; {len(self.errors)} runs failed>"


def evaluate(
    points: Mapping[str, npt.ArrayLike],
    case: str | os.PathLike[str] | None = None,
    *,
    record: str | Sequence[str] = (),
    until: float | None = None,
    set: Settings | None = None,  # noqa: A002
    step: float | None = None,
    window: tuple[float, float] | None = None,
    samples: int | None = None,
    seed: int | None = None,
    jobs: int | None = None,
    progress: bool | None = False,
) -> Evaluation:
    """Runs the harvester, with a circuit if one of its variables is named, at points of your choice: what an optimiser calls.

    Args:
        points: Values of each Real variable at the points, by name: arrays of the same length, or numbers for one point; a DataFrame, too.
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        record: Variables to record at the end of each run, or net_power, load_power, supply_power over the window.
        until: End of a run, s; 100 if left out.
        set: Values of variables that are the same in all runs, by name.
        step: Communication step, s; from edge to edge of the window if left out.
        window: Averaging window, s; 50 to 100, or the second half of a shorter run, if left out.
        samples: Runs at each point, each with its own noise; sample i has the same seed at all points (common random numbers).
        seed: Seed of the first sample; 1 if left out.
        jobs: Most runs at once; one on each core if left out.
        progress: Whether to show a bar (tqdm); None: if stderr is a terminal.

    Returns:
        Averages and what is recorded, by name, and the errors of runs that failed: a value out of bounds is one.

    Raises:
        Error: No such case or variable, or one that is not Real; points of different lengths.
        KeyboardInterrupt: Ctrl-C; runs that have begun are finished.
    """
    names = _arguments.names("points", list(_mapping("points", points).keys()))
    arrays = [_column(name, points[name]) for name in names]
    lengths = {name: len(array) for name, array in zip(names, arrays, strict=True)}
    if not names or len({*lengths.values()}) != 1 or 0 in lengths.values():
        said = ", ".join(f"{name} has {length}" for name, length in lengths.items()) or "there is no variable"
        raise _videg.Error(f"points: each variable needs as many values, at least one; {said}")
    rows = np.column_stack(arrays)
    asked = _arguments.run(case, set, until, step, window) | {
        "vary": [],
        "record": _arguments.names("record", record),
        "samples": _optional("samples", samples),
        "seed": _optional("seed", seed),
        "common_seeds": samples is not None,
    } | dict.fromkeys(("design", "points", "confidence", "until_precision", "precision_of"))
    with bar(progress, "evaluate") as told:
        columns, failed = _videg.evaluate(fmu(), asked, names, rows.tolist(), _jobs(jobs), told)
    if samples is None:
        return Evaluation(columns, dict(failed))
    columns = {name: values.reshape(len(rows), -1) for name, values in columns.items()}
    return Evaluation(columns, {divmod(run, int(samples)): why for run, why in failed})


def _column(name: str, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    array = np.asarray(values)
    if array.dtype.kind not in "fiu" or array.ndim > 1:
        kind = f"{array.ndim} dimensions and the type {array.dtype}"
        raise TypeError(f"points: {name}: must be a number or an array of numbers in one dimension, has {kind}")
    return np.atleast_1d(array.astype(np.float64))
