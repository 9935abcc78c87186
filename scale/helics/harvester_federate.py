#!/usr/bin/env python3
"""The FMU VibroImpactHarvester as a HELICS federate: publishes capacitances, subscribes to voltages.

It sets the pace: it lands on impacts and on the knots of C(t), and publishes where, because HELICS counts nanoseconds.
At the end it prints the number of steps and the seconds that they took, start-up left out, as a JSON object.
"""

import csv
import json
import math
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import tool  # noqa: E402
from federation import Federate, arguments, in_step  # noqa: E402
from schedule import Schedule  # noqa: E402
from slave import Slave, read_parameters  # noqa: E402
from subsystems import CAPACITANCES, VOLTAGES, Harvester  # noqa: E402


def run() -> int:
    options = arguments(__doc__.splitlines()[0]).parse_args()
    plain = options.master == "plain"
    schedule = Schedule(options.step, options.until)
    parameters = read_parameters(options.parameters) if options.parameters else {}
    with (
        Federate("harvester", options, waits=False) as federate,
        Slave(options.fmu, "harvester") as slave,
        open(options.output, "w", newline="") as file,
    ):
        series = csv.writer(file, lineterminator="\n")
        series.writerow(["time", *Harvester.RECORDED])
        harvester = Harvester(slave, parameters, options.until, extrapolate=not plain)
        federate.publications(CAPACITANCES, "F")
        federate.publications(["time"], "s")
        federate.subscriptions([f"circuit/{name}" for name in VOLTAGES], "V")
        federate.subscriptions(["circuit/time"], "s")
        federate.enter([*harvester.capacitance, 0.0])
        started, steps, now = time.monotonic(), 0, 0.0
        series.writerow([now, *harvester.row])
        while now < options.until:
            then = schedule.next(now, math.inf if plain else harvester.knot)
            federate.request(then)
            *voltage, of_circuit = federate.values()
            in_step("circuit", of_circuit, now)
            harvester.step(now, then, voltage)
            federate.publish([*harvester.capacitance, then])
            series.writerow([then, *harvester.row])
            now, steps = then, steps + 1
        seconds = time.monotonic() - started
    print(json.dumps({"steps": steps, "seconds": seconds}))
    return 0


if __name__ == "__main__":
    tool.main(run)
