"""Fixtures: the FMUs, and slaves made of them."""

import shutil

import fmpy
import pytest

import harness
from slaves import FMU2NamedSlave


@pytest.fixture(scope="session")
def fmus() -> dict[str, str]:
    """The FMUs by model identifier, freshly packaged."""
    return harness.build_fmus()


@pytest.fixture
def slave(fmus):
    """Makes slaves by model identifier and takes them away after the test."""
    made = []

    def make(identifier: str) -> FMU2NamedSlave:
        folder = fmpy.extract(fmus[identifier])
        made.append((FMU2NamedSlave(fmpy.read_model_description(folder), folder), folder))
        return made[-1][0]

    yield make
    for instance, folder in made:
        if instance.component:
            instance.freeInstance()
        shutil.rmtree(folder)
