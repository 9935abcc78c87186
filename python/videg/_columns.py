"""Results by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import numpy.typing as npt


class Columns(Mapping[str, "npt.NDArray[np.float64]"]):
    """Arrays by name."""

    def __init__(self, columns: dict[str, npt.NDArray[np.float64]]) -> None:
        self._columns = columns

    def __getitem__(self, name: str) -> npt.NDArray[np.float64]:
        """The array of this name."""
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"{name}: not recorded; there are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    # Two results are equal if they are the same one.
    __eq__ = object.__eq__
    __hash__ = object.__hash__
