"""What the FMUs promise by name, kept from release to release.

interface.py record   writes the variables of the model descriptions into release/interface.txt: part of a release
interface.py check    fails if one of them is gone or another thing now, while the version says that nothing broke

A variable is its name, value reference, type, causality and unit. New ones break nothing.
"""

import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RECORD = ROOT / "release/interface.txt"
FMUS = ["VibroImpactHarvester", "HarvestingCircuit"]


def variables() -> list[str]:
    lines = []
    for fmu in FMUS:
        document = ElementTree.parse(ROOT / f"modelDescription/{fmu}.xml")
        for variable in document.iter("ScalarVariable"):
            kind = next(iter(variable))
            name, reference = variable.get("name"), variable.get("valueReference")
            causality, unit = variable.get("causality", "local"), kind.get("unit", "-")
            lines.append(f"{fmu} {name} {reference} {kind.tag} {causality} {unit}")
    return lines


def version() -> str:
    return tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]


def promised(text: str) -> list[str]:
    """The part of a version that must rise when something breaks: the major one, or the minor one while that is 0."""
    major, minor, *_ = text.split(".")
    return [major] if major != "0" else [major, minor]


def check() -> None:
    if not RECORD.exists():
        print("nothing released yet, so no variable is promised")
        return
    first, *recorded = RECORD.read_text().splitlines()
    before = first.removeprefix("version ")
    if promised(before) != promised(version()):
        print(f"version {version()} may break what {before} promised")
        return
    gone = sorted(set(recorded) - set(variables()))
    if gone:
        lines = "\n".join(f"  {line}" for line in gone)
        sys.exit(f"interface.py: version {version()} breaks what {before} promised; these variables are gone or changed:\n{lines}")
    print(f"all {len(recorded)} variables of version {before} are as they were")


def main() -> None:
    match sys.argv[1:]:
        case ["record"]:
            RECORD.write_text("\n".join([f"version {version()}", *variables(), ""]))
        case ["check"]:
            check()
        case _:
            sys.exit("interface.py: wants record or check")


if __name__ == "__main__":
    main()
