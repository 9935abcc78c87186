"""Runs of the harvester, alone and with a circuit."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _arguments, _videg
from ._arguments import Settings
from ._cases import fmu
from ._columns import Columns
from ._progress import bar

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas as pd

Array = npt.NDArray[np.float64]

# What is recorded if nothing is asked for: both capacitances, as `videg export` does.
CAPACITANCES = ("left.capacitance", "right.capacitance")


def recorded(names: str | Sequence[str] | None, argument: str = "record") -> list[str]:
    """Names of the columns beside the time."""
    chosen = list(CAPACITANCES) if names is None else _arguments.names(argument, names)
    return [name for name in chosen if name != "time"]


class Run(Columns):
    """Columns of a run by name, `time` (s) among them: one-dimensional arrays of the same length."""

    def __init__(self, columns: dict[str, Array], units: dict[str, str], summary: dict[str, Any]) -> None:
        super().__init__(columns)
        self.units = units
        """Unit of each column."""
        self.summary = summary
        """All scalar results, by the names that they have in `--json` of the command line."""

    def __repr__(self) -> str:
        rows = len(self.time)
        return f"<{type(self).__name__} of {self.summary['case']}: {rows} rows of {', '.join(self._columns)}>"

    @property
    def time(self) -> Array:
        """Times of the rows, s."""
        return self._columns["time"]

    @property
    def impacts(self) -> int:
        """Impacts of the run."""
        return int(self.summary["impacts"])

    @property
    def average_voltage_gain(self) -> float:
        """`<U>` of Eq. (15) over the averaging window, V/s."""
        return float(self.summary["average_voltage_gain"])

    @property
    def average_power_eq13(self) -> float:
        """P of Eq. (14) over the averaging window, W. It is half of what the supply gives, no gain."""
        return float(self.summary["average_power_eq13"])

    @property
    def warnings(self) -> list[str]:
        """What to know of the validity of the numbers."""
        return list(self.summary["warnings"])

    def to_dataframe(self) -> pd.DataFrame:
        """The columns as a DataFrame of pandas with the time as its index."""
        import pandas as pd

        others = {name: values for name, values in self._columns.items() if name != "time"}
        return pd.DataFrame(others, index=pd.Index(self.time, name="time"))

    def plot(
        self, columns: str | Sequence[str] | None = None, *, window: tuple[float, float] | None = None
    ) -> matplotlib.figure.Figure:
        """Draws columns over the time, one below the other.

        Args:
            columns: Names of columns; all if left out.
            window: First and last time shown, s; the whole run if left out.

        Returns:
            The figure of matplotlib, which must be installed.

        Raises:
            KeyError: A column that was not recorded.
            Error: There is nothing to draw.
        """
        import matplotlib.pyplot as plt

        chosen = [name for name in self if name != "time"] if columns is None else _arguments.names("columns", columns)
        if not chosen:
            raise _videg.Error("plot: there are no columns beside the time")
        shown = slice(None) if window is None else (self.time >= window[0]) & (self.time <= window[1])
        size = (7.0, 1.0 + 1.5 * len(chosen))
        figure, axes = plt.subplots(len(chosen), 1, sharex=True, squeeze=False, figsize=size, layout="constrained")
        for axis, name in zip(axes[:, 0], chosen, strict=True):
            axis.plot(self.time[shown], self[name][shown], linewidth=0.8)
            unit = self.units.get(name, "1")
            axis.set_ylabel(name if unit == "1" else f"{name}\n{unit}", fontsize="small")
        axes[-1, 0].set_xlabel("time, s")
        return figure


class Simulation(Run):
    """A run of the harvester alone."""


class Cosimulation(Run):
    """A run of harvester and circuit."""

    @property
    def net_power(self) -> float:
        """What a user gains over the averaging window, W: load - supply + the change of what the membranes store."""
        return float(self.summary["net_power"])

    @property
    def load_power(self) -> float:
        """Mean power into the load over the averaging window, W."""
        return float(self.summary["load_power"])

    @property
    def supply_power(self) -> float:
        """Mean power from the supply over the averaging window, W."""
        return float(self.summary["supply_power"])

    @property
    def energy(self) -> dict[str, float]:
        """Where the energies of the whole run went, J."""
        return dict(self.summary["energy"])

    @property
    def charge(self) -> dict[str, float]:
        """Charges of the whole run, C."""
        return dict(self.summary["charge"])

    @property
    def comparison(self) -> list[dict[str, Any]]:
        """The same for other circuits at the same C(t)."""
        return list(self.summary["comparison"])


def simulate(
    case: str | os.PathLike[str] | None = None,
    *,
    until: float | None = None,
    set: Settings | None = None,  # noqa: A002
    record: str | Sequence[str] | None = None,
    sample: float | None = None,
    knots: float | None = None,
    window: tuple[float, float] | None = None,
    progress: bool | None = False,
) -> Simulation:
    """Runs the harvester alone.

    Args:
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        until: End of the run, s; 100 if left out.
        set: Values of variables on top of those of the case, by name.
        record: Names of variables to record beside the time, but for texts; both capacitances if left out.
        sample: Distance of the rows, s, from 1e-7 to `until`; 1e-3, or the end of a shorter run, if left out. The last row is the end.
        knots: In place of `sample`, as few rows as straight lines between them need for this error of C(t), relative to the height of
            the largest pulse so far.
        window: Averaging window, s; 50 to 100, or the second half of a shorter run, if left out.
        progress: Whether to show a bar (tqdm); None: if stderr is a terminal.

    Returns:
        Columns by name, each of shape (rows,), and the averages.

    Raises:
        Error: No such case or variable; a value out of bounds; more than 2e7 values.
        KeyboardInterrupt: Ctrl-C.
    """
    run = _arguments.run(case, set, until, None, window)
    if run["until"] is not None and run["until"] > 0:
        # There is no communication step, whose default is too short for a very long run.
        run["step"] = run["until"] / 1000.0
    points = _arguments.points(sample, knots)
    with bar(progress, "simulate") as told:
        result = _videg.simulate(fmu(), run, recorded(record), points, told)
    columns, units, summary = result
    return Simulation(columns, units, json.loads(summary))


def cosim(
    case: str | os.PathLike[str] | None = None,
    *,
    until: float | None = None,
    set: Settings | None = None,  # noqa: A002
    record: str | Sequence[str] | None = None,
    sample: float | None = None,
    step: float | None = None,
    window: tuple[float, float] | None = None,
    circuit: str = "embedded",
    master: str = "gauss-seidel",
    adaptive: float | None = None,
    progress: bool | None = False,
) -> Cosimulation:
    """Runs the harvester with a harvesting circuit.

    Args:
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        until: End of the run, s; 100 if left out.
        set: Values of variables of harvester and circuit on top of those of the case, by name.
        record: Names of columns of the time series; all if left out.
        sample: Distance of the rows, s; some 10,000 rows if left out. Impacts and peaks of C(t) are rows, too.
        step: Communication step, s; 1e-3 if left out. The master also stops at impacts and peaks of C(t).
        window: Averaging window, s; 50 to 100, or the second half of a shorter run, if left out.
        circuit: What solves the circuit: embedded, or fmu.
        master: Signals that harvester and circuit exchange for a step: gauss-seidel, jacobi or plain.
        adaptive: Adapt the step so that the error of each signal within it stays below this fraction of its value.
        progress: Whether to show a bar (tqdm); None: if stderr is a terminal.

    Returns:
        Columns by name, each of shape (rows,); powers, energies and charges.

    Raises:
        Error: No such case, variable or column; a value out of bounds; more than 2e7 values.
        KeyboardInterrupt: Ctrl-C.
    """
    if circuit not in ("embedded", "fmu"):
        raise _videg.Error(f"circuit = {circuit!r:.80}: allowed are embedded, fmu; the command videg runs ngspice, too")
    circuit_fmu = fmu("HarvestingCircuit") if circuit == "fmu" else None
    run = _arguments.run(case, set, until, step, window)
    sampled = None if sample is None else _arguments.number("sample", sample)
    tolerance = None if adaptive is None else _arguments.number("adaptive", adaptive)
    columns = [] if record is None else _arguments.names("record", record) or ["time"]
    with bar(progress, "cosim") as told:
        result = _videg.cosim(fmu(), circuit_fmu, run, columns, sampled, (master, tolerance), told)
    return Cosimulation(result[0], result[1], json.loads(result[2]))
