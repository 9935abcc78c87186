"""The FMUs of FMI 3.0: FMPy takes them, their results are those of FMI 2.0, and every impact is seen at its time."""

import _ctypes
import ctypes
import re
import resource
import shutil
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import printLogMessage
from fmpy.fmi2 import defaultCallbacks, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy
from fmpy.validation import validate_fmu
from lxml import etree

import harness

HARVESTER, CIRCUIT = "VibroImpactHarvester", "HarvestingCircuit"
STOP_TIME, INTERVAL = 4.0, 0.05
OUTPUTS = ["ball.position", "cylinder.velocity", "left.capacitance", "right.capacitance", "gain.voltage", "energy.kinetic"]
SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3"


@pytest.fixture(scope="module")
def fmus3() -> dict[str, str]:
    """The FMUs of FMI 3.0 by model identifier, freshly packaged."""
    return harness.build_fmus("--fmi", "3")


def machine(seed: int) -> dict[str, float | int]:
    """Start values of a random machine: any law, with and without noise, gravity, friction and a suspension."""
    random = np.random.default_rng(seed)
    frequency = random.uniform(0.5, 8.0)
    values = {
        "excitation.amplitude": random.uniform(0.2, 8.0),
        "excitation.frequency": frequency,
        "membrane.restitution": random.uniform(0.1, 0.95),
        "ball.mass": random.uniform(0.001, 0.02),
        "cylinder.length": random.uniform(0.03, 0.3),
        "initial.ballVelocity": random.uniform(-0.5, 0.5),
    }
    choices = random.integers(0, 2, 5)
    if choices[0]:
        values |= {"contact.law": 2, "contact.reaction": bool(random.integers(0, 2))}
    if choices[1]:
        values |= {"excitation.phaseNoise": random.uniform(0.1, 2.0), "excitation.noiseHold": random.uniform(0.2, 1.0) / frequency}
    if choices[2]:
        values |= {"cylinder.inclination": random.uniform(0.0, 1.5), "gravity": 9.81}
    if choices[3]:
        values |= {"ball.friction": random.uniform(0.0, 0.2), "gravity": 9.81}
    if choices[4]:
        values |= {"cylinder.suspensionStiffness": random.uniform(1.0, 50.0), "cylinder.suspensionDamping": 0.2}
    return values


def run(fmu: str, values: dict, **options):
    return fmpy.simulate_fmu(
        fmu, stop_time=STOP_TIME, output_interval=INTERVAL, start_values=values, output=OUTPUTS, **options
    )


def logged_impacts(fmu: str, values: dict) -> tuple[list[tuple[float, str, float]], bool]:
    """Time, side and speed of each impact, as FMI 2.0 logs them: with every bit; and whether the ball ever comes to rest."""
    lines = []
    fmpy.simulate_fmu(
        fmu,
        stop_time=STOP_TIME,
        output_interval=STOP_TIME,
        start_values=values,
        debug_logging=True,
        logger=lambda *line: lines.append(line[-1].decode()),
    )
    # FMPy has one logger for the whole process, which is gone now: the one of before comes back.
    defaultCallbacks.logger = fmi2CallbackLoggerTYPE(printLogMessage)
    addLoggerProxy(ctypes.byref(defaultCallbacks))
    pattern = re.compile(r"impact \d+ at t = (\S+) s on the (\w+) membrane, relative speed ([^ ;]+) m/s")
    found = [pattern.match(line) for line in lines]
    return [(float(it[1]), it[2], float(it[3])) for it in found if it], any("rests" in line for line in lines)


@pytest.fixture
def slave3(fmus3):
    """Makes slaves of FMI 3.0 and takes them away after the test."""
    made = []

    def make(**options) -> FMU3Slave:
        folder = fmpy.extract(fmus3[HARVESTER])
        description = fmpy.read_model_description(folder)
        slave = FMU3Slave(
            guid=description.instantiationToken,
            modelIdentifier=HARVESTER,
            unzipDirectory=folder,
            instanceName="harvester",
        )
        slave.variables = {variable.name: variable for variable in description.modelVariables}
        slave.instantiate(**options)
        made.append((slave, folder))
        return slave

    yield make
    for slave, folder in made:
        slave.freeInstance()
        shutil.rmtree(folder)


def begin(slave, values: dict) -> None:
    """Initialised at 0 s with these values."""
    setters = {"Float64": slave.setFloat64, "Enumeration": slave.setInt64, "Boolean": slave.setBoolean}
    for name, value in values.items():
        variable = slave.variables[name]
        setters[variable.type]([variable.valueReference], [value])
    slave.enterInitializationMode()
    slave.exitInitializationMode()


def references(slave, *names: str) -> list[int]:
    return [slave.variables[name].valueReference for name in names]


def test_fmpy_finds_no_problem(fmus3):
    for fmu in fmus3.values():
        assert validate_fmu(fmu) == []


def test_terminals_and_icons_are_as_the_schema_wants_them(fmus3):
    schema = etree.XMLSchema(etree.parse(str(SCHEMA / "fmi3TerminalsAndIcons.xsd")))
    members = {}
    for identifier, fmu in fmus3.items():
        folder = Path(fmpy.extract(fmu))
        document = etree.parse(str(folder / "terminalsAndIcons" / "terminalsAndIcons.xml"))
        schema.assertValid(document)
        assert (folder / "terminalsAndIcons" / "icon.png").read_bytes().startswith(b"\x89PNG")
        variables = {variable.name for variable in fmpy.read_model_description(folder).modelVariables}
        rows = document.findall(".//TerminalMemberVariable")
        assert {row.get("variableName") for row in rows} <= variables
        members[identifier] = [(row.getparent().get("name"), row.get("memberName")) for row in rows]
        shutil.rmtree(folder)
    assert members[HARVESTER] == members[CIRCUIT], "so a harvester is plugged into a circuit"


