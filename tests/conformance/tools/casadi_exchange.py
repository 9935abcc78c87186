"""CasADi: model exchange. It takes fmi2Warning for a failure, and reads every output as a Real."""

import tempfile
import zipfile
from importlib.metadata import version as version_of

import fmpy
import numpy as np

import job

NAME = "CasADi"
PROVES = "model exchange: derivatives and outputs; its Jacobian from directional derivatives agrees with differences"
LOADS = True
FMUS = (job.HARVESTER,)

STATES = [0.01, 0.02, 0.005, 0.1, 0.002]
"""A cylinder, a ball inside the gap, and what the damper has taken."""
INPUTS = [0.05, 2000.0, 2100.0]
POINT = np.array(STATES + INPUTS)
TOLERANCE = 1e-6
"""Of central differences, relative to the largest derivative of the same output, or to 1."""


def version() -> str:
    return version_of("casadi")


def check(fmu: str) -> None:
    import casadi

    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        model = casadi.DaeBuilder("harvester", folder, {"debug": False})
        function = model.create("function", ["t", "x", "u"], ["ode", "y"])
    jacobian = function.factory("jacobian", ["t", "x", "u"], ["jac:ode:x", "jac:ode:u", "jac:y:x", "jac:y:u"])
    blocks = [block.full() for block in jacobian(0.0, STATES, INPUTS)]
    agree(function, np.block([blocks[:2], blocks[2:]]), constant(fmu, model.y()))


def constant(fmu: str, outputs: list[str]) -> np.ndarray:
    """Which of derivatives and outputs do not change between events: discrete outputs, the next impact among them."""
    variables = {variable.name: variable for variable in fmpy.read_model_description(fmu).modelVariables}
    discrete = [variables[name].variability == "discrete" for name in outputs]
    assert sorted(outputs) == sorted(job.outputs(fmu))
    return np.array([False] * len(STATES) + discrete)


def agree(function, exact: np.ndarray, is_constant: np.ndarray) -> None:
    def values(point: np.ndarray) -> np.ndarray:
        return np.concatenate([part.full().ravel() for part in function(0.0, point[: len(STATES)], point[len(STATES) :])])

    steps = np.diag(1e-5 * np.maximum(1.0, np.abs(POINT)))
    slopes = [(values(POINT + step) - values(POINT - step)) / (2.0 * step.max()) for step in steps]
    differences = np.where(is_constant[:, None], 0.0, np.transpose(slopes))
    scale = np.maximum(1.0, np.abs(differences).max(axis=1, keepdims=True))
    wrong = np.argwhere(np.abs(exact - differences) > TOLERANCE * scale)
    assert not len(wrong), [(row, column, exact[row, column], differences[row, column]) for row, column in wrong]
    assert np.count_nonzero(exact) > 10, "there are hardly any derivatives"
