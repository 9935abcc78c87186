"""The schema of the standard, applied by xmllint. FMPy brings the files of the schema."""

import subprocess
import tempfile
import zipfile
from pathlib import Path

import fmpy

NAME = "xmllint"
PROVES = "modelDescription.xml, and terminalsAndIcons.xml of FMI 3.0, are valid against the XSD of the standard"
FMI_3 = True


def version() -> str:
    return "system"


def check(fmu: str) -> None:
    schemas = Path(fmpy.__file__).parent / "schema"
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(fmu) as archive:
        files = {"modelDescription.xml": schemas / "fmi2" / "fmi2ModelDescription.xsd"}
        if b'fmiVersion="3.0"' in archive.read("modelDescription.xml"):
            files = {
                "modelDescription.xml": schemas / "fmi3" / "fmi3ModelDescription.xsd",
                "terminalsAndIcons/terminalsAndIcons.xml": schemas / "fmi3" / "fmi3TerminalsAndIcons.xsd",
            }
        for file, schema in files.items():
            document = archive.extract(file, folder)
            subprocess.run(["xmllint", "--noout", "--nonet", "--schema", schema, document], check=True)
