"""Net power of the circuits in ngspice_netlists/circuits on cases of the paper, as a table in Markdown.

    python examples/circuits.py > table.md     # with videg on the PATH

Each runs live with the harvester. The communication step is short where the capacitance of a pulse grows a hundredfold. A cell is the
net power in mW over the second half of the run; `*` marks a run whose coupling makes or loses more than 1 % of the energy moved.
"""

import json
import subprocess
import tempfile
from pathlib import Path

CIRCUITS = Path(__file__).parents[1] / "ngspice_netlists" / "circuits"
NETLISTS = ["paper", "leaky", "half_wave", "constant_charge", "self_priming"]
CASES = {
    "fig14": ["--until", "10", "--step", "2e-4"],
    "fig15": ["--until", "10", "--step", "2e-4"],
    "table3-2hz": ["--until", "4", "--step", "5e-5"],
    "table3-5hz": ["--until", "4", "--step", "5e-5"],
}
COARSE = 1e-2
"""Largest error of the coupling, relative to the energy moved."""


def net_power(netlist: str, case: str) -> str:
    """Net power in mW, or why there is none."""
    with tempfile.TemporaryDirectory() as folder:
        path = CIRCUITS / f"{netlist}.cir"
        command = ["videg", "cosim", "--netlist", path, "--case", case, *CASES[case], "--json", "--output", folder]
        run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode != 0:
        return "stops"
    result = json.loads(run.stdout)
    mark = "*" if result["coupling"]["relative_residual"] > COARSE else ""
    return f"{1e3 * result['net_power']:.3g}{mark}"


def main() -> None:
    print(f"| circuit | {' | '.join(CASES)} |")
    print("|---|" + "---|" * len(CASES))
    for netlist in NETLISTS:
        print(f"| `{netlist}.cir` | {' | '.join(net_power(netlist, case) for case in CASES)} |", flush=True)


if __name__ == "__main__":
    main()
