"""FMPy and Ecos run the system package, and agree with the command line.

Both are masters that hand on values and no more: `cosim --master plain`.
"""

import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssd, read_ssv

import harness
import system

STEP, STEPS = 1e-3, 5000

TOLERANCE = 1e-9
"""Relative to the largest value. Both add up their steps instead of multiplying, which puts communication points off the
grid by some 1e-12 s, and hence C(t) by some 1e-11 of its value."""

SCHEMAS = Path(fmpy.__file__).parent / "ssp" / "schema"


@pytest.fixture(scope="module")
def package() -> str:
    return harness.videg("ssp")["ssp"]


@pytest.fixture(scope="module")
def expected() -> dict[str, np.ndarray]:
    return system.videg(STEP, STEPS, "--circuit", "fmu")


def agree(found: dict[str, np.ndarray], expected: dict[str, np.ndarray]) -> None:
    for name, values in expected.items():
        assert found[name] == pytest.approx(values, rel=0.0, abs=TOLERANCE * np.abs(values).max()), name


def test_the_documents_follow_the_schemas_of_the_standard(package, tmp_path):
    with zipfile.ZipFile(package) as archive:
        archive.extractall(tmp_path)
    documents = {"SystemStructureDescription.xsd": ["SystemStructure.ssd"]}
    documents["SystemStructureParameterValues.xsd"] = [f"resources/{it}.ssv" for it in ("harvester", "circuit", "system")]
    for schema, files in documents.items():
        subprocess.run(["xmllint", "--noout", "--schema", SCHEMAS / schema, *files], cwd=tmp_path, check=True)


def test_the_case_is_in_the_package_twice_and_alike(package):
    bound = {
        f"{component.name}.{parameter.name}": parameter.value
        for component in read_ssd(package).system.elements
        for parameter in component.parameterBindings[0].parameterValues[0].parameters
    }
    of_system = read_ssv(package, resource="resources/system.ssv")
    assert bound == {parameter.name: parameter.value for parameter in of_system.parameters}
    for name, value in harness.fig14().items():
        assert float(bound[f"harvester.{name}"]) == value


def test_fmpy_runs_the_package_as_the_command_line_does(package, expected):
    agree(system.fmpy_ssp(package, STEP, STEPS), expected)


def test_ecos_runs_the_package_as_the_command_line_does(package, expected):
    agree(system.ecos_ssp(package, STEP, STEPS), expected)


def test_settings_travel_in_the_package(tmp_path):
    settings = ["--set", "membrane.restitution=0.8", "--set", "load.resistance=inf", "--set", "zener.voltage=2100"]
    packaged = harness.videg("ssp", *settings, "--output", str(tmp_path))
    assert packaged["warnings"] == []
    found = system.fmpy_ssp(packaged["ssp"], STEP, 2000)
    agree(found, system.videg(STEP, 2000, "--circuit", "fmu", *settings))


def test_enumerations_are_packaged_with_a_warning(tmp_path):
    packaged = harness.videg("ssp", "--set", "topology=isolated", "--output", str(tmp_path))
    assert "circuit.topology" in packaged["parameters"]
    assert packaged["warnings"][0].startswith("circuit.topology is an enumeration")
