#!/usr/bin/env python3
"""Runs harvester and circuit as two HELICS federates on this machine: two processes and a broker on loopback.

Writes harvester.csv, circuit.csv and result.json; --check compares them with `videg cosim --circuit fmu`, bit by bit.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import tool  # noqa: E402
from federation import add_run_options, core_options, helics  # noqa: E402
from loopback import free_port  # noqa: E402
from schedule import Schedule  # noqa: E402
from series import rows  # noqa: E402
from subsystems import FMUS  # noqa: E402


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", default="fig14", help="published case, as of videg cosim [%(default)s]")
    parser.add_argument(
        "--set", action="append", default=[], metavar="VARIABLE=VALUE", help="set a parameter; may be repeated"
    )
    parser.add_argument("--output", type=Path, default=Path("out/helics"), metavar="DIR", help="folder [%(default)s]")
    parser.add_argument("--videg", metavar="FILE", help="the command-line tool [PATH, or target/release]")
    parser.add_argument(
        "--check", action="store_true", help="compare with videg cosim --circuit fmu; exit code 1 if it differs"
    )
    add_run_options(parser)
    return parser.parse_args()


def package(options: argparse.Namespace, videg: str) -> None:
    """Both FMUs and their parameters, from the system package, into the folder of the output."""
    options.output.mkdir(parents=True, exist_ok=True)
    ssp = json.loads(tool.videg(videg, "ssp", *case(options), "--output", str(options.output), "--json"))["ssp"]
    with zipfile.ZipFile(ssp) as archive:
        archive.extractall(options.output)


def case(options: argparse.Namespace) -> list[str]:
    """The options that say what to run, as videg has them."""
    settings = [word for setting in options.set for word in ("--set", setting)]
    return ["--case", options.case, "--until", repr(options.until), *settings]


def start(options: argparse.Namespace, federate: str, port: int) -> subprocess.Popen:
    """A federate in a process of its own."""
    resources = options.output / "resources"
    command = [sys.executable, Path(__file__).with_name(f"{federate}_federate.py")]
    command += ["--fmu", resources / f"{FMUS[federate]}.fmu", "--parameters", resources / f"{federate}.ssv"]
    command += ["--output", options.output / f"{federate}.csv", "--broker", f"127.0.0.1:{port}"]
    for name in ("until", "step", "master", "core", "timeout"):
        command += [f"--{name}", str(getattr(options, name))]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def federate(options: argparse.Namespace) -> dict:
    """Runs broker and federates to the end; returns the number of steps and the seconds that they took."""
    port = free_port()
    settings = f"--federates={len(FMUS)} --port={port} {core_options(options.timeout)}"
    try:
        broker = helics.helicsCreateBroker(options.core, "", settings)
    except helics.HelicsException as error:
        helics.helicsCloseLibrary()
        raise tool.Problem(f"no HELICS broker on port {port}: {error}") from error
    processes = {}
    try:
        for name in FMUS:
            processes[name] = start(options, name, port)
        watch(processes, 3.0 * options.timeout)
        return json.loads(processes["harvester"].communicate()[0].splitlines()[-1])
    finally:
        for process in processes.values():
            process.kill()
            process.wait()
        helics.helicsBrokerDisconnect(broker)
        helics.helicsCloseLibrary()


def watch(processes: dict[str, subprocess.Popen], grace: float) -> None:
    """Waits for all processes; once one has failed, no longer than `grace`, s, for the others."""
    deadline = float("inf")
    while any(process.poll() is None for process in processes.values()) and time.monotonic() < deadline:
        if any(process.poll() for process in processes.values()):
            deadline = min(deadline, time.monotonic() + grace)
        time.sleep(0.01)
    failed = {name: process.poll() for name, process in processes.items() if process.poll() != 0}
    if failed:
        ends = (f"{name} {'still running' if code is None else f'exit code {code}'}" for name, code in failed.items())
        raise tool.Problem(f"the federation failed: {', '.join(ends)}")


def summary(options: argparse.Namespace, effort: dict) -> dict:
    """What the run comes to, with the keys of videg cosim --json, and the effort that it took."""
    last, harvester = rows(options.output / "circuit.csv")[-1], rows(options.output / "harvester.csv")[-1]
    energy = {name: last[f"{name}.energy"] for name in ("supply", "load", "zener", "diode", "leakage", "stored")}
    given = energy["load"] + energy["zener"] + energy["diode"] + energy["leakage"] + energy["stored"]
    energy["converted"] = given - energy["supply"]
    energy |= {"surplus": energy["load"] - energy["supply"], "eq13": harvester["gain.energyEq13"]}
    charge = {name: last[f"{name}.charge"] for name in ("supply", "load")}
    run = {"case": options.case, "until": options.until, "step": options.step, "master": options.master}
    return run | {"energy": energy, "charge": charge} | effort


def differences(options: argparse.Namespace, videg: str) -> list[str]:
    """Columns that are not those of one process, bit by bit."""
    with tempfile.TemporaryDirectory() as folder:
        run = [
            "--step",
            repr(options.step),
            "--master",
            options.master,
            "--circuit",
            "fmu",
            "--sample",
            "step",
            "--output",
            folder,
            "--json",
        ]
        tool.videg(videg, "cosim", *case(options), *run)
        expected = rows(Path(folder) / "timeseries.csv")
    harvester, circuit = (rows(options.output / f"{name}.csv") for name in FMUS)
    found = [mechanics | electrics for mechanics, electrics in zip(harvester, circuit)]
    if len(harvester) != len(expected) or len(circuit) != len(expected):
        return [f"rows: {len(harvester)} and {len(circuit)} in place of {len(expected)}"]
    return [name for name in expected[0] if any(ours[name] != theirs[name] for ours, theirs in zip(found, expected))]


def run() -> int:
    options = parse()
    videg = tool.find_videg(options.videg)
    Schedule(options.step, options.until)
    package(options, videg)
    result = summary(options, federate(options))
    different = differences(options, videg) if options.check else []
    result |= {"differences": different} if options.check else {}
    text = json.dumps(result, indent=2)
    (options.output / "result.json").write_text(text + "\n")
    print(text)
    return 1 if different else 0


if __name__ == "__main__":
    tool.main(run)
