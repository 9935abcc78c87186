"""What the readers of descriptions of FMI 3.0 written in Rust (the crate fmi-schema) are given."""

import re
import zipfile
from collections.abc import Callable
from pathlib import Path

KNOWN = {
    "no units": "its reader of FMI 3.0 refuses amperes in base units, `unit` and `nominal` of variables, all of them in the XSD; "
    "it gets copies of the descriptions without units and nominal values"
}


def without_units(description: bytes) -> bytes:
    """The description without units and nominal values. Says so, as one of the messages that are [`KNOWN`]."""
    print("warning: no units")
    description = re.sub(rb"<UnitDefinitions>.*</UnitDefinitions>", b"", description, flags=re.DOTALL)
    return re.sub(rb' (unit|nominal)="[^"]*"', b"", description)


def copy(fmu: str, folder: Path, edit: Callable[[bytes], bytes] = without_units) -> str:
    """A copy of an FMU with an edited description."""
    path = folder / Path(fmu).name
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(path, "w") as target:
        for entry in source.infolist():
            content = source.read(entry)
            target.writestr(entry, edit(content) if entry.filename == "modelDescription.xml" else content)
    return str(path)
