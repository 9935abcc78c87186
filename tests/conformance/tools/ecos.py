"""Ecos, through its Python package: an importer that reads FMUs with fmi4c.

It adds up its steps instead of multiplying, so that its communication points drift off the grid by some 1e-12 s. That is
all of its difference: a master whose clock does the same gets its numbers to the last bit.
"""

from importlib.metadata import version as version_of

import numpy as np

import job

NAME = "Ecos"
PROVES = "loads, connects and runs both FMUs; reads them with fmi4c"


def version() -> str:
    return version_of("ecospy")


def simulate(fmus: dict[str, str]) -> dict[str, job.Series]:
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    EcosLib.set_log_level("warn")
    source, sink = job.FMUS
    outputs = {name: job.outputs(fmus[name]) for name in job.FMUS}
    with EcosSimulationStructure() as structure:
        for name in job.FMUS:
            structure.add_model(name, fmus[name])
        structure.add_parameter_set("fig14", {f"{source}::{name}": value for name, value in job.START_VALUES.items()})
        for name in job.CONNECTED:
            structure.make_real_connection(f"{source}::{name}", f"{sink}::{name}")
        with EcosSimulation(structure=structure, step_size=job.STEP) as simulation:
            assert simulation.init(parameter_set="fig14"), EcosLib.get_last_error()
            read = [f"{fmu}::{name}" for fmu, names in outputs.items() for name in names]
            rows = []
            for _ in range(job.STEPS):
                simulation.step()
                rows.append([simulation.get_real(name) for name in read])
            simulation.terminate()
    columns = iter(np.array(rows).T)
    return {fmu: {name: next(columns) for name in names} for fmu, names in outputs.items()}
