"""Rollback by plain C calls: what one process saves, another goes on from, to the last bit; all else is refused."""

import math
from pathlib import Path

import pytest

import harness
from program import Program, steps

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
def programs(tmp_path_factory) -> dict[str, Program]:
    folder = tmp_path_factory.mktemp("programs")
    return {name: Program(fmu, folder) for name, fmu in harness.build_fmus().items()}


def start(program: Program, values: dict) -> list[str]:
    return [program.set(name, value) for name, value in values.items()] + ["initialize 0"]


def grid(first: int, last: int) -> list[float]:
    return [STEP * index for index in range(first, last + 1)]


def find(harvester: Program, values: dict, wanted) -> int:
    """Number of the first step after which `wanted` of left and right deflection and rest is true."""
    names = ("left.deflection", "right.deflection", "contact.resting")
    commands = [command for step in steps(grid(0, 400)) for command in [step, *harvester.get(*names)]]
    words = [line.split()[1] for line in harvester.values(start(harvester, values) + commands)]
    for index in range(0, len(words), 3):
        left, right = map(float.fromhex, words[index : index + 2])
        if wanted(left, right, words[index + 2] == "1"):
            return index // 3 + 1
    raise AssertionError(f"never in 4 s with {values}")


def goes_on_alike(program: Program, before: list[str], after: list[str], file: Path) -> None:
    """One process runs `before`, saves and runs `after`; another loads and runs `after`."""
    own = program.values([*before, f"save {file}", *program.outputs(), *after])
    found = program.values([f"load {file}", *program.outputs(), *after])
    assert len(set(found)) > 100, "too little happens"
    assert found == own[-len(found) :]


PRESSED = {"in a pulse": lambda left, right, _: left + right > 0.0, "in flight": lambda left, right, _: left + right == 0.0}


@pytest.mark.parametrize("where", PRESSED)
@pytest.mark.parametrize("motion", MOTIONS)
def test_the_harvester_goes_on_to_the_last_bit_in_a_second_process(programs, motion, where, tmp_path):
    harvester, values = programs[HARVESTER], harness.fig14() | MOTIONS[motion]
    saved = find(harvester, values, PRESSED[where])
    check_harvester(harvester, values, saved, tmp_path / "state")


def test_a_resting_harvester_goes_on_to_the_last_bit_in_a_second_process(programs, tmp_path):
    harvester = programs[HARVESTER]
    saved = find(harvester, FLASHLIGHT, lambda _left, _right, resting: resting)
    check_harvester(harvester, FLASHLIGHT, saved, tmp_path / "state")


def check_harvester(harvester: Program, values: dict, saved: int, file: Path) -> None:
    before = start(harvester, values) + steps(grid(0, saved))
    push = harvester.set("externalForce", 0.02)
    later = [command for step in steps(grid(saved, saved + 150)) for command in [step, *harvester.outputs()]]
    goes_on_alike(harvester, before, later[:120] + [push] + later[120:], file)


def squeeze(circuit: Program, first: int, last: int) -> list[str]:
    """Steps in which the left membrane swings between half and two and a half times its capacitance at rest."""
    commands = []
    for time, step in zip(grid(first, last), steps(grid(first, last))):
        capacitance = REST_CAPACITANCE * (1.5 + math.sin(5.0 * time))
        commands += [circuit.set("left.capacitance", capacitance), step, *circuit.outputs()]
    return commands


@pytest.mark.parametrize("settings", CIRCUITS)
def test_the_circuit_goes_on_to_the_last_bit_in_a_second_process(programs, settings, tmp_path):
    circuit = programs[CIRCUIT]
    before = start(circuit, CIRCUITS[settings]) + squeeze(circuit, 0, 170)
    goes_on_alike(circuit, before, squeeze(circuit, 170, 300), tmp_path / "state")


def flipped(state: bytes, offset: int) -> bytes:
    return state[:offset] + bytes([state[offset] ^ 1]) + state[offset + 1 :]


FORMAT_VERSION = 8
"""Offset of the version in a serialised state, after the magic number."""

NO_STATES = {
    "of another version": (lambda own, _: flipped(own, FORMAT_VERSION), "format version"),
    "with a flipped bit": (lambda own, _: flipped(own, len(own) // 2), "checksum"),
    "cut short": (lambda own, _: own[:-1], "bytes given"),
    "too long": (lambda own, _: own + b"\0", "bytes given"),
    "empty": (lambda _, __: b"", "bytes wanted"),
    "of the other FMU": (lambda _, other: other, "belongs to the FMU"),
}


@pytest.mark.parametrize("nonsense", NO_STATES)
@pytest.mark.parametrize("name", [HARVESTER, CIRCUIT])
def test_a_state_that_is_none_of_its_own_is_refused_with_a_reason(programs, name, nonsense, tmp_path):
    states = {}
    for fmu, program in programs.items():
        program.values([*start(program, {}), *steps(grid(0, 20)), f"save {tmp_path / fmu}"])
        states[fmu] = (tmp_path / fmu).read_bytes()
    make, reason = NO_STATES[nonsense]
    (other,) = states.keys() - {name}
    (tmp_path / "bad").write_bytes(make(states[name], states[other]))
    program = programs[name]
    *log, status = program.run([f"load {tmp_path / 'bad'}"])
    assert status == "status fmi2Error"
    assert len(log) == 1 and log[0].startswith("log fmi2Error logStatusError") and reason in log[0], log


@pytest.mark.parametrize("name", [HARVESTER, CIRCUIT])
def test_after_a_refused_state_a_good_one_still_loads(programs, name, tmp_path):
    program, good, bad = programs[name], tmp_path / "good", tmp_path / "bad"
    own = program.values([*start(program, {}), *steps(grid(0, 20)), f"save {good}", *program.outputs()])
    bad.write_bytes(good.read_bytes()[:-1])
    lines = program.run([f"load {bad}", f"load {good}", *program.outputs()])
    assert lines[1] == "status fmi2Error"
    assert [line for line in lines if line.startswith("values")] == own
