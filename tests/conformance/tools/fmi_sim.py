"""fmi-sim, a simulator in Rust with solvers of its own, where it is built: `./test.sh conformance-slow` does so."""

import re
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

import job
import rust_reader

NAME = "fmi-sim"
PROVES = "runs each interface that the FMU has, model exchange with an explicit Euler method of its own"
PROGRAM = "fmi-sim"

INTERFACES = {"CoSimulation": "co-simulation", "ModelExchange": "model-exchange"}
STEP, STOP = 1e-3, 1.0
LOADS = FMI_3 = True
KNOWN = rust_reader.KNOWN | {
    "no clocks": "it asks for clocks as Booleans, and for what is clocked at any time; it gets copies of the descriptions without both"
}


def is_available() -> bool:
    return shutil.which(PROGRAM) is not None


def version() -> str:
    run = subprocess.run([PROGRAM, "--version"], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return re.search(r"\d+\.\d+\.\d+", run.stdout).group()


def readable(description: bytes) -> bytes:
    """A description of FMI 3.0 as the program takes it."""
    root = xml.fromstring(rust_reader.without_units(description))
    variables, structure = root.find("ModelVariables"), root.find("ModelStructure")
    clocked = [variable for variable in variables if variable.tag == "Clock" or variable.get("clocks")]
    if clocked:
        print("warning: no clocks")
    references = [variable.get("valueReference") for variable in clocked]
    for variable in clocked:
        variables.remove(variable)
    for unknown in [unknown for unknown in structure if unknown.get("valueReference") in references]:
        structure.remove(unknown)
    return xml.tostring(root, encoding="utf-8", xml_declaration=True)


def check(fmu: str) -> None:
    """Runs each interface that the FMU has; a step lost would show in the number of rows."""
    with zipfile.ZipFile(fmu) as archive:
        description = xml.fromstring(archive.read("modelDescription.xml"))
    with tempfile.TemporaryDirectory() as folder:
        if description.get("fmiVersion") == "3.0":
            fmu = job.edited(fmu, Path(folder), readable)
        for element, verb in INTERFACES.items():
            if description.find(element) is not None:
                run(fmu, verb)


def run(fmu: str, verb: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "result.csv"
        command = [PROGRAM, "--model", fmu, "--output-file", table, verb, "-f", str(STOP), "--step", str(STEP)]
        finished = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        print(finished.stdout)
        rows = len(table.read_text().splitlines()) if table.exists() else 0
        if finished.returncode != 0 or rows < STOP / STEP:
            raise ValueError(f"{verb} ended with {finished.returncode} after {rows} rows")
