#!/usr/bin/env python3
"""Measures what a task on Dask costs, with one worker on this machine: N tasks that do nothing, N that start videg, and
videgs started without Dask. Prints one JSON object: milliseconds a task."""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import tool  # noqa: E402


def nothing(_: int) -> int:
    """The empty task."""
    return 0


def milliseconds(run: Callable[[], object], tasks: int) -> float:
    started = time.monotonic()
    run()
    return round(1e3 * (time.monotonic() - started) / tasks, 2)


def run() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=200, metavar="N", help="number of tasks [%(default)s]")
    parser.add_argument("--videg", metavar="FILE", help="the command-line tool [PATH, or target/release]")
    options = parser.parse_args()
    if options.tasks < 1:
        raise tool.Problem(f"--tasks {options.tasks}: must be at least 1")
    distributed = tool.need("distributed")
    videg = tool.find_videg(options.videg)

    def start_videg(_: int) -> int:
        return subprocess.run([videg, "--version"], stdout=subprocess.DEVNULL).returncode

    numbers = range(options.tasks)
    with distributed.Client(n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as client:
        client.submit(nothing, 0, pure=False).result()  # The first one waits for the worker.
        found = {
            "empty_task": milliseconds(lambda: client.gather(client.map(nothing, numbers, pure=False)), options.tasks),
            "task_that_starts_videg": milliseconds(
                lambda: client.gather(client.map(start_videg, numbers, pure=False)), options.tasks
            ),
            "videg_without_dask": milliseconds(lambda: [start_videg(number) for number in numbers], options.tasks),
        }
    print(json.dumps(found, indent=2))
    return 0


if __name__ == "__main__":
    tool.main(run)
