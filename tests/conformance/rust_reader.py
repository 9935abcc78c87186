"""What the readers of descriptions of FMI 3.0 written in Rust (the crate fmi-schema) are given."""

import re

KNOWN = {
    "no units": "its reader of FMI 3.0 refuses amperes in base units, `unit` and `nominal` of variables, all of them in the XSD; "
    "it gets copies of the descriptions without units and nominal values"
}


def without_units(description: bytes) -> bytes:
    """The description without units and nominal values. Says so, as one of the messages that are [`KNOWN`]."""
    print("warning: no units")
    description = re.sub(rb"<UnitDefinitions>.*</UnitDefinitions>", b"", description, flags=re.DOTALL)
    return re.sub(rb' (unit|nominal)="[^"]*"', b"", description)
