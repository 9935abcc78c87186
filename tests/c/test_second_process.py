"""What one process saves, another goes on from, to the last bit; all else is refused."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

import harness

FMI2_ERROR = 3
HARVESTER, CIRCUIT = "VibroImpactHarvester", "HarvestingCircuit"
STEP = 0.01

NOISE = {"excitation.phaseNoise": 0.7, "excitation.noiseHold": 1e-3, "excitation.seed": 5}
MOTIONS = {
    "quiet": {},
    "held noise": NOISE | {"excitation.noiseModel": 1},
    "Wiener noise": NOISE | {"excitation.noiseModel": 2},
}
FLASHLIGHT = {
    "cylinder.mass": 0.012,
    "cylinder.length": 42.2e-6 / (math.pi * 0.008**2) - 2.0 * 0.006,
    "ball.mass": 0.053,
    "ball.radius": 0.0075,
    "membrane.initialRadius": 0.004,
    "membrane.restitution": 0.5,
    "excitation.amplitude": 5.0,
}
"""Table 3 at 2 Hz, where the ball rests for a part of each cycle."""

CIRCUITS = {
    "as the paper": {},
    "isolated, switch": {"topology": 2, "release": 2, "zener.voltage": 2400.0},
    "exponential diodes": {"diode.model": 2},
}
REST_CAPACITANCE = 1.501476744842152e-11


@pytest.fixture(scope="module")
def fmus() -> dict[str, str]:
    return harness.build_fmus()


def run(fmu: str, commands: list[list]) -> list[list]:
    """What a new process answers: value, status of an error and log of each command."""
    command = [sys.executable, Path(__file__).with_name("second_process.py"), fmu]
    finished = subprocess.run(command, input=json.dumps(commands), stdout=subprocess.PIPE, check=True, text=True)
    return json.loads(finished.stdout)


def values(fmu: str, commands: list[list]) -> list[list]:
    """The values that a new process reads, to the last bit; no call may fail."""
    answers = run(fmu, commands)
    assert [error for _, error, _ in answers if error] == []
    return [value for value, _, _ in answers if value]


def start(values: dict) -> list:
    return ["start", values]


def grid(first: int, last: int) -> list[float]:
    return [STEP * index for index in range(first, last + 1)]


def steps(times: list[float]) -> list[list]:
    return [["step", now, then - now] for now, then in zip(times, times[1:])]


def find(harvester: str, settings: dict, wanted) -> int:
    """Number of the first step after which `wanted` of left and right deflection and rest is true."""
    read = ["get", "left.deflection", "right.deflection", "contact.resting"]
    commands = [command for step in steps(grid(0, 400)) for command in (step, read)]
    for index, state in enumerate(values(harvester, [start(settings), *commands])):
        if wanted(*state):
            return index + 1
    raise AssertionError(f"never in 4 s with {settings}")


def goes_on_alike(fmu: str, before: list, after: list, file: Path) -> None:
    """One process runs `before`, saves and runs `after`; another loads and runs `after`."""
    own = values(fmu, [*before, ["save", str(file)], ["outputs"], *after])
    found = values(fmu, [["load", str(file)], ["outputs"], *after])
    assert len({tuple(read) for read in found}) > 100, "too little happens"
    assert found == own[-len(found) :]


PRESSED = {"in a pulse": lambda left, right, _: left + right > 0.0, "in flight": lambda left, right, _: left + right == 0.0}


@pytest.mark.parametrize("where", PRESSED)
@pytest.mark.parametrize("motion", MOTIONS)
def test_the_harvester_goes_on_to_the_last_bit_in_a_second_process(fmus, motion, where, tmp_path):
    check_harvester(fmus[HARVESTER], harness.fig14() | MOTIONS[motion], PRESSED[where], tmp_path / "state")


def test_a_resting_harvester_goes_on_to_the_last_bit_in_a_second_process(fmus, tmp_path):
    check_harvester(fmus[HARVESTER], FLASHLIGHT, lambda _left, _right, resting: resting, tmp_path / "state")


def check_harvester(harvester: str, settings: dict, wanted, file: Path) -> None:
    saved = find(harvester, settings, wanted)
    before = [start(settings), *steps(grid(0, saved))]
    later = [command for step in steps(grid(saved, saved + 150)) for command in (step, ["outputs"])]
    push = ["set", {"externalForce": 0.02}]
    goes_on_alike(harvester, before, [*later[:120], push, *later[120:]], file)


def squeeze(first: int, last: int) -> list[list]:
    """Steps in which the left membrane swings between half and two and a half times its capacitance at rest."""
    commands = []
    for time, step in zip(grid(first, last), steps(grid(first, last))):
        capacitance = REST_CAPACITANCE * (1.5 + math.sin(5.0 * time))
        commands += [["set", {"left.capacitance": capacitance}], step, ["outputs"]]
    return commands


@pytest.mark.parametrize("settings", CIRCUITS)
def test_the_circuit_goes_on_to_the_last_bit_in_a_second_process(fmus, settings, tmp_path):
    before = [start(CIRCUITS[settings]), *squeeze(0, 170)]
    goes_on_alike(fmus[CIRCUIT], before, squeeze(170, 300), tmp_path / "state")


def flipped(state: bytes, offset: int) -> bytes:
    return state[:offset] + bytes([state[offset] ^ 1]) + state[offset + 1 :]


FORMAT_VERSION = 8
"""Offset of the version in a serialised state, after the magic number."""

NO_STATES = {
    "of another version": (lambda own, _: flipped(own, FORMAT_VERSION), "format version"),
    "with a flipped bit": (lambda own, _: flipped(own, len(own) // 2), "checksum"),
    "cut short": (lambda own, _: own[:-1], "bytes given"),
    "too long": (lambda own, _: own + b"\0", "bytes given"),
    "empty": (lambda _, __: b"", "bytes given"),
    "of the other FMU": (lambda _, other: other, "belongs to the FMU"),
}


@pytest.fixture(scope="module")
def states(fmus, tmp_path_factory) -> dict[str, bytes]:
    """A state of each FMU after 0.2 s."""
    files = {name: tmp_path_factory.mktemp(name) / "state" for name in fmus}
    for name, file in files.items():
        values(fmus[name], [start({}), *steps(grid(0, 20)), ["save", str(file)]])
    return {name: file.read_bytes() for name, file in files.items()}


@pytest.mark.parametrize("nonsense", NO_STATES)
@pytest.mark.parametrize("name", [HARVESTER, CIRCUIT])
def test_a_state_that_is_none_of_its_own_is_refused_with_a_reason(fmus, states, name, nonsense, tmp_path):
    make, reason = NO_STATES[nonsense]
    (other,) = states.keys() - {name}
    (tmp_path / "bad").write_bytes(make(states[name], states[other]))
    (tmp_path / "good").write_bytes(states[name])
    bad, good, outputs = run(fmus[name], [["load", str(tmp_path / "bad")], ["load", str(tmp_path / "good")], ["outputs"]])
    _, error, [[status, category, text]] = bad
    assert [error, status, category] == [FMI2_ERROR, FMI2_ERROR, "logStatusError"] and reason in text
    # A good state still loads after it.
    assert [good[1], outputs[1]] == [None, None]
    own = values(fmus[name], [start({}), *steps(grid(0, 20)), ["outputs"]])
    assert [outputs[0]] == own
