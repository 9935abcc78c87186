"""Harvester and circuit to step by yourself: a master of your own."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt

from . import _arguments, _videg
from ._arguments import Settings, Value
from ._cases import fmu

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class State:
    """A state of an instance, which any other instance of the same FMU can go on from, in this process or another."""

    time: float
    """s."""
    data: bytes
    """The serialised state of the FMU."""


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU."""

    name: str
    type: str
    """Real, Integer, Boolean, String or Enumeration."""
    causality: str
    variability: str
    unit: str | None
    description: str | None


class Instance:
    """An instance of an FMU, initialised at 0 s. One thread at a time can use it, in the process that made it."""

    def __init__(self, instance: _videg.Instance) -> None:
        self._own = instance
        self._process = os.getpid()

    @property
    def _instance(self) -> _videg.Instance:
        if self._process != os.getpid():
            raise _videg.Error(f"{type(self).__name__}: it belongs to the process that made it; save() gives a state for others")
        return self._own

    @property
    def time(self) -> float:
        """The time reached, s."""
        return self._instance.time

    def step(self, step: float) -> None:
        """Steps by `step`, s. Ctrl-C ends a long step on its way, at the time that `time` says.

        Raises:
            Error: No time above 0; what the model says of its inputs.
        """
        self._instance.step(_arguments.number("step", step))

    def __getitem__(self, name: str) -> float | int | bool | str:
        """The present value of a variable; an item of an enumeration is its name."""
        return self._instance.get(_arguments.names("name", [name])[0])

    # It is no sequence.
    __iter__ = None

    def __contains__(self, name: object) -> bool:
        return name in self.variables()

    def __setitem__(self, name: str, value: Value) -> None:
        """Sets an input, or a parameter that can change."""
        self._instance.set(_arguments.names("name", [name])[0], _arguments.text(name, value))

    def get(self, names: str | Sequence[str]) -> Array:
        """The present values of Real variables as an array, shape (names,)."""
        return self._instance.reals(_arguments.names("names", names))

    def rates(self, names: str | Sequence[str]) -> Array:
        """The time derivatives of Real outputs, shape (names,)."""
        return self._instance.rates(_arguments.names("names", names))

    def set_rates(self, rates: Mapping[str, float]) -> None:
        """Lets Real inputs change at these rates over the next step."""
        names = _arguments.names("rates", list(rates))
        self._instance.set_rates(names, [_arguments.number(name, rates[name]) for name in names])

    def derivative(self, of: str | Sequence[str], by: str | Sequence[str]) -> Array:
        """Derivatives of Real variables by others, as the FMU tells them (`fmi2GetDirectionalDerivative`). A step of more than 150 s is
        made in pieces of 100 s, of which the last counts here.

        Args:
            of: Names of outputs at the end of the last step.
            by: Names of inputs that were constant during it.

        Raises:
            Error: No such variable; the circuit, which tells none.

        Returns:
            Shape (of, by).
        """
        unknowns, knowns = _arguments.names("of", of), _arguments.names("by", by)
        columns = [self._instance.derivative(unknowns, [known], [1.0]) for known in knowns]
        return np.column_stack(columns) if columns else np.empty((len(unknowns), 0))

    def save(self) -> State:
        """The present state."""
        time, data = self._instance.save()
        return State(time, bytes(data))

    def restore(self, state: State) -> None:
        """Goes back, or on, to a state.

        Raises:
            Error: Bytes that are no state of this FMU.
        """
        if not isinstance(state, State):
            raise TypeError(f"state: must be what save returned, not of type {type(state).__name__}")
        self._instance.restore(_arguments.number("state.time", state.time), state.data)

    def variables(self) -> dict[str, Variable]:
        """All variables by name."""
        return {it[0]: Variable(*it) for it in self._instance.variables()}

    def messages(self) -> list[str]:
        """What the FMU has said: warnings and errors."""
        return self._instance.messages()

    def close(self) -> None:
        """Frees the instance. Whatever is asked of it then raises an error."""
        self._instance.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __reduce__(self) -> str:
        raise TypeError(f"{type(self).__name__} cannot be pickled; save() gives a state that can")


class Harvester(Instance):
    """The harvester, initialised at 0 s.

    Args:
        case: Name of a published case, or path of a case file (TOML); fig14 if left out.
        set: Values of variables on top of those of the case, by name.

    Raises:
        Error: No such case or variable; a value out of bounds.
    """

    def __init__(self, case: str | os.PathLike[str] | None = None, *, set: Settings | None = None) -> None:  # noqa: A002
        super().__init__(_videg.Instance.harvester(fmu(), _arguments.run(case, set, None, None, None)))


class Circuit(Instance):
    """The harvesting circuit, initialised at 0 s.

    Args:
        set: Values of its variables, by name: `left.capacitance` and `right.capacitance`, F, at 0 s among them.

    Raises:
        Error: No such variable; a value out of bounds.
    """

    def __init__(self, *, set: Settings | None = None) -> None:  # noqa: A002
        _arguments.settings("set", set)
        values = [(name, _arguments.text(name, value)) for name, value in (set or {}).items()]
        super().__init__(_videg.Instance.circuit(fmu("HarvestingCircuit"), values))
