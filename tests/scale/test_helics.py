"""Harvester and circuit as two federates are one process, bit by bit; and no federate outlives the others."""

import json
import signal
import socket
from pathlib import Path

import psutil
import pytest

import harness
from conftest import VIDEG, end, wait_for
from loopback import free_port
from series import rows

QUICK = ("--timeout", "4")
"""So that it is noticed soon that a partner never comes."""

SOON = ("--timeout", "10")
"""So that a lost partner is noticed soon, and one that comes late on a busy machine is not taken for lost."""


@pytest.mark.parametrize(
    "arguments",
    [
        ["--until", "2"],
        ["--until", "2", "--master", "plain", "--step", "2e-3", "--set", "topology=isolated"],
        ["--until", "1", "--set", "contact.law=compliant", "--set", "contact.electrostaticFeedback=true"],
    ],
    ids=["gauss-seidel", "plain", "feedback"],
)
def test_the_federation_is_one_process_to_the_last_bit(run, tmp_path, arguments):
    ended = run("helics/run.py", *arguments, "--output", tmp_path / "two")
    assert ended.returncode == 0, ended.stderr
    expected = harness.videg("cosim", "--circuit", "fmu", *arguments, "--sample", "step", "--output", str(tmp_path / "one"))
    series = rows(tmp_path / "one" / "timeseries.csv")
    federates = [rows(tmp_path / "two" / f"{name}.csv") for name in ("harvester", "circuit")]
    assert [harvester | circuit for harvester, circuit in zip(*federates, strict=True)] == series
    found = json.loads(ended.stdout)
    assert found["energy"] == {name: expected["energy"][name] for name in found["energy"]}
    assert found["charge"] == expected["charge"]


def test_check_compares_with_the_command_line(run, tmp_path):
    """It finds nothing, but with a videg that runs another load."""
    fake = tmp_path / "videg"
    fake.write_text(f'#!/bin/sh\n[ "$1" != cosim ] || set -- "$@" --set load.resistance=2e9\nexec "{VIDEG}" "$@"\n')
    fake.chmod(0o755)
    arguments = ("--until", "0.5", "--check", "--output", tmp_path / "run")
    right = run("helics/run.py", *arguments)
    assert right.returncode == 0 and json.loads(right.stdout)["differences"] == []
    wrong = run("helics/run.py", *arguments, "--videg", fake)
    differences = json.loads(wrong.stdout)["differences"]
    assert wrong.returncode == 1 and "load.energy" in differences and "left.capacitance" not in differences


@pytest.mark.parametrize("victim, survivor", [("harvester", "circuit"), ("circuit", "harvester")])
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP], ids=["dies", "hangs"])
def test_a_federate_ends_with_an_error_when_the_other_dies_or_hangs(start, tmp_path, victim, survivor, how):
    launcher = start("helics/run.py", "--until", "1000", *SOON, "--output", tmp_path)
    wait_for(lambda: (tmp_path / f"{victim}.csv").exists() and (tmp_path / f"{victim}.csv").stat().st_size > 10_000)
    children = psutil.Process(launcher.pid).children()
    (target,) = (child for child in children if f"{victim}_federate.py" in " ".join(child.cmdline()))
    target.send_signal(how)
    ended = end(launcher)
    assert ended.returncode == 2
    assert f"{survivor}_federate.py: the federation broke after" in ended.stderr
    assert ended.stderr.splitlines()[-1].startswith("run.py: the federation failed: ")
    assert f"{victim} " in ended.stderr.splitlines()[-1]


@pytest.fixture
def broker():
    """The address of a broker that waits for two federates."""
    import helics

    port = free_port()
    made = helics.helicsCreateBroker("zmq_ss", "", f"--federates=2 --port={port} --loglevel=no_print")
    yield f"127.0.0.1:{port}"
    helics.helicsBrokerDisconnect(made)


@pytest.fixture(scope="module")
def fmus() -> dict[str, str]:
    return harness.build_fmus()


def federate(name: str, fmus: dict[str, str], folder: Path, broker: str, *arguments: object) -> list[object]:
    fmu = fmus[{"harvester": "VibroImpactHarvester", "circuit": "HarvestingCircuit"}[name]]
    return [
        f"helics/{name}_federate.py",
        "--fmu",
        fmu,
        "--output",
        folder / name,
        "--broker",
        broker,
        *arguments,
    ]


def test_a_federate_that_stays_alone_ends_with_an_error(run, fmus, broker, tmp_path):
    ended = run(*federate("harvester", fmus, tmp_path, broker, *QUICK))
    assert ended.returncode == 2
    assert ended.stderr.splitlines()[-1] == "harvester_federate.py: the other federates did not join within 4.0 s"


def test_without_a_broker_a_federate_ends_with_an_error(run, fmus, tmp_path):
    address = f"127.0.0.1:{free_port()}"
    ended = run(*federate("circuit", fmus, tmp_path, address, *QUICK))
    assert ended.returncode == 2
    assert f"circuit_federate.py: no HELICS broker at {address} within 4.0 s" in ended.stderr


