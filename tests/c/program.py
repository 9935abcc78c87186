"""The C program `client`, compiled with the standard's own headers (FMPy brings them) and linked with an FMU's library.

Each run is a process of its own.
"""

import subprocess
import zipfile
from pathlib import Path

import fmpy

HEADERS = Path(fmpy.__file__).parent / "c-code"
STRICT = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]


class Program:
    """The program for one FMU. Commands are made by name and run together by `run`."""

    def __init__(self, fmu: str, folder: Path):
        self.description = fmpy.read_model_description(fmu)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        name = Path(fmu).stem
        with zipfile.ZipFile(fmu) as archive:
            library = archive.extract(f"binaries/linux64/{name}.so", folder)
        self.file = folder / name
        source = Path(__file__).parent / "client.c"
        subprocess.run(["cc", *STRICT, "-I", HEADERS, source, library, "-o", self.file], check=True)

    def set(self, name: str, value: float | int | bool) -> str:
        variable = self.variables[name]
        kind = {"Real": "real", "Boolean": "boolean"}.get(variable.type, "integer")
        text = float(value).hex() if kind == "real" else str(int(value))
        return f"{kind} {variable.valueReference} {text}"

    def outputs(self) -> list[str]:
        """Reads every output."""
        references = {"Real": [], "Integer": [], "Boolean": []}
        for variable in self.variables.values():
            if variable.causality == "output":
                references[variable.type].append(str(variable.valueReference))
        return [f"{kind.lower()}s {' '.join(found)}" for kind, found in references.items() if found]

    def get(self, *names: str) -> list[str]:
        return [f"{self.variables[name].type.lower()}s {self.variables[name].valueReference}" for name in names]

    def run(self, commands: list[str]) -> list[str]:
        """The lines that a new process answers."""
        run = subprocess.run(
            [self.file, self.description.guid], input="\n".join(commands), stdout=subprocess.PIPE, check=True, text=True
        )
        return run.stdout.splitlines()

    def values(self, commands: list[str]) -> list[str]:
        """The values that a new process reads, as written to the last bit; a call may warn, of a membrane that tears."""
        lines = self.run(commands)
        statuses = [line for line in lines if line.startswith("status")]
        assert len(statuses) == len(commands), lines
        assert set(statuses) <= {"status fmi2OK", "status fmi2Warning"}, lines
        return [line for line in lines if line.startswith("values")]


def steps(times: list[float]) -> list[str]:
    return [f"step {now.hex()} {(then - now).hex()}" for now, then in zip(times, times[1:])]
