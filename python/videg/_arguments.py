"""Arguments as the extension module takes them: values as text, times as numbers."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from . import _videg

# What a variable can be set to.
Value = float | int | bool | str | os.PathLike[str] | np.generic
Settings = Mapping[str, Value]


def text(name: str, value: object) -> str:
    """The value of `name` as a user types it: a number keeps all its bits."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, int | np.integer):
        if not -(2**63) <= value < 2**63:
            raise _videg.Error(f"{name}: an integer of more than 64 bits")
        return str(int(value))
    if isinstance(value, float | np.floating):
        return repr(float(value))
    if isinstance(value, str | os.PathLike):
        return _unicode(name, os.fspath(value))
    kind = type(value).__name__
    raise TypeError(f"{name} = {value!r:.80}: must be a number, a truth value or a text, not of type {kind}")


def _unicode(name: str, value: object) -> str:
    """`value` if it is text that UTF-8 can write."""
    try:
        if isinstance(value, str) and value.encode():
            return value
    except UnicodeEncodeError:
        pass
    if value == "":
        return ""
    raise TypeError(f"{name} = {value!a:.80}: must be a text of Unicode characters")


def number(name: str, value: object) -> float:
    """`value` as a number."""
    if isinstance(value, bool | np.bool_ | str | bytes) or value is None:
        raise TypeError(f"{name} = {value!r:.80}: must be a number, not of type {type(value).__name__}")
    try:
        return float(value)  # type: ignore[arg-type]
    except OverflowError:
        raise _videg.Error(f"{name}: a number that is too large") from None
    except (TypeError, ValueError) as cause:
        raise TypeError(f"{name} = {value!r:.80}: must be a number, not of type {type(value).__name__}") from cause


def integer(name: str, value: object, least: int = 0) -> int:
    """`value` as a whole number that fits into 64 bits."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name} = {value!r:.80}: must be a whole number, not of type {type(value).__name__}")
    if not least <= value < 2**63:
        said = f" = {value}" if -(2**64) < value < 2**64 else ""
        raise _videg.Error(f"{name}{said}: must lie from {least} to 2^63 - 1")
    return int(value)


def names(name: str, value: object) -> list[str]:
    """`value` as a list of names; one name alone is a list of it."""
    if isinstance(value, str):
        return [value]
    if not isinstance(value, Iterable):
        raise TypeError(f"{name} = {value!r:.80}: must be names of variables, not of type {type(value).__name__}")
    found = list(value)
    for item in found:
        if not isinstance(item, str):
            raise TypeError(f"{name}: {item!r:.80} is no name of a variable, but of type {type(item).__name__}")
        _unicode(name, item)
    return found


def settings(name: str, value: object) -> list[str]:
    """`value` as texts of the form `variable=value`."""
    if value is None:
        return []
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} = {value!r:.80}: must be a dict from names to values, not of type {type(value).__name__}")
    for key in value:
        if not isinstance(key, str):
            raise TypeError(f"{name}: {key!r:.80} is no name of a variable, but of type {type(key).__name__}")
        _unicode(name, key)
    return [f"{key}={text(key, item)}" for key, item in value.items()]


def _pair(name: str, value: object) -> list[float]:
    if isinstance(value, str) or not isinstance(value, Iterable) or len(found := list(value)) != 2:
        raise TypeError(f"{name} = {value!r:.80}: must be two times")
    return [number(name, item) for item in found]


def run(
    case: object,
    set: object,  # noqa: A002 - named as the option is
    until: object,
    step: object,
    window: object,
) -> dict[str, Any]:
    """A run as the extension module takes it. A case that is a path, or ends with `.toml`, is a case file."""
    if not isinstance(case, str | os.PathLike | None):
        raise TypeError(f"case = {case!r:.80}: must be a name or a path, not of type {type(case).__name__}")
    if case is not None:
        _unicode("case", os.fspath(case))
    is_file = isinstance(case, os.PathLike) or (isinstance(case, str) and case.endswith(".toml"))
    return {
        "case": None if is_file else case,
        "case_file": os.fspath(case) if is_file else None,  # type: ignore[arg-type]
        "settings": settings("set", set),
        "until": None if until is None else number("until", until),
        "step": None if step is None else number("step", step),
        "window": None if window is None else _pair("window", window),
    }


def points(sample: object, knots: object, default: tuple[str, float] = ("default", 1e-3)) -> tuple[str, float]:
    """The points of a table: one each `sample` seconds, or as few as lines with an error of `knots` need; each millisecond, or the end
    of a shorter run, if neither is given."""
    if sample is not None and knots is not None:
        raise TypeError("sample and knots: give one of them")
    if sample is not None:
        return ("sample", number("sample", sample))
    return default if knots is None else ("knots", number("knots", knots))
