"""The strict client, compiled with the standard's own headers (FMPy brings them); it loads the library of an FMU."""

import subprocess
import zipfile
from pathlib import Path

import fmpy

HEADERS = Path(fmpy.__file__).parent / "c-code"
STRICT = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror"]


def role(variable, states: set) -> str:
    if variable in states:
        return "state"
    if variable.derivative is not None:
        return "derivative"
    return variable.causality if variable.causality in ("parameter", "input", "output") else "rest"


def start(variable, values: dict[str, str]) -> str:
    """A start value as C reads it; a word for what has none, and for an empty text."""
    value = values.get(variable.name, variable.start)
    return {"true": "1", "false": "0", None: "-"}.get(value, value) or "-"


def table(description, values: dict[str, str]) -> str:
    variables = description.modelVariables
    states = {variable.derivative for variable in variables if variable.derivative is not None}
    lines = [f"states {len(states)}", f"indicators {description.numberOfEventIndicators}"]
    for interface in (description.coSimulation, description.modelExchange):
        if interface is not None:
            # Under the compliant law there is no model exchange.
            if values.get("contact.law") == "2" and interface is description.modelExchange:
                continue
            lines.append(f"interface {type(interface).__name__}")
            # With values of its own the harvester takes derivatives by differences, which means many runs each.
            lines += ["derivatives"] if interface.providesDirectionalDerivative and not values else []
    for variable in variables:
        kind = {"Enumeration": "Integer"}.get(variable.type, variable.type).lower()
        lines.append(f"variable {variable.valueReference} {kind} {role(variable, states)} {start(variable, values)}")
    return "\n".join(lines) + "\n"


def run(fmu: str, folder: Path, values: dict[str, str] | None = None) -> tuple[int, list[str]]:
    """What the client says of an FMU that runs in `folder`, with these values of parameters: its exit code and its lines."""
    program = folder / "strict"
    source = Path(__file__).parent / "strict.c"
    subprocess.run(["cc", *STRICT, "-I", HEADERS, source, "-ldl", "-lm", "-o", program], check=True)
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    description = fmpy.read_model_description(fmu)
    library = folder / "binaries" / "linux64" / f"{Path(fmu).stem}.so"
    command = [program, library, description.guid]
    finished = subprocess.run(command, input=table(description, values or {}), stdout=subprocess.PIPE, text=True, cwd=folder)
    return finished.returncode, finished.stdout.splitlines()
