"""A sweep on a Dask cluster has the bytes of an undivided one, whatever dies on the way."""

import json
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from conftest import COUPLED, PRECISE, SWEEP, VIDEG, end, same_bytes, wait_for

SCRIPT = "dask/sweep.py"


def test_shards_on_workers_are_the_undivided_sweep(run, undivided, tmp_path):
    ended = run(SCRIPT, "--output", tmp_path, "--workers", 2, "--shards", 7, "--", *SWEEP)
    assert ended.returncode == 0, ended.stderr
    assert same_bytes(tmp_path, undivided)
    result = json.loads(ended.stdout)
    assert (result["shards"], result["workers"], result["runs"], result["failed"]) == (7, 2, 1600, 0)


def test_shards_of_harvester_and_circuit_are_the_undivided_sweep(run, undivided_coupled, tmp_path):
    ended = run(SCRIPT, "--output", tmp_path, "--workers", 2, "--shards", 5, "--", *COUPLED)
    assert ended.returncode == 0, ended.stderr
    assert same_bytes(tmp_path, undivided_coupled)
    assert json.loads(ended.stdout)["runs"] == 36


def test_shards_of_points_with_as_many_samples_as_they_need_are_the_undivided_sweep(run, undivided_precise, tmp_path):
    ended = run(SCRIPT, "--output", tmp_path, "--workers", 2, "--shards", 3, "--", *PRECISE)
    assert ended.returncode == 0, ended.stderr
    assert same_bytes(tmp_path, undivided_precise)
    runs = len((undivided_precise / "sweep.csv").read_text().splitlines()) - 1
    assert json.loads(ended.stdout)["runs"] == runs


def test_tasks_are_as_long_as_the_measured_rate_says(run, undivided, tmp_path):
    ended = run(SCRIPT, "--output", tmp_path, "--workers", 2, "--", *SWEEP)
    assert ended.returncode == 0, ended.stderr
    assert same_bytes(tmp_path, undivided)
    result = json.loads(ended.stdout)
    # A task takes a second at the rate of the pilot; half that allows for a machine whose other work comes and goes.
    assert result["shards"] == 1 or result["busy_s"] / result["shards"] > 0.5


def test_a_worker_killed_with_its_shard_half_done_costs_nothing_but_time(start, undivided, tmp_path):
    script = start(SCRIPT, "--output", tmp_path, "--workers", 2, "--shards", 2, "--", *SWEEP)
    part = tmp_path / "shards" / "sweep.1-of-2.csv.part"
    wait_for(lambda: part.exists() and part.stat().st_size > 3000)
    videg = videg_of(script, "1/2")
    worker = videg.parent()
    videg.kill()
    worker.kill()
    ended = end(script)
    assert ended.returncode == 0, ended.stderr
    assert json.loads(ended.stdout)["resumed"] >= 1
    assert same_bytes(tmp_path, undivided)


def test_a_videg_that_outlives_its_worker_is_not_disturbed(start, undivided, tmp_path):
    script = start(SCRIPT, "--output", tmp_path, "--workers", 2, "--shards", 2, "--", *SWEEP)
    part = tmp_path / "shards" / "sweep.2-of-2.csv.part"
    wait_for(lambda: part.exists() and part.stat().st_size > 3000)
    videg = videg_of(script, "2/2")
    worker = videg.parent()
    videg.suspend()
    worker.kill()
    try:
        # The next try waits for the lock that videg holds.
        launcher = psutil.Process(script.pid)
        wait_for(lambda: any(has_open(process, part) for process in launcher.children(recursive=True)))
    finally:
        videg.resume()
    ended = end(script)
    assert ended.returncode == 0, ended.stderr
    assert same_bytes(tmp_path, undivided)


