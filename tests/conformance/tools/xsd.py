"""The schema of the standard, applied by xmllint. FMPy brings the files of the schema."""

import subprocess
import tempfile
import zipfile
from pathlib import Path

import fmpy

NAME = "xmllint"
PROVES = "modelDescription.xml is valid against the XSD of FMI 2.0"


def version() -> str:
    return "system"


def check(fmu: str) -> None:
    schema = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(fmu) as archive:
        description = archive.extract("modelDescription.xml", folder)
        subprocess.run(["xmllint", "--noout", "--nonet", "--schema", schema, description], check=True)
