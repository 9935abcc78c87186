"""The worst of differences, and what pages say of it."""

import math
from collections.abc import Iterable

import numpy as np


def worst(differences: Iterable[float]) -> float:
    """The largest, and without end where one is no number: the `max` of Python passes over those that do not come first."""
    largest = float(np.max(list(differences)))
    return math.inf if math.isnan(largest) else largest


def rounded(difference: float) -> str:
    """Rounded up to a power of ten: its digits may change from machine to machine."""
    if difference == 0.0:
        return "none"
    return f"at most {10.0 ** math.ceil(math.log10(difference)):.0e}" if math.isfinite(difference) else "without end"
