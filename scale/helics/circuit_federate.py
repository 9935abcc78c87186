#!/usr/bin/env python3
"""The FMU HarvestingCircuit as a HELICS federate: publishes voltages, subscribes to capacitances.

With --master gauss-seidel it steps whenever the harvester has stepped, with C(t) linear between both ends of the step;
with --master plain it steps on the regular grid at the same time as the harvester, and C(t) runs behind by a step.
"""

import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import tool  # noqa: E402
from federation import NEVER, Federate, arguments, in_step  # noqa: E402
from schedule import Schedule  # noqa: E402
from slave import Slave, read_parameters  # noqa: E402
from subsystems import CAPACITANCES, VOLTAGES, Circuit  # noqa: E402


def run() -> int:
    options = arguments(__doc__.splitlines()[0]).parse_args()
    plain = options.master == "plain"
    schedule = Schedule(options.step, options.until)
    parameters = read_parameters(options.parameters) if options.parameters else {}
    with (
        Federate("circuit", options, waits=not plain) as federate,
        Slave(options.fmu, "circuit") as slave,
        open(options.output, "w", newline="") as file,
    ):
        series = csv.writer(file, lineterminator="\n")
        series.writerow(["time", *Circuit.RECORDED])
        federate.publications(VOLTAGES, "V")
        federate.publications(["time"], "s")
        federate.subscriptions([f"harvester/{name}" for name in CAPACITANCES], "F")
        federate.subscriptions(["harvester/time"], "s")
        federate.enter()
        *capacitance, now = federate.values()
        circuit = Circuit(slave, parameters, options.until, capacitance)
        federate.publish([*circuit.voltage, now])
        series.writerow([now, *circuit.row])
        while now < options.until:
            granted = federate.request(schedule.next(now) if plain else NEVER)
            if granted >= NEVER:
                raise tool.Problem(f"the harvester ended at {now} s, before --until {options.until} s")
            *capacitance, then = federate.values()
            if plain:
                in_step("harvester", then, now)
                then = schedule.next(now)
            circuit.step(now, then, capacitance)
            federate.publish([*circuit.voltage, then])
            series.writerow([then, *circuit.row])
            now = then
    return 0


if __name__ == "__main__":
    tool.main(run)
