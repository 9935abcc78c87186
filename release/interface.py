"""What the FMUs promise by name, kept from release to release.

interface.py record   writes the variables of the model descriptions into release/interface.txt: part of a release
interface.py check    fails if one of them is gone or another thing now, while the version says that nothing broke

A variable is its name, value reference, type, causality and unit. New ones break nothing at the end of the table. In the middle
they move the value references of those behind them, which masters may have compiled in.
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


def sort_out(missing: list[str], now: list[str]) -> tuple[list[str], list[str]]:
    """Of the lines that are missing: what became of those with another value reference alone, and the rest."""
    references = {}
    for line in now:
        fmu, name, reference, rest = line.split(" ", 3)
        references[fmu, name, rest] = reference
    moved, gone = [], []
    for line in missing:
        fmu, name, reference, rest = line.split(" ", 3)
        found = references.get((fmu, name, rest))
        if found is None:
            gone.append(line)
        else:
            moved.append(f"  {fmu} {name} had value reference {reference}, now {found}\n")
    return moved, gone


def check() -> None:
    if not RECORD.exists():
        print("nothing released yet, so no variable is promised")
        return
    first, *recorded = RECORD.read_text().splitlines()
    before = first.removeprefix("version ")
    if promised(before) != promised(version()):
        print(f"version {version()} may break what {before} promised")
        return
    now = variables()
    moved, gone = sort_out([line for line in recorded if line not in now], now)
    message = f"interface.py: version {version()} breaks what {before} promised"
    if gone:
        message += "; these variables are gone or changed:\n" + "".join(f"  {line}\n" for line in gone)
    if moved:
        message += "; value references moved, new variables go to the end of the table:\n" + "".join(moved)
    if gone or moved:
        sys.exit(message.rstrip("\n"))
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
