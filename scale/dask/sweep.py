#!/usr/bin/env python3
"""Runs a `videg sweep` in shards on a Dask cluster: this machine's cores, or a scheduler's workers.

    scale/dask/sweep.py --output out/sweep -- --vary membrane.restitution=0.2:0.9:1000 --samples 20

What stands behind -- goes to videg sweep as it is. Workers need videg, and the folder of the output, at the same paths
as this machine. A task that fails, or whose worker dies, is tried again and goes on where its shard ended; so does the
same command. The result is that of one undivided sweep, byte for byte.
"""

import argparse
import fcntl
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
import uuid
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import tool  # noqa: E402

MOST_SHARDS = 1_000_000
"""As of videg sweep."""

SHORTEST = 1.0
"""Tasks shorter than this are not worth their overhead, s."""

EACH = 4
"""Tasks for each worker at least, so that the last ones end together, unless they would be too short."""

PILOT = 0.5
"""How long the rate is measured for, s."""


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__,
        usage="%(prog)s [OPTIONS] --output DIR -- SWEEP...",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("sweep", nargs="*", metavar="SWEEP", help="what to sweep: file and options of videg sweep")
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder; its shards go to DIR/shards")
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="a running scheduler, e.g. tcp://head:8786 [this machine]"
    )
    parser.add_argument("--workers", type=int, metavar="N", help="workers on this machine [its cores over --jobs]")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="cores of a task [%(default)s]")
    parser.add_argument("--shards", type=int, metavar="N", help="number of shards [from a measured rate]")
    parser.add_argument(
        "--task-seconds",
        type=float,
        default=30.0,
        metavar="S",
        help="how long a task should take at most, s [%(default)s]",
    )
    parser.add_argument(
        "--retries",
        type=int,
        default=3,
        metavar="N",
        help="further tries of a task [%(default)s]; of one whose worker died, with --scheduler as many as that allows",
    )
    parser.add_argument(
        "--timeout", type=float, default=30.0, metavar="S", help="for scheduler and workers, s [%(default)s]"
    )
    parser.add_argument("--videg", metavar="FILE", help="the command-line tool [PATH, or target/release]")
    options = parser.parse_args()
    if "--fresh" in options.sweep:
        raise tool.Problem("--fresh: a task that is tried again would begin anew; remove the folder, or choose another")
    bounds = {"workers": 1, "jobs": 1, "shards": 1, "retries": 0, "task_seconds": SHORTEST, "timeout": 1}
    for name, least in bounds.items():
        value = getattr(options, name)
        if value is not None and not least <= value <= MOST_SHARDS:
            flag = name.replace("_", "-")
            raise tool.Problem(f"--{flag} {value}: must lie from {least} to {MOST_SHARDS}")
    return options


def run_shard(command: list[str], home: str, folder: str, number: int, of: int) -> dict:
    """The task: runs shard `number` of `of` of a sweep into `folder`, from the folder `home`, where the names of files
    start; returns what videg says. A worker gets this function without this file."""
    # A worker that was killed may have left videg behind, which still writes this shard and has it locked: let it.
    try:
        with open(os.path.join(folder, f"sweep.{number}-of-{of}.csv.part"), "r+") as part:
            fcntl.flock(part, fcntl.LOCK_EX)
    except OSError:
        pass  # Nothing is there, or the file system has no locks.
    share = ["--shard", f"{number}/{of}", "--output", folder, "--json"]
    run = subprocess.run([*command, *share], capture_output=True, text=True, cwd=home)
    if run.returncode != 0:
        raise RuntimeError(f"shard {number}/{of}: {run.stderr.strip() or f'exit code {run.returncode}'}")
    return json.loads(run.stdout)


def run_pilot(command: list[str], home: str, folder: str, of: int) -> dict:
    """The task that measures: the first of `of` shards. Each try has a folder of its own, or there would be nothing to
    do."""
    return run_shard(command, home, tempfile.mkdtemp(dir=folder), 1, of)