@pytest.mark.parametrize("seed", range(60))
def test_the_results_are_those_of_fmi_2_to_the_last_bit(fmus, fmus3, seed):
    values = machine(seed)
    expected = run(fmus[HARVESTER], values)
    for event_mode in (False, True):
        for early_return in (False, True):
            found = run(fmus3[HARVESTER], values, use_event_mode=event_mode, early_return_allowed=early_return)
            # The last row of a time is that after the event.
            last = {row["time"]: row for row in found}
            for row in expected:
                assert last[row["time"]] == row, (event_mode, early_return)
            assert early_return or event_mode or len(found) == len(expected)


@pytest.mark.parametrize("seed", range(60))
def test_every_impact_is_an_event_at_its_time_and_ticks_the_clock(fmus, slave3, seed):
    values = machine(seed)
    expected, rests = logged_impacts(fmus[HARVESTER], values)
    slave = slave3(eventModeUsed=True, earlyReturnAllowed=True)
    begin(slave, values)
    [clock, side] = references(slave, "impact.clock", "impact.side")
    floats = references(slave, "time", "impact.speed", "impact.energy")
    found, energies, knots = [], [], 0

    def handle_event() -> None:
        [ticks] = slave.getClock([clock])
        if ticks:
            time, speed, energy = slave.getFloat64(floats)
            found.append((time, ["none", "left", "right"][slave.getInt64([side])[0] - 1], speed))
            energies.append(energy)
        again = True
        while again:
            again, terminate, _, _, has_next, _ = slave.updateDiscreteStates()
            assert not (terminate or has_next)
        assert slave.getClock([clock]) == [False]
        slave.enterStepMode()

    handle_event()
    time = 0.0
    while time < STOP_TIME:
        event, terminate, early, time = slave.doStep(time, STOP_TIME - time)
        assert not terminate and early == (time < STOP_TIME)
        knots += not event
        if event:
            slave.enterEventMode()
            handle_event()
    assert found == expected
    if values.get("contact.law") == 2 or not found:
        return  # a contact that lasts counts its gain when it is over
    assert knots > 0
    [gain] = slave.getFloat64(references(slave, "gain.energyEq13"))
    # The endless tail of a ball that comes to rest has a gain, but no impacts.
    assert sum(energies) == pytest.approx(gain, rel=1e-3 if rests else 1e-9)


def test_without_permission_no_step_ends_early(slave3):
    slave = slave3(eventModeUsed=False, earlyReturnAllowed=False)
    begin(slave, harness.fig14())
    for step in range(40):
        outcome = slave.doStep(step * 0.25, 0.25)
        assert outcome == (False, False, False, step * 0.25 + 0.25)


def test_model_exchange_is_that_of_fmi_2(fmus, fmus3):
    options = {"fmi_type": "ModelExchange", "relative_tolerance": 1e-8}
    expected, found = (run(fmu[HARVESTER], harness.fig14(), **options) for fmu in (fmus, fmus3))
    assert len(expected) == len(found)
    assert (expected == found).all()


def test_the_circuit_gives_the_same_bits(fmus, fmus3):
    times = np.arange(0.0, 0.5, 1e-3)
    signals = np.array(
        [(t, 15e-12 + 10e-12 * max(0.0, np.sin(40.0 * t)), 15e-12) for t in times],
        dtype=[("time", float), ("left.capacitance", float), ("right.capacitance", float)],
    )
    outputs = ["load.energy", "supply.energy", "left.voltage", "load.voltage"]
    expected, found = (
        fmpy.simulate_fmu(fmu[CIRCUIT], stop_time=0.4, output_interval=1e-3, input=signals, output=outputs)
        for fmu in (fmus, fmus3)
    )
    assert (expected == found).all()
    assert expected["load.energy"][-1] > 0.0


def test_ten_thousand_loads_leave_no_memory_behind(fmus3):
    folder = Path(fmpy.extract(fmus3[HARVESTER]))
    [library] = (folder / "binaries").glob(f"*/{HARVESTER}.*")
    token = fmpy.read_model_description(folder).instantiationToken.encode()
    double, true = ctypes.c_double, ctypes.c_bool(True)
    flags = [ctypes.byref(ctypes.c_bool()) for _ in range(3)]

    def cycle() -> None:
        fmu = ctypes.CDLL(str(library))
        fmu.fmi3InstantiateCoSimulation.restype = ctypes.c_void_p
        instance = ctypes.c_void_p(
            fmu.fmi3InstantiateCoSimulation(b"it", token, None, *[ctypes.c_bool()] * 4, None, ctypes.c_size_t(), None, None, None)
        )
        assert instance
        assert fmu.fmi3EnterInitializationMode(instance, ctypes.c_bool(), double(), double(), ctypes.c_bool(), double()) == 0
        assert fmu.fmi3ExitInitializationMode(instance) == 0
        reached = double()
        assert fmu.fmi3DoStep(instance, double(), double(1.0), true, *flags, ctypes.byref(reached)) == 0
        assert reached.value == 1.0
        fmu.fmi3FreeInstance(instance)
        _ctypes.dlclose(fmu._handle)

    def resident() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()

    for _ in range(1000):
        cycle()
    before = resident()
    for _ in range(10_000):
        cycle()
    shutil.rmtree(folder)
    assert resident() - before < 2 << 20, "of ten thousand loads"
