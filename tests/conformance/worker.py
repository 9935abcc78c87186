"""Runs one tool, in a process of its own, so that neither a crash nor what it prints goes unnoticed.

    worker.py TOOL FOLDER FMU...

A checker looks at each FMU. An importer writes the series of each FMU into FOLDER.
"""

import importlib
import sys
from pathlib import Path

import numpy as np

import job


def main(tool: str, folder: str, *files: str) -> None:
    module = importlib.import_module(f"tools.{tool}")
    if hasattr(module, "check"):
        for file in files:
            module.check(file)
        return
    fmus = {Path(file).stem: file for file in files}
    for fmu, series in module.simulate(fmus).items():
        assert all(len(values) == job.STEPS for values in series.values())
        np.savez(Path(folder) / f"{fmu}.npz", **series)


if __name__ == "__main__":
    main(*sys.argv[1:])
