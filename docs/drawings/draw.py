"""Draws the pictures of `docs/figures` and the templates of those in reports: `.venv/bin/python docs/drawings/draw.py`."""

from pathlib import Path

import circuits
import device
import netlists

ROOT = Path(__file__).resolve().parents[2]


def drawings() -> dict[str, str]:
    """File names and contents."""
    return device.drawings() | circuits.drawings() | netlists.drawings()


def templates() -> dict[str, str]:
    """The same of the drawings into which a report writes the values of its run."""
    return device.templates() | circuits.templates()


FOLDERS = {ROOT / "docs" / "figures": drawings, ROOT / "src" / "cli" / "drawings": templates}

if __name__ == "__main__":
    for folder, draw in FOLDERS.items():
        folder.mkdir(exist_ok=True)
        for name, svg in draw().items():
            (folder / name).write_text(svg)