def connect(options: argparse.Namespace):
    """A client of the scheduler, or of workers on this machine."""
    distributed = tool.need("distributed")
    dask = tool.need("dask")
    # What goes wrong is told once, by this script.
    dask.config.set({"distributed.scheduler.allowed-failures": options.retries, "logging.distributed": "critical"})
    try:
        if options.scheduler:
            client = distributed.Client(options.scheduler, timeout=options.timeout)
            client.wait_for_workers(1, timeout=options.timeout)
            return client
        workers = options.workers or max(1, (os.cpu_count() or 1) // options.jobs)
        return distributed.Client(
            n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, silence_logs=50
        )
    except (OSError, TimeoutError, ValueError) as error:
        where = f"scheduler {options.scheduler}" if options.scheduler else "a scheduler on this machine"
        raise tool.Problem(f"{where}: not reachable with a worker within {options.timeout} s: {error}") from error


def count(command: list[str]) -> int:
    """Runs of the whole sweep. videg checks its arguments for this."""
    return json.loads(tool.videg(command[0], *command[1:], "--check", "--json"))["runs"]


def started_with(folder: Path) -> int | None:
    """Into how many shards the sweep in `folder` was divided before, if it was."""
    found = {int(match[1]) for file in folder.glob("sweep.*") if (match := re.search(r"-of-(\d+)\.csv", file.name))}
    if len(found) > 1:
        raise tool.Problem(
            f"{folder} holds shards of several divisions: {sorted(found)}; remove those that are not wanted"
        )
    return found.pop() if found else None


def rate(options: argparse.Namespace, client, command: list[str], runs: int) -> float:
    """Runs a second of a task, measured by a worker."""
    pilot = 1
    while True:
        with tempfile.TemporaryDirectory(prefix="pilot-", dir=options.output) as folder:
            of = max(1, min(runs // pilot, MOST_SHARDS))
            future = client.submit(
                run_pilot, command, os.getcwd(), folder, of, pure=False, retries=options.retries
            )
            done = outcome(options, future)
        if done["elapsed_s"] >= PILOT or of == 1:
            return done["rate_runs_per_s"]
        pilot *= 4


def outcome(options: argparse.Namespace, future) -> dict:
    """What a task came to."""
    try:
        return future.result()
    except Exception as error:  # What the task raised, or that its workers died.
        raise tool.Problem(f"{future.key} failed {options.retries + 1} times: {error}") from error


def division(options: argparse.Namespace, client, command: list[str], runs: int, workers: int) -> int:
    """Number of shards."""
    before = started_with(options.output / "shards")
    if options.shards and before not in (None, options.shards):
        raise tool.Problem(f"--shards {options.shards}: {options.output}/shards was begun with {before}")
    if before or options.shards:
        return before or options.shards
    seconds = runs / rate(options, client, command, runs)
    wanted = max(seconds / options.task_seconds, EACH * workers)
    return max(1, min(math.floor(min(wanted, seconds / SHORTEST)), runs, MOST_SHARDS))


def run_all(options: argparse.Namespace, client, command: list[str], shards: int) -> list[dict]:
    """Runs all shards; shows how many are done if somebody watches."""
    from distributed import as_completed

    folder, home = str(options.output / "shards"), os.getcwd()
    # Two sweeps on one scheduler must not take each other's tasks for their own.
    sweep = uuid.uuid4().hex

    def submit(number: int):
        key = f"shard-{number}-of-{shards}-{sweep}"
        task = (run_shard, command, home, folder, number, shards)
        return client.submit(*task, pure=False, retries=options.retries, key=key)

    futures = [submit(number) for number in range(1, shards + 1)]
    results = []
    for future in as_completed(futures):
        results.append(outcome(options, future))
        if sys.stderr.isatty():
            print(f"\r{len(results)} of {shards} shards", end="\n" if len(results) == shards else "", file=sys.stderr)
    return results


def run() -> int:
    options = parse()
    options.output = options.output.resolve()
    videg = tool.find_videg(options.videg)
    command = [videg, "sweep", *options.sweep, "--jobs", str(options.jobs)]
    runs = count(command)
    options.output.mkdir(parents=True, exist_ok=True)
    with connect(options) as client:
        threads = sum(client.nthreads().values())
        shards = division(options, client, command, runs, threads)
        started = time.monotonic()
        results = run_all(options, client, command, shards)
        seconds = time.monotonic() - started
    merge = ["merge", str(options.output / "shards"), "--output", str(options.output), "--json"]
    merged = json.loads(tool.videg(videg, "sweep", *merge))
    busy = sum(result["elapsed_s"] for result in results)
    merged |= {"shards": shards, "workers": threads, "seconds": seconds, "busy_s": busy}
    merged["resumed"] = sum(result["resumed_from"] > 0 for result in results)
    print(json.dumps(merged, indent=2))
    return 0 if merged["failed"] < merged["runs"] else 1


if __name__ == "__main__":
    tool.main(run)
