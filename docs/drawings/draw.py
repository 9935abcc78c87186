"""Draws the pictures of `docs/figures`: `.venv/bin/python docs/drawings/draw.py`."""

from pathlib import Path

import circuits
import device
import netlists

FOLDER = Path(__file__).resolve().parents[1] / "figures"


def drawings() -> dict[str, str]:
    """File names and contents."""
    return device.drawings() | circuits.drawings() | netlists.drawings()


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, svg in drawings().items():
        (FOLDER / name).write_text(svg)
