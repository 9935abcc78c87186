"""An FMU for co-simulation whose variables go by their names, on FMPy."""

import contextlib
import ctypes
import shutil
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from pathlib import Path

from tool import Problem, need

need("fmpy")

import fmpy  # noqa: E402
from fmpy import fmi2  # noqa: E402
from fmpy.logging import addLoggerProxy  # noqa: E402

VALUES = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"


def read_parameters(file: Path) -> dict[str, str]:
    """Values by name from a parameter set of SSP 1.0 (.ssv)."""
    try:
        root = ElementTree.parse(file).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise Problem(f"parameter set {file}: {error}") from error
    if root.tag != f"{VALUES}ParameterSet":
        raise Problem(f"parameter set {file}: its root is {root.tag}, not {VALUES}ParameterSet of SSP 1.0")
    try:
        return {item.attrib["name"]: item[0].attrib["value"] for item in root.iter(f"{VALUES}Parameter")}
    except (KeyError, IndexError) as error:
        raise Problem(f"parameter set {file}: a parameter has no name or no value") from error


def callbacks_to_stderr() -> fmi2.fmi2CallbackFunctions:
    """What an FMU logs goes to stderr; FMPy would write it to stdout."""
    callbacks = fmi2.fmi2CallbackFunctions()

    def log(_environment: int, instance: bytes, _status: int, _category: bytes, message: bytes) -> None:
        print(f"{instance.decode()}: {message.decode()}", file=sys.stderr)

    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
    callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
    callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
    addLoggerProxy(ctypes.byref(callbacks))
    return callbacks


class Slave:
    """An instance called `name` of the FMU in `file`, for a `with` statement."""

    def __init__(self, file: Path, name: str):
        if not file.is_file():
            raise Problem(f"FMU {file} is not there; videg fmu build makes it")
        self._file = file
        with contextlib.ExitStack() as undo:
            try:
                self._folder = fmpy.extract(str(file))
                undo.callback(shutil.rmtree, self._folder, ignore_errors=True)
                description = fmpy.read_model_description(self._folder)
            except Exception as error:  # FMPy raises whatever its parsers do.
                raise Problem(f"FMU {file}: {error}") from error
            self._instantiate(description, name)
            undo.callback(self._fmu.freeInstance)
            self._undo = undo.pop_all()

    def _instantiate(self, description: fmpy.model_description.ModelDescription, name: str) -> None:
        self._variables = {variable.name: variable for variable in description.modelVariables}
        self._fmu = fmi2.FMU2Slave(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=self._folder,
            instanceName=name,
        )
        self._callbacks = callbacks_to_stderr()  # Kept as long as the instance may log.
        self._fmu.instantiate(callbacks=self._callbacks)

    def __enter__(self) -> "Slave":
        return self

    def __exit__(self, *_: object) -> None:
        """Ends the instance and takes its files away."""
        self._undo.close()

    def variable(self, name: str) -> fmpy.model_description.ScalarVariable:
        if name not in self._variables:
            raise Problem(f"FMU {self._file}: there is no variable {name}")
        return self._variables[name]

    def references(self, names: Sequence[str]) -> list[int]:
        return [self.variable(name).valueReference for name in names]

    def set_text(self, name: str, text: str) -> None:
        """Sets a variable of any type to what `text` says."""
        variable = self.variable(name)
        reference = [variable.valueReference]
        try:
            match variable.type:
                case "Real":
                    self._fmu.setReal(reference, [float(text)])
                case "Boolean":
                    self._fmu.setBoolean(reference, [{"true": True, "false": False}[text]])
                case "Enumeration":
                    items = {item.name: int(item.value) for item in variable.declaredType.items}
                    self._fmu.setInteger(reference, [items[text]])
                case _:
                    self._fmu.setInteger(reference, [int(text)])
        except (ValueError, KeyError) as error:
            raise Problem(f"FMU {self._file}: {name} = {text} is no {variable.type}") from error

    def start(self, parameters: dict[str, str], until: float, inputs: dict[str, float] | None = None) -> None:
        """Initialises at 0 s for a run up to `until`, s, with these parameters and inputs; an input may be in either."""
        given = [name for name in parameters if self.variable(name).causality == "input"]
        for name in [name for name in parameters if name not in given]:
            self.set_text(name, parameters[name])
        self._fmu.setupExperiment(startTime=0.0, stopTime=until)
        self._fmu.enterInitializationMode()
        for name in given:
            self.set_text(name, parameters[name])
        if inputs:
            self.set(self.references(list(inputs)), list(inputs.values()))
        self._fmu.exitInitializationMode()

    def set(self, references: Sequence[int], values: Sequence[float]) -> None:
        self._fmu.setReal(references, values)

    def set_rates(self, references: Sequence[int], rates: Sequence[float]) -> None:
        """First derivatives of inputs, which run on at these rates over the next step."""
        self._fmu.setRealInputDerivatives(references, [1] * len(references), rates)

    def get(self, references: Sequence[int]) -> list[float]:
        return list(self._fmu.getReal(references))

    def flag(self, name: str) -> bool:
        """The value of a Boolean variable."""
        return bool(self._fmu.getBoolean(self.references([name]))[0])

    def step(self, now: float, step: float) -> None:
        """Steps from `now` by `step`, s."""
        self._fmu.doStep(now, step)