def test_a_broker_that_listens_and_says_nothing_is_told(run, fmus, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as mute:
        address = f"127.0.0.1:{mute.getsockname()[1]}"
        ended = run(*federate("circuit", fmus, tmp_path, address, *QUICK))
    assert ended.returncode == 2
    assert f"circuit_federate.py: the broker at {address} does not answer within 12.0 s" in ended.stderr


@pytest.mark.parametrize(
    "victim, survivor, name, value",
    [
        ("harvester", "circuit", "membrane.restitution", "7"),
        ("circuit", "harvester", "load.resistance", "-1"),
    ],
)
def test_an_fmu_that_fails_ends_both(start, fmus, broker, tmp_path, victim, survivor, name, value):
    parameters = tmp_path / "parameters.ssv"
    parameters.write_text(
        '<s:ParameterSet xmlns:s="http://ssp-standard.org/SSP1/SystemStructureParameterValues"><s:Parameters>'
        f'<s:Parameter name="{name}"><s:Real value="{value}"/></s:Parameter></s:Parameters></s:ParameterSet>'
    )
    other = start(*federate(survivor, fmus, tmp_path, broker))
    failed = end(start(*federate(victim, fmus, tmp_path, broker, "--parameters", parameters)))
    assert failed.returncode == 2 and f"variable {name} = {value}: " in failed.stderr
    assert f"{victim}_federate.py: after 0.0 s an FMU failed: fmi2SetReal" in failed.stderr
    assert end(other).returncode == 2


NAMESPACE = 'xmlns="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
SETS = {
    "no XML": ("membrane.restitution = 0.7", "syntax error: line 1, column 0"),
    "cut off": (f"<ParameterSet {NAMESPACE}><Parameters>", "no element found"),
    "of another kind": ("<html/>", "its root is html, not {http://ssp-standard.org/SSP1/"),
    "without a name": (
        f'<ParameterSet {NAMESPACE}><Parameters><Parameter><Real value="1"/></Parameter></Parameters></ParameterSet>',
        "a parameter has no name or no value",
    ),
    "without a value": (
        f'<ParameterSet {NAMESPACE}><Parameters><Parameter name="ball.mass"/></Parameters></ParameterSet>',
        "a parameter has no name or no value",
    ),
}


@pytest.mark.parametrize("text, said", SETS.values(), ids=SETS.keys())
@pytest.mark.parametrize("name", ["harvester", "circuit"])
def test_a_parameter_set_that_is_malformed_is_refused_by_name(start, fmus, tmp_path, name, text, said):
    parameters = tmp_path / "parameters.ssv"
    parameters.write_text(text)
    failed = end(start(*federate(name, fmus, tmp_path, "127.0.0.1:9", "--parameters", parameters)))
    assert failed.returncode == 2 and f"parameter set {parameters}: {said}" in failed.stderr, failed.stderr


def test_federates_that_were_started_differently_end_with_an_error(start, fmus, broker, tmp_path):
    circuit = start(*federate("circuit", fmus, tmp_path, broker, "--until", "1"))
    harvester = start(*federate("harvester", fmus, tmp_path, broker, "--until", "2"))
    assert end(circuit).returncode == 0
    ended = end(harvester)
    assert ended.returncode == 2 and "the circuit is at 1.0 s in place of" in ended.stderr


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        (["--videg", "/nowhere/videg"], "videg: /nowhere/videg is not there"),
        (["--case", "fig99"], "fig99"),
        (["--set", "membrane.restitutoin=1"], "membrane.restitutoin"),
        (["--step", "1e-6"], "--step 1e-06 s: must lie from 2e-06 s"),
        (["--until", "nan"], "--until nan s: must be positive"),
        (["--timeout", "0"], "--timeout 0.0 s: must lie from 1"),
    ],
)
def test_what_cannot_run_is_one_line_with_exit_code_2(run, tmp_path, arguments, complaint):
    ended = run("helics/run.py", "--output", tmp_path, *arguments)
    assert ended.returncode == 2 and ended.stderr.startswith("run.py: ") and complaint in ended.stderr
    assert len(ended.stderr.splitlines()) == 1


def test_an_fmu_that_is_not_there_is_named(run, broker, tmp_path):
    ended = run("helics/harvester_federate.py", "--fmu", "no.fmu", "--output", tmp_path / "x.csv", "--broker", broker)
    assert ended.returncode == 2 and "harvester_federate.py: FMU no.fmu is not there" in ended.stderr


def test_a_package_that_is_not_installed_is_named(run, tmp_path):
    (tmp_path / "helics.py").write_text("raise ImportError('No module named helics')")
    ended = run("helics/run.py", PYTHONPATH=str(tmp_path))
    assert ended.returncode == 2
    assert ended.stderr == "run.py: helics: No module named helics; pip install -r scale/requirements.txt\n"
