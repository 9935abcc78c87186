"""The examples of fmu-export: FMPy takes them, and their results are those of formulas that share no code with them."""

import re
import shutil
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

from harness import ROOT

EXAMPLES = ROOT / "fmu" / "export" / "examples"


@pytest.fixture(scope="module")
def build(user):
    """Builds the FMU of an example in the packaged crate."""
    folder = user.share(user.crate("fmu-export"))

    def build(name: str, version: str) -> str:
        printed = user.run("cargo", "fmu", "build", "--example", name, "--fmi", version, folder=folder, stderr=None).stdout
        return str(folder / printed.strip())

    return build


@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("name", ["lag", "ball", "controller", "table"])
def test_fmpy_has_no_complaint(build, name, version):
    fmu = build(name, version)
    assert validate_fmu(fmu) == []
    with zipfile.ZipFile(fmu) as archive:
        page = archive.read("documentation/index.html").decode()
    for variable in fmpy.read_model_description(fmu).modelVariables:
        assert f"<td><code>{variable.name}</code></td>" in page or variable.causality == "independent"
    assert not re.search(r"src=|href=|<script|url\(", page)


def bounces(values: dict, stop_time: float) -> list[tuple[float, float]]:
    """Times and speeds of the bounces of a ball, from the series of its flights."""
    g, e = values["gravity"], values["restitution"]
    h, v = values["initial.height"], values["initial.velocity"]
    speed = np.sqrt(v * v + 2 * g * h)
    time, found = (v + speed) / g, []
    while time <= stop_time:
        found.append((time, speed))
        speed *= e
        if speed < 1e-3:
            break
        time += 2 * speed / g
    return found


def slave(fmu: str):
    folder = fmpy.extract(fmu)
    description = fmpy.read_model_description(folder)
    made = FMU3Slave(
        guid=description.instantiationToken, modelIdentifier=description.coSimulation.modelIdentifier, unzipDirectory=folder,
        instanceName="it",
    )
    return made, {variable.name: variable.valueReference for variable in description.modelVariables}, folder


@pytest.mark.parametrize("seed", range(20))
def test_every_bounce_of_a_random_ball_is_an_event_at_its_time(build, seed):
    random = np.random.default_rng(seed)
    values = {
        "gravity": random.uniform(0.5, 30.0),
        "restitution": random.uniform(0.0, 0.9),
        "initial.height": random.uniform(0.0, 5.0),
        "initial.velocity": random.uniform(-3.0, 3.0),
    }
    stop_time = 10.0
    ball, reference, folder = slave(build("ball", "3"))
    ball.instantiate(eventModeUsed=True, earlyReturnAllowed=True)
    ball.setFloat64([reference[name] for name in values], list(values.values()))
    ball.enterInitializationMode()
    ball.exitInitializationMode()
    ball.updateDiscreteStates()
    ball.enterStepMode()
    time, seen = 0.0, []
    while time < stop_time:
        event, _, _, time = ball.doStep(time, min(random.uniform(0.01, 2.0), stop_time - time))
        if event:
            ball.enterEventMode()
            assert ball.getClock([reference["bounce.clock"]]) == [True]
            seen.append((time, ball.getFloat64([reference["bounce.speed"]])[0]))
            ball.updateDiscreteStates()
            ball.enterStepMode()
    count = ball.getUInt64([reference["bounces"]])[0]
    ball.terminate()
    ball.freeInstance()
    shutil.rmtree(folder)
    wanted = bounces(values, stop_time)
    assert len(seen) == count
    # The last bounces before the end, or before the ball rests, may fall on either side of it.
    assert abs(len(seen) - len(wanted)) <= 1
    both = min(len(seen), len(wanted))
    np.testing.assert_allclose(seen[:both], wanted[:both], rtol=1e-9, atol=1e-9)


