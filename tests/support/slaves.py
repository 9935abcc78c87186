"""Slaves whose variables are called by their names."""

from fmpy.fmi2 import FMU2Slave


class FMU2NamedSlave(FMU2Slave):
    """FMPy finds the functions to load by how the class is called."""

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
        self.begin(values, stop_time)

    def begin(self, values: dict[str, float] | None = None, stop_time: float | None = None) -> None:
        """As above, of an instance that is there."""
        self.setupExperiment(startTime=0.0, stopTime=stop_time)
        self.set(values or {})
        self.enterInitializationMode()
        self.exitInitializationMode()

    def references(self, names) -> list[int]:
        return [self.variables[name].valueReference for name in names]

    def set(self, values: dict[str, float | int | bool]) -> None:
        write = {"Real": self.setReal, "Boolean": self.setBoolean}
        for name, value in values.items():
            write.get(self.variables[name].type, self.setInteger)(self.references([name]), [value])

    def set_rates(self, rates: dict[str, float]) -> None:
        self.setRealInputDerivatives(self.references(rates), [1] * len(rates), list(rates.values()))

    def get(self, *names: str) -> list[float | int | bool]:
        read = {"Real": self.getReal, "Boolean": self.getBoolean}
        return [read.get(self.variables[name].type, self.getInteger)(self.references([name]))[0] for name in names]

    def outputs(self) -> dict[str, float | int | bool]:
        """All outputs by name."""
        names = [name for name, variable in self.variables.items() if variable.causality == "output"]
        return dict(zip(names, self.get(*names)))
