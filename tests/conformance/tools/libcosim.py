"""libcosim of the Open Simulation Platform, through its Python package; reads FMUs with the FMI Library."""

from importlib.metadata import version as version_of

import fmpy
import numpy as np

import job

NAME = "libcosim"
PROVES = "loads, connects and runs both FMUs; reads them with the FMI Library"
KNOWN = {"FMI 2.0 Enumeration variable type not supported": "libcosim knows no enumerations; those keep their start value"}


def version() -> str:
    return version_of("libcosimpy")


def references(fmu: str) -> dict[str, int]:
    return {variable.name: variable.valueReference for variable in fmpy.read_model_description(fmu).modelVariables}


def simulate(fmus: dict[str, str]) -> dict[str, job.Series]:
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.WARNING)
    nanoseconds = round(job.STEP * 1e9)
    execution = CosimExecution.from_step_size(nanoseconds)
    slaves = {name: CosimLocalSlave(fmus[name], name) for name in job.FMUS}
    index = {name: execution.add_local_slave(slave) for name, slave in slaves.items()}
    reference = {name: references(fmus[name]) for name in job.FMUS}
    source, sink = job.FMUS
    outputs = {name: job.outputs(fmus[name]) for name in job.FMUS}
    for name, value in job.START_VALUES.items():
        assert execution.real_initial_value(index[source], reference[source][name], value), name
    for name in job.CONNECTED:
        status = execution.connect_real_variables(
            index[source], reference[source][name], index[sink], reference[sink][name]
        )
        assert status == 0, name
    observer = CosimObserver.create_time_series(job.STEPS + 1)
    execution.add_observer(observer)
    for fmu, names in outputs.items():
        for name in names:
            observer.start_time_series(index[fmu], reference[fmu][name], CosimVariableType.REAL)
    assert execution.simulate_until(nanoseconds * job.STEPS)

    def series(fmu: str, name: str) -> np.ndarray:
        times, _, values = observer.time_series_real_samples(index[fmu], reference[fmu][name], 1, job.STEPS)
        assert list(times) == [nanoseconds * step for step in range(1, job.STEPS + 1)], "other communication points"
        return np.array(values)

    return {fmu: {name: series(fmu, name) for name in names} for fmu, names in outputs.items()}
