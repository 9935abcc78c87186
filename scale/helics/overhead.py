#!/usr/bin/env python3
"""Measures what a step of the federation costs: the same FMUs, steps and Python code in one process and as federates.

Prints one JSON object: microseconds a communication step, the median over --repeat runs, start-up left out.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import tool  # noqa: E402
from federation import CORES, add_run_options  # noqa: E402
from schedule import Schedule  # noqa: E402
from slave import Slave  # noqa: E402
from subsystems import FMUS, Circuit, Harvester  # noqa: E402


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--videg", metavar="FILE", help="the command-line tool [PATH, or target/release]")
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="runs of each kind [%(default)s]")
    parser.add_argument("--every-core", action="store_true", help="measure every core of HELICS, not only --core")
    add_run_options(parser)
    parser.set_defaults(until=20.0)
    return parser.parse_args()


def one_process(fmus: Path, options: argparse.Namespace) -> float:
    """Both FMUs in this process, coupled in the order of Gauss-Seidel; microseconds a step."""
    until = options.until
    schedule = Schedule(options.step, until)
    files = [fmus / f"{FMUS[name]}.fmu" for name in ("harvester", "circuit")]
    with Slave(files[0], "harvester") as mechanics, Slave(files[1], "circuit") as electrics:
        harvester = Harvester(mechanics, {}, until, extrapolate=True)
        circuit = Circuit(electrics, {}, until, harvester.capacitance)
        started = time.monotonic()
        now, steps = 0.0, 0
        while now < until:
            then = schedule.next(now, harvester.knot)
            harvester.step(now, then, circuit.voltage)
            circuit.step(now, then, harvester.capacitance)
            now, steps = then, steps + 1
        seconds = time.monotonic() - started
    return 1e6 * seconds / steps


def federated(options: argparse.Namespace, videg: str, core: str) -> float:
    """Two federates; microseconds a step."""
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable,
            Path(__file__).with_name("run.py"),
            "--output",
            folder,
            "--videg",
            videg,
            "--core",
            core,
        ]
        command += ["--until", repr(options.until), "--step", repr(options.step), "--timeout", repr(options.timeout)]
        run = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if run.returncode != 0:
        raise tool.Problem(f"run.py ended with exit code {run.returncode}")
    result = json.loads(run.stdout)
    return 1e6 * result["seconds"] / result["steps"]


def median(measure: Callable[[], float], options: argparse.Namespace) -> float:
    return round(statistics.median(measure() for _ in range(options.repeat)), 1)


def run() -> int:
    options = parse()
    if options.repeat < 1:
        raise tool.Problem(f"--repeat {options.repeat}: must be at least 1")
    if options.master != "gauss-seidel":
        raise tool.Problem(f"--master {options.master}: only gauss-seidel is compared, where nothing runs at once")
    videg = tool.find_videg(options.videg)
    fmus = Path(json.loads(tool.videg(videg, "fmu", "build", "--json"))["fmus"][0]).parent
    alone = median(lambda: one_process(fmus, options), options)
    found = {
        core: median(partial(federated, options, videg, core), options)
        for core in (CORES if options.every_core else [options.core])
    }
    overhead = {core: round(value - alone, 1) for core, value in found.items()}
    print(json.dumps({"one_process": alone, "federated": found, "overhead": overhead}, indent=2))
    return 0


if __name__ == "__main__":
    tool.main(run)
