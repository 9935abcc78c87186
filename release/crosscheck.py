"""Writes what the FMI project asks of exporting tools, ready to hand in.

crosscheck.py FOLDER URL FMU...   writes FMUs, reference results, inputs and options in the folders of the FMI cross-check
                                  rules (section 9.1 of version 4.1), and tools.json, an entry for the tools page of
                                  fmi-standard.org; URL is the project's repository

Results and inputs are the experiments that each FMU carries (FMI-LS-REF). An experiment without inputs stands for model exchange,
if the FMU has it: importers there move inputs within a step, which holds them in co-simulation.
"""

import json
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
EXTRA = "extra/org.fmi-standard.fmi-ls-ref"
TOOL = "videg"
INTERFACES = {"CoSimulation": "cs", "ModelExchange": "me"}
PLATFORMS = {"linux64": "Linux", "win64": "Windows", "darwin64": "macOS"}
RELATIVE_TOLERANCE = 1e-5
"""Tables have nine digits, but integrators of importers shift impacts a little, and the pulses of C(t) with them."""

OPTIONS = """\
StartTime, {start}
StopTime, {stop}
StepSize, {step}
RelTol, {tolerance}
SolverType, FixedStep
OutputIntervalLength, {step}
"""

README = """\
{description}.

{interface} with the start values, {inputs}. The reference results are those of {tool} {version}; the motion between steps is
exact, so that they do not depend on the step but for the inputs.

Features: {features}.
"""


def package() -> dict:
    return tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]


def experiment(archive: zipfile.ZipFile, interface: str) -> ElementTree.Element:
    """The last experiment for co-simulation, for model exchange that without inputs."""
    experiments = ElementTree.fromstring(archive.read(f"{EXTRA}/experiments.exp")).findall("Experiment")
    return next(it for it in reversed(experiments) if interface == "CoSimulation" or it.find("Stimuli") is None)


def write(folder: Path, fmu: Path, archive: zipfile.ZipFile, description: ElementTree.Element, interface: str) -> None:
    """The files of an FMU for one interface and platform."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / fmu.name).write_bytes(fmu.read_bytes())
    run = experiment(archive, interface)
    for element, suffix in (("References", "ref.csv"), ("Stimuli", "in.csv")):
        found = run.find(element)
        if found is not None:
            (folder / f"{fmu.stem}_{suffix}").write_bytes(archive.read(f"{EXTRA}/{found.get('source')}"))
    start, stop, step = (run.get(name) for name in ("startTime", "stopTime", "stepSize"))
    options = OPTIONS.format(start=start, stop=stop, step=step, tolerance=RELATIVE_TOLERANCE)
    (folder / f"{fmu.stem}_ref.opt").write_text(options)
    capabilities = sorted(name for name, value in description.find(interface).attrib.items() if value == "true")
    facts = {"interface": interface, "tool": TOOL, "version": package()["version"], "features": ", ".join(capabilities)}
    inputs = f"inputs from {fmu.stem}_in.csv set at each step" if run.find("Stimuli") is not None else "no inputs"
    (folder / "README.md").write_text(README.format(description=description.get("description"), inputs=inputs, **facts))


def submit(folder: Path, fmu: Path) -> set[str]:
    """All folders of an FMU; gives the platforms that it has."""
    with zipfile.ZipFile(fmu) as archive:
        description = ElementTree.fromstring(archive.read("modelDescription.xml"))
        platforms = {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries/")} & set(PLATFORMS)
        for interface, short in INTERFACES.items():
            for platform in sorted(platforms) if description.find(interface) is not None else []:
                place = Path("fmus", "2.0", short, platform, TOOL, package()["version"], fmu.stem)
                write(folder / place, fmu, archive, description, interface)
    return platforms


def tool(platforms: set[str], repository: str) -> dict:
    """The entry for the tools page."""
    return {
        "name": TOOL,
        "license": "osi",
        "url": repository,
        "vendor": "The videg developers",
        "vendorURL": repository,
        "examplesUrl": f"{repository}/blob/main/docs/conformance.md",
        "description": "Vibro-impact dielectric elastomer generator and its harvesting circuit as FMUs, with a co-simulation master",
        "features": [],
        "platforms": [PLATFORMS[platform] for platform in sorted(platforms)],
        "interfaces": ["CLI", "library"],
        "fmiVersions": ["2.0"],
        "fmuExport": ["CS", "ME"],
        "fmuImport": ["CS"],
    }


def main() -> None:
    if len(sys.argv) < 4:
        sys.exit("crosscheck.py: wants a folder, the address of the repository, and FMUs")
    folder, repository, *fmus = sys.argv[1:]
    platforms = set().union(*(submit(Path(folder), Path(fmu)) for fmu in fmus))
    (Path(folder) / "tools.json").write_text(json.dumps(tool(platforms, repository), indent=4) + "\n")


if __name__ == "__main__":
    main()
