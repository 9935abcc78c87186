"""Many runs on all cores."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import _arguments, _videg
from ._arguments import Settings, Value
from ._cases import fmu
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
            resumed. If left out, the results are in memory only.
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

    if not isinstance(vary, Mapping):
        raise TypeError(f"vary = {vary!r:.80}: must be a dict from names to values, not of type {type(vary).__name__}")
    if jobs is not None and _arguments.integer("jobs", jobs) < 1:
        raise _videg.Error(f"jobs = {jobs}: must be at least 1")

    def optional(name: str, value: object) -> int | None:
        return None if value is None else _arguments.integer(name, value)

    asked = _arguments.run(case, set, until, step, window) | {
        "vary": [_vary(name, values) for name, values in vary.items()],
        "record": _arguments.names("record", record),
        "design": design,
        "points": optional("points", points),
        "samples": optional("samples", samples),
        "confidence": None if confidence is None else _arguments.number("confidence", confidence),
        "until_precision": None if until_precision is None else _arguments.number("until_precision", until_precision),
        "precision_of": precision_of,
        "seed": optional("seed", seed),
        "common_seeds": bool(common_seeds),
    }
    with tempfile.TemporaryDirectory(prefix="videg-sweep-") as temporary, bar(progress, "sweep") as told:
        folder = os.fspath(output) if output is not None else temporary
        if output is not None:
            os.makedirs(folder, exist_ok=True)
        done = json.loads(_videg.sweep(fmu(), asked, folder, jobs, bool(fresh), told))
        # From pandas 4 on, numbers keep their bits by themselves, and the argument is deprecated.
        exact = {"float_precision": "round_trip"} if int(pd.__version__.split(".")[0]) < 4 else {}
        results = pd.read_csv(done["files"][0], dtype={"error": "object"}, **exact)
    results.attrs = {key: done[key] for key in ("runs", "failed", "resumed_from")}
    if output is not None:
        results.attrs["files"] = done["files"]
    return results
