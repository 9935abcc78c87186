"""The experiments that the FMUs carry, and the files for the FMI cross-check: FMPy gets the reference results from the inputs."""

import json
import subprocess
import sys
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

import harness

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
DIGITS = 1e-8
"""Relative to the largest value: the tables have nine digits."""
LARGEST = 1_000_000
"""Bytes of a table, after the rules of the cross-check."""


@pytest.fixture(scope="module")
def fmus() -> dict[str, str]:
    return harness.build_fmus()


@pytest.fixture(scope="module")
def files(fmus, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("crosscheck")
    script = harness.ROOT / "release" / "crosscheck.py"
    subprocess.run([sys.executable, script, folder, "https://example.org/videg", *fmus.values()], check=True)
    return folder


def agree(fmu: str, fmi_type: str, step: float, stop: float, inputs: Path | None, reference: Path, bound: float) -> None:
    expected = np.genfromtxt(reference, delimiter=",", names=True, deletechars="")
    names = [name for name in expected.dtype.names if name != "time"]
    result = fmpy.simulate_fmu(
        fmu,
        fmi_type=fmi_type,
        stop_time=stop,
        step_size=step,
        output_interval=step,
        record_events=False,
        input=None if inputs is None else fmpy.util.read_csv(inputs),
        output=names,
    )
    assert result["time"] == pytest.approx(expected["time"], abs=1e-9)
    for name in names:
        assert result[name] == pytest.approx(expected[name], abs=bound * np.abs(expected[name]).max()), name


@pytest.mark.parametrize("name", ["VibroImpactHarvester", "HarvestingCircuit"])
def test_each_experiment_gives_its_reference_results(fmus, name, tmp_path):
    with zipfile.ZipFile(fmus[name]) as archive:
        archive.extractall(tmp_path)
    folder = tmp_path / FOLDER
    related = {it.get("source") for it in xml.parse(folder / "fmi-ls-manifest.xml").getroot().findall("Related")}
    assert all((folder / source).exists() for source in related)
    for experiment in xml.parse(folder / "experiments.exp").getroot().findall("Experiment"):
        step, stop = float(experiment.get("stepSize")), float(experiment.get("stopTime"))
        stimuli, references = experiment.find("Stimuli"), experiment.find("References").get("source")
        inputs = None if stimuli is None else folder / stimuli.get("source")
        assert references in related
        agree(fmus[name], "CoSimulation", step, stop, inputs, folder / references, DIGITS)


def test_files_for_the_cross_check_hold_what_an_importer_gets(fmus, files):
    submitted = sorted(files.glob("fmus/2.0/*/linux64/videg/*/*"))
    assert [(folder.parts[-5], folder.name) for folder in submitted] == [
        ("cs", "HarvestingCircuit"),
        ("cs", "VibroImpactHarvester"),
        ("me", "VibroImpactHarvester"),
    ]
    for folder in submitted:
        model = folder.name
        lines = (line.split(",") for line in (folder / f"{model}_ref.opt").read_text().splitlines())
        options = {key: value.strip() for key, value in lines}
        inputs, reference = folder / f"{model}_in.csv", folder / f"{model}_ref.csv"
        assert reference.stat().st_size < LARGEST and reference.read_text().startswith('"time","')
        exchange = folder.parts[-5] == "me"
        assert inputs.exists() != exchange and (folder / "README.md").exists()
        kind, bound = ("ModelExchange", float(options["RelTol"])) if exchange else ("CoSimulation", DIGITS)
        step, stop = float(options["StepSize"]), float(options["StopTime"])
        agree(str(folder / f"{model}.fmu"), kind, step, stop, None if exchange else inputs, reference, bound)


def test_the_entry_for_the_tools_page_is_complete(files):
    entry = json.loads((files / "tools.json").read_text())
    assert entry["fmuExport"] == ["CS", "ME"] and entry["fmuImport"] == ["CS"] and entry["platforms"] == ["Linux"]
    assert not entry["description"].endswith(".") and all(entry[key].startswith("https://") for key in ("url", "vendorURL"))
