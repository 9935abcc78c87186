"""FMUs that count what each call of an importer returns: their libraries stand behind `recorder.c`."""

import os
import subprocess
import zipfile
from collections import Counter
from pathlib import Path

import fmpy

ENVIRONMENT = "VIDEG_CALLS"
OK = "fmi2OK"
HEADERS = Path(fmpy.__file__).parent / "c-code"


def build(folder: Path) -> bytes:
    """The library of the recorder."""
    library = folder / "recorder.so"
    source = Path(__file__).parent / "recorder.c"
    options = ["-std=gnu99", "-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-I", HEADERS]
    subprocess.run(["cc", *options, source, "-ldl", "-o", library], check=True)
    return library.read_bytes()


def wrap(fmu: str, recorder: bytes, folder: Path) -> str:
    """A copy of an FMU with the recorder in front of its library for Linux."""
    wrapped = folder / Path(fmu).name
    library = f"binaries/linux64/{wrapped.stem}.so"
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(wrapped, "w") as target:
        for entry in source.infolist():
            name = f"{library}.inner" if entry.filename == library else entry.filename
            target.writestr(name, source.read(entry))
        target.writestr(library, recorder)
    return str(wrapped)


def environment(folder: Path) -> dict[str, str]:
    """Has recorders write into a folder."""
    folder.mkdir()
    return os.environ | {ENVIRONMENT: str(folder)}


def read(folder: Path, fmu: str) -> Counter:
    """How often which function of an FMU returned which status."""
    calls = Counter()
    path = folder / f"{fmu}.calls"
    for line in path.read_text().splitlines() if path.exists() else []:
        function, status, count = line.split()
        calls[function, status] += int(count)
    return calls


def summary(calls: Counter) -> str:
    """What the page says of the calls: the same on every machine."""
    functions = {function for function, _ in calls}
    return f"{OK}, {len(functions)} functions" if functions and not others(calls) else "; ".join(others(calls))


def others(calls: Counter) -> list[str]:
    """The calls that returned something else than OK."""
    return [f"{function} returned {status} {n} times" for (function, status), n in sorted(calls.items()) if status != OK]
