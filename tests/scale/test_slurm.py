"""A sweep as an array of Slurm, on a cluster of this machine alone, has the bytes of an undivided one."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

import harness
from conftest import COUPLED, SWEEP, VIDEG, same_bytes, wait_for

SUBMIT = "slurm/submit.sh"
PATH = f"{os.environ['PATH']}:/usr/sbin:/sbin"


@pytest.fixture(scope="module")
def slurm() -> None:
    if not all(shutil.which(name, path=PATH) for name in ("munged", "slurmctld", "slurmd", "sbatch")):
        assert not os.environ.get("VIDEG_ALL_TOOLS"), "Slurm is not installed"
        pytest.skip("Slurm is not installed")


@pytest.fixture(scope="module")
def cluster(slurm, tmp_path_factory) -> str:
    """The configuration of a cluster."""
    folder = tmp_path_factory.mktemp("slurm") / "cluster"
    loopback = harness.ROOT / "scale" / "slurm" / "loopback.sh"
    subprocess.run([loopback, "start", folder], check=True)
    yield str(folder / "slurm.conf")
    subprocess.run([loopback, "stop", folder], check=True)


def test_a_daemon_that_does_not_start_is_told(run, slurm, tmp_path):
    """A socket has no more than 107 characters."""
    folder = tmp_path / ("x" * 100)
    ended = run("slurm/loopback.sh", "start", folder)
    assert ended.returncode == 2
    assert ended.stderr == f"loopback.sh: munged, slurmctld or slurmd did not start; see {folder}/*.log\n"


def test_an_overhead_that_cannot_be_measured_is_an_error(run, tmp_path):
    """Neither where Slurm refuses the tasks, nor where one of them fails."""
    sbatch = tmp_path / "sbatch"
    environment = {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    for refused, complaint in (("--array", "sbatch refuses the array"), ("--wait", "a task of job 7 failed")):
        sbatch.write_text(f'#!/bin/sh\necho 7\ncase "$*" in *{refused}*) exit 1; esac\n')
        sbatch.chmod(0o755)
        ended = run("slurm/overhead.sh", 2, **environment)
        assert (ended.returncode, ended.stdout) == (2, "") and complaint in ended.stderr, ended


def finished(cluster: str, folder: Path) -> bool:
    """Whether nothing is queued any more."""
    environment = os.environ | {"SLURM_CONF": cluster}
    queue = subprocess.run(["squeue", "--noheader"], env=environment, capture_output=True, text=True, check=True)
    return not queue.stdout.strip()


def test_an_array_is_the_undivided_sweep(run, cluster, undivided, tmp_path):
    submitted = run(SUBMIT, "--shards", 4, "--output", tmp_path, "--videg", VIDEG, "--", *SWEEP, SLURM_CONF=cluster)
    assert submitted.returncode == 0, submitted.stderr
    wait_for(lambda: finished(cluster, tmp_path))
    assert same_bytes(tmp_path, undivided), [log.read_text() for log in (tmp_path / "log").iterdir()]


def test_an_array_of_harvester_and_circuit_is_the_undivided_sweep(run, cluster, undivided_coupled, tmp_path):
    submitted = run(SUBMIT, "--shards", 3, "--output", tmp_path, "--videg", VIDEG, "--", *COUPLED, SLURM_CONF=cluster)
    assert submitted.returncode == 0, submitted.stderr
    wait_for(lambda: finished(cluster, tmp_path))
    assert same_bytes(tmp_path, undivided_coupled), [log.read_text() for log in (tmp_path / "log").iterdir()]


def test_a_task_that_failed_goes_on_when_it_is_submitted_again(run, cluster, undivided, tmp_path):
    """The second task is killed once it has written something, and nothing is merged before it is done."""
    killer = tmp_path / "videg"
    part = tmp_path / "out" / "shards" / "sweep.2-of-3.csv.part"
    killer.write_text(
        '#!/bin/bash\ncase "$*" in\n'
        f'*" 2/3 "*) "{VIDEG}" "$@" & child=$!\n'
        f'   while kill -0 $child && [ "$(cat "{part}" 2>/dev/null | wc -c)" -le 3000 ]; do sleep 0.01; done\n'
        "   kill -KILL $child; exit 137 ;;\n"
        f'*) exec "{VIDEG}" "$@" ;;\nesac\n'
    )
    killer.chmod(0o755)
    arguments = ("--shards", 3, "--output", tmp_path / "out")
    first = run(SUBMIT, *arguments, "--videg", killer, "--", *SWEEP, SLURM_CONF=cluster)
    assert first.returncode == 0, first.stderr
    wait_for(lambda: finished(cluster, tmp_path))
    assert part.exists() and not (tmp_path / "out" / "sweep.csv").exists()
    again = run(SUBMIT, *arguments, "--only", "2", "--videg", VIDEG, "--", *SWEEP, SLURM_CONF=cluster)
    assert again.returncode == 0, again.stderr
    wait_for(lambda: finished(cluster, tmp_path))
    assert "that were there" in (tmp_path / "out" / "log" / "shard-2.log").read_text()
    assert same_bytes(tmp_path / "out", undivided)


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        (["--shards", "0", "--", *SWEEP], "--shards 0: must be a number from 1"),
        (["--", *SWEEP], "--shards (missing): must be a number"),
        (["--shards", "2"], "what to sweep is missing"),
        (["--shards", "1001", "--", *SWEEP], "must be below the MaxArraySize of this cluster, 1001"),
        (["--shards", "2", "--videg", "/nowhere/videg", "--", *SWEEP], "/nowhere/videg is neither a program"),
        (["--shards", "2", "--videg", VIDEG, "--", "--vary", "nonsense=0:1:2"], "videg refuses this sweep"),
        (["--shards", "2", "--only", "1,3", "--", *SWEEP], "--only 1,3: the last task is 2"),
        (["--shards", "2", "--only", "all", "--", *SWEEP], "--only all: must be a list"),
        (["--shards", "2", "--", *SWEEP, "--fresh"], "--fresh: a task that runs again would begin anew"),
        (["--nodes", "2", "--", *SWEEP], "--nodes: no such option"),
    ],
)
def test_what_cannot_be_submitted_is_refused(run, cluster, tmp_path, arguments, complaint):
    ended = run(SUBMIT, "--output", tmp_path / "out", *arguments, SLURM_CONF=cluster)
    assert ended.returncode == 2 and complaint in ended.stderr.splitlines()[-1]
    assert not (tmp_path / "out").exists()


def test_another_division_of_what_is_there_is_refused(run, cluster, tmp_path):
    (tmp_path / "shards").mkdir()
    (tmp_path / "shards" / "sweep.2-of-3.csv.part").touch()
    ended = run(SUBMIT, "--shards", 4, "--output", tmp_path, "--", *SWEEP, SLURM_CONF=cluster)
    assert ended.returncode == 2 and "--shards 4" in ended.stderr and "was begun with 3" in ended.stderr


def test_an_array_without_its_merge_is_cancelled(run, cluster, tmp_path):
    merge = ("--sbatch-merge", "--partition=nowhere")
    ended = run(SUBMIT, "--shards", 2, "--output", tmp_path, *merge, "--", *SWEEP, SLURM_CONF=cluster)
    assert ended.returncode == 2 and "sbatch refuses the merge" in ended.stderr.splitlines()[-1]
    wait_for(lambda: finished(cluster, tmp_path))


def test_shellcheck_has_nothing_to_say():
    shellcheck = shutil.which("shellcheck")
    if shellcheck is None:
        assert not os.environ.get("VIDEG_ALL_TOOLS"), "shellcheck is not installed"
        pytest.skip("shellcheck is not installed")
    scripts = sorted((harness.ROOT / "scale" / "slurm").glob("*.s[hb]*"))
    assert len(scripts) == 6
    subprocess.run([shellcheck, *scripts], check=True)
