"""Fixtures: the FMUs, and slaves made of them."""

import shutil

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave

import harness


@pytest.fixture(scope="session")
def fmus() -> dict[str, str]:
    """The FMUs by model identifier, freshly packaged."""
    return harness.build_fmus()


class FMU2NamedSlave(FMU2Slave):
    """A slave whose variables are called by their names. FMPy finds the functions to load by how the class is called."""

    def __init__(self, description, folder):
        super().__init__(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=folder,
            instanceName=description.modelName,
        )
        self.variables = {variable.name: variable for variable in description.modelVariables}

    def start(self, values: dict[str, float] | None = None, stop_time: float | None = None) -> None:
        """Initialise at 0 s with these values."""
        self.instantiate()
        self.setupExperiment(startTime=0.0, stopTime=stop_time)
        self.set(values or {})
        self.enterInitializationMode()
        self.exitInitializationMode()

    def references(self, names) -> list[int]:
        return [self.variables[name].valueReference for name in names]

    def set(self, values: dict[str, float]) -> None:
        self.setReal(self.references(values), list(values.values()))

    def set_rates(self, rates: dict[str, float]) -> None:
        self.setRealInputDerivatives(self.references(rates), [1] * len(rates), list(rates.values()))

    def get(self, *names: str) -> list[float]:
        return list(self.getReal(self.references(names)))

    def outputs(self) -> dict[str, float | int | bool]:
        """All outputs by name."""
        read = {"Real": self.getReal, "Integer": self.getInteger, "Boolean": self.getBoolean}
        outputs = [variable for variable in self.variables.values() if variable.causality == "output"]
        return {output.name: read[output.type]([output.valueReference])[0] for output in outputs}


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