def test_the_same_command_goes_on_with_the_shards_that_are_there(run, undivided, tmp_path):
    first = run(SCRIPT, "--output", tmp_path, "--workers", 1, "--shards", 3, "--", *SWEEP)
    assert first.returncode == 0, first.stderr
    (tmp_path / "shards" / "sweep.2-of-3.csv").unlink()
    again = run(SCRIPT, "--output", tmp_path, "--workers", 1, "--", *SWEEP)
    result = json.loads(again.stdout)
    assert (result["shards"], result["resumed"]) == (3, 2)
    assert same_bytes(tmp_path, undivided)
    other = run(SCRIPT, "--output", tmp_path, "--workers", 1, "--shards", 4, "--", *SWEEP)
    assert other.returncode == 2 and "--shards 4" in other.stderr and "was begun with 3" in other.stderr


def address_in(file: Path) -> str | None:
    """The address of a scheduler, once it has written it to the end."""
    try:
        return json.loads(file.read_text())["address"]
    except json.JSONDecodeError:
        return None


def videg_of(script: subprocess.Popen, shard: str) -> psutil.Process:
    """The videg that runs this shard for the script. Others of its processes come and go meanwhile."""

    def runs_it(process: psutil.Process) -> bool:
        try:
            return shard in process.cmdline()
        except psutil.NoSuchProcess:
            return False

    (found,) = filter(runs_it, psutil.Process(script.pid).children(recursive=True))
    return found


def has_open(process: psutil.Process, file: Path) -> bool:
    try:
        return str(file) in (opened.path for opened in process.open_files())
    except psutil.Error:
        return False


def test_a_scheduler_elsewhere_runs_the_tasks(run, undivided, tmp_path):
    environment = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    file = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "distributed.cli"]
    scheduler = [*dask[:2], "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    worker = [*dask[:2], "distributed.cli.dask_worker", "--nthreads", "1", "--no-dashboard"]
    processes = [subprocess.Popen([*scheduler, "--scheduler-file", file], **environment)]
    try:
        address = wait_for(lambda: file.exists() and address_in(file))
        processes.append(subprocess.Popen([*worker, address], cwd=tmp_path, **environment))
        ended = run(SCRIPT, "--output", tmp_path / "out", "--scheduler", address, "--shards", 2, "--", *SWEEP)
    finally:
        for process in processes:
            process.terminate()
            process.wait()
    assert ended.returncode == 0, ended.stderr
    assert same_bytes(tmp_path / "out", undivided)


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        (
            ["--scheduler", "tcp://127.0.0.1:9", "--timeout", "1", "--", *SWEEP],
            "scheduler tcp://127.0.0.1:9: not reachable",
        ),
        (["--scheduler", "nonsense://x", "--timeout", "1", "--", *SWEEP], "scheduler nonsense://x"),
        (["--shards", "0", "--", *SWEEP], "--shards 0: must lie from 1 to 1000000"),
        (["--", *SWEEP, "--fresh"], "--fresh: a task that is tried again would begin anew"),
        (["--videg", "/nowhere/videg", "--", *SWEEP], "/nowhere/videg is not there"),
        (["--", "--vary", "membrane.restitutoin=0:1:2"], "membrane.restitutoin"),
    ],
)
def test_what_cannot_run_is_an_error_with_exit_code_2(run, tmp_path, arguments, complaint):
    ended = run(SCRIPT, "--output", tmp_path, *arguments)
    assert ended.returncode == 2
    assert ended.stderr.splitlines()[0].startswith("sweep.py: ") and complaint in ended.stderr


def test_a_task_that_always_fails_ends_the_sweep_with_its_reason(run, tmp_path):
    fake = tmp_path / "videg"
    fake.write_text(
        f'#!/bin/sh\ncase "$*" in *shards*) echo "videg: no space left" >&2; exit 2;; esac\nexec "{VIDEG}" "$@"\n'
    )
    fake.chmod(0o755)
    arguments = ["--workers", 1, "--shards", 2, "--retries", 1, "--videg", fake, "--", *SWEEP]
    ended = run(SCRIPT, "--output", tmp_path / "out", *arguments)
    assert ended.returncode == 2
    assert "failed 2 times" in ended.stderr and "videg: no space left" in ended.stderr
