"""The vibro-impact dielectric elastomer generator: simulate it, couple it with a circuit, sweep over it.

Quantities are in SI units. Variables are called as in the FMUs: `videg.start_values("fig14")` lists the parameters of the
harvester with values and units. What cannot be done raises `videg.Error`, which names the thing, its value and the bound; an argument of
the wrong type raises `TypeError`.
"""

from ._cases import Case, StartValue, cases, fmu, program, ssp, start_values
from ._export import Exported, export, netlist
from ._instances import Circuit, Harvester, State, Variable
from ._runs import Cosimulation, Simulation, cosim, simulate
from ._sweep import Evaluation, Range, evaluate, sweep
from ._videg import Error, __version__

__all__ = [
    "Case",
    "Circuit",
    "Cosimulation",
    "Error",
    "Evaluation",
    "Exported",
    "Harvester",
    "Range",
    "Simulation",
    "StartValue",
    "State",
    "Variable",
    "__version__",
    "cases",
    "cosim",
    "evaluate",
    "export",
    "fmu",
    "netlist",
    "program",
    "simulate",
    "ssp",
    "start_values",
    "sweep",
]
