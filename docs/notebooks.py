"""Notebooks of the recipes in examples/python: `python docs/notebooks.py FOLDER` writes one for each script. Needs nbformat."""

import argparse
import re
from pathlib import Path

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

RECIPES = Path(__file__).resolve().parent.parent / "examples/python"
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)


def notebook(script: str) -> nbformat.NotebookNode:
    """The cells of a script; comments of a Markdown cell are its text."""
    cells = []
    parts = CELL.split(script)
    # Before the first cell there is nothing; then kind and content in turns.
    for index, (kind, text) in enumerate(zip(parts[1::2], parts[2::2], strict=True)):
        if kind:
            lines = [line.removeprefix("#").removeprefix(" ") for line in text.strip().splitlines()]
            cell = new_markdown_cell("\n".join(lines))
        else:
            cell = new_code_cell(text.strip())
        # Not a random one: the same script gives the same file.
        cell.id = f"cell-{index}"
        cells.append(cell)
    return new_notebook(cells=cells, metadata={"language_info": {"name": "python"}})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the notebooks go")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for script in sorted(RECIPES.glob("*.py")):
        made = notebook(script.read_text())
        nbformat.validate(made)
        nbformat.write(made, folder / f"{script.stem}.ipynb")
        print(folder / f"{script.stem}.ipynb")


if __name__ == "__main__":
    main()
