"""FMPy's own rules: names, start values, causalities and variabilities, units, model structure."""

import fmpy
from fmpy.validation import validate_fmu

NAME = "FMPy validate"
PROVES = "variable names, start values, units and ModelStructure follow the standard"
FMI_3 = True


def version() -> str:
    return fmpy.__version__


def check(fmu: str) -> None:
    problems = validate_fmu(fmu)
    if problems:
        raise ValueError("\n".join(problems))
