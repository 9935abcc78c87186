"""FMPy as the importer, with a fixed-step master written out."""

import shutil

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

import job

NAME = "FMPy"
PROVES = "loads and runs both FMUs"
FMI_3 = True


class Slave3(FMU3Slave):
    """One of FMI 3.0, called as one of FMI 2.0."""

    def setupExperiment(self, startTime: float, stopTime: float) -> None:
        self.experiment = {"startTime": startTime, "stopTime": stopTime}

    def enterInitializationMode(self) -> None:
        super().enterInitializationMode(**self.experiment)

    setReal, getReal = FMU3Slave.setFloat64, FMU3Slave.getFloat64


def version() -> str:
    return fmpy.__version__


def instantiate(fmu: str) -> tuple[FMU2Slave | Slave3, dict[str, int], str]:
    folder = fmpy.extract(fmu)
    description = fmpy.read_model_description(folder)
    slave = (Slave3 if description.fmiVersion == "3.0" else FMU2Slave)(
        guid=description.guid,
        modelIdentifier=description.coSimulation.modelIdentifier,
        unzipDirectory=folder,
        instanceName=description.modelName,
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0, stopTime=job.STEP * job.STEPS)
    return slave, {variable.name: variable.valueReference for variable in description.modelVariables}, folder


def simulate(fmus: dict[str, str]) -> dict[str, job.Series]:
    slaves, references, folders = zip(*(instantiate(fmus[name]) for name in job.FMUS))
    harvester, circuit = slaves
    harvester.setReal([references[0][name] for name in job.START_VALUES], list(job.START_VALUES.values()))
    sources, sinks = ([names[name] for name in job.CONNECTED] for names in references)
    outputs = {name: job.outputs(fmus[name]) for name in job.FMUS}
    read = [[names[name] for name in outputs[fmu]] for fmu, names in zip(job.FMUS, references)]
    for slave in slaves:
        slave.enterInitializationMode()
    circuit.setReal(sinks, harvester.getReal(sources))
    for slave in slaves:
        slave.exitInitializationMode()
    rows = [[], []]
    for index in range(job.STEPS):
        circuit.setReal(sinks, harvester.getReal(sources))
        for slave, values, wanted in zip(slaves, rows, read):
            slave.doStep(index * job.STEP, job.STEP)
            values.append(slave.getReal(wanted))
    for slave, folder in zip(slaves, folders):
        slave.terminate()
        slave.freeInstance()
        shutil.rmtree(folder)
    return {fmu: dict(zip(outputs[fmu], np.array(values).T)) for fmu, values in zip(job.FMUS, rows)}