def test_a_run_of_the_ball_is_the_same_in_both_versions_with_and_without_events(build):
    options = {"stop_time": 3.0, "output_interval": 0.05, "output": ["height", "velocity", "bounces"]}
    plain = fmpy.simulate_fmu(build("ball", "2"), **options)
    for event_mode in (False, True):
        for early_return in (False, True):
            run = fmpy.simulate_fmu(
                build("ball", "3"), use_event_mode=event_mode, early_return_allowed=early_return, **options
            )
            rows = run[np.searchsorted(run["time"], plain["time"] - 1e-9, side="left")]
            for name in ("height", "velocity", "bounces"):
                np.testing.assert_allclose(rows[name], plain[name], rtol=0, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_the_controller_is_that_of_its_formula_at_the_ticks_of_its_clock(build, seed):
    with zipfile.ZipFile(build("controller", "3")) as archive:
        interval = float(re.search('<Clock.* intervalDecimal="([0-9.]+)"', archive.read("modelDescription.xml").decode())[1])
    random = np.random.default_rng(seed)
    gain, integration_time, limit = random.uniform(0.1, 5.0), random.uniform(0.1, 5.0), random.uniform(0.5, 5.0)
    controller, reference, folder = slave(build("controller", "3"))
    controller.instantiate(eventModeUsed=True)
    names = [reference[name] for name in ("gain", "integrationTime", "limit")]
    controller.setFloat64(names, [gain, integration_time, limit])
    controller.enterInitializationMode()
    controller.exitInitializationMode()
    clock = [reference["sample.clock"]]
    integral = 0.0
    for k in range(50):
        # In event mode: the first tick is at the start.
        setpoint, measured = random.uniform(-2.0, 2.0, 2)
        controller.setClock(clock, [True])
        controller.setFloat64([reference["setpoint"], reference["measured"]], [setpoint, measured])
        controller.updateDiscreteStates()
        seen = controller.getFloat64([reference["control"]])[0]
        controller.enterStepMode()
        controller.doStep(k * interval, interval)
        controller.enterEventMode()
        deviation = gain * (setpoint - measured)
        free = deviation + integral + deviation * interval / integration_time
        wanted = np.clip(free, -limit, limit)
        if wanted == free:
            integral += deviation * interval / integration_time
        assert seen == pytest.approx(wanted, rel=1e-12, abs=1e-12)
    controller.terminate()
    controller.freeInstance()
    shutil.rmtree(folder)


@pytest.fixture(scope="module")
def reader(user) -> Path:
    """A package of the user's own with the table reader."""
    folder = user.new("reader")
    shutil.copy(EXAMPLES / "table" / "main.rs", folder / "src" / "lib.rs")
    (folder / "resources").mkdir()
    return folder


@pytest.mark.parametrize("seed", range(8))
def test_a_random_table_makes_its_own_fmu(user, reader, seed):
    random = np.random.default_rng(seed)
    columns, rows = random.integers(0, 6), random.integers(1, 30)
    times = np.cumsum(random.uniform(0.01, 1.0, rows)) - 0.3
    values = random.normal(size=(rows, columns))
    header = ",".join(["time [s]", *(f"column{k}" + " [m/s]" * (k % 2) for k in range(columns))])
    text = "\n".join([header, *(",".join(map(repr, map(float, [time, *row]))) for time, row in zip(times, values))])
    (reader / "resources" / "table.csv").write_text(text + "\n")
    fmu = str(reader / user.run("cargo", "fmu", "build", folder=reader, stderr=None).stdout.strip())
    assert validate_fmu(fmu) == []
    variables = fmpy.read_model_description(fmu).modelVariables
    assert [(it.name, it.unit) for it in variables] == [(f"column{k}", "m/s" if k % 2 else None) for k in range(columns)]
    if columns:
        run = fmpy.simulate_fmu(fmu, stop_time=float(times[-1]) + 1.0, output_interval=0.1)
        for k in range(columns):
            np.testing.assert_allclose(run[f"column{k}"], np.interp(run["time"], times, values[:, k]), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "No such file"),
        ("", "it is empty"),
        ("time,a\n", "it has no rows"),
        ("time,a\n0,1\n0,2\n", "line 3: time 0 is not behind 0"),
        ("time,a\n0,x\n", 'line 2: "x" is no finite number'),
        ("time,a\n0\n", "line 2 has 1 cells, the first line 2"),
        ("time,a,a\n0,1,2\n", "its name occurs twice"),
    ],
)
def test_a_table_that_is_none_is_refused_when_it_is_packaged(user, reader, text, said):
    file = reader / "resources" / "table.csv"
    file.unlink(missing_ok=True)
    if text is not None:
        file.write_text(text)
    failed = user.run("cargo", "fmu", "build", folder=reader, check=False)
    assert failed.returncode == 1
    assert "reader has no model description: " in failed.stdout and said in failed.stdout, failed.stdout
