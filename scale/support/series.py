"""Time series as CSV, of videg and of federates."""

import csv
from pathlib import Path


def rows(file: Path) -> list[dict[str, float]]:
    """All rows, each by the names of its columns."""
    with open(file, newline="") as series:
        return [{name: float(text) for name, text in row.items()} for row in csv.DictReader(series)]
