"""FMPy sets a recorded excitation by its file, a String parameter; and the example recordings have the spectra that they state."""

import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import simulate_fmu
from numpy.polynomial import Polynomial

import harness
import system

# Item of the enumeration; FMPy takes its number.
MOTION = 2

RECORDINGS = harness.ROOT / "examples" / "recordings"


def run(fmu, settings, output=("cylinder.position", "ball.position", "gain.voltage"), **options):
    return simulate_fmu(str(fmu), start_values=settings, output=list(output), **options)


def write(path, name, times, values):
    rows = "".join(f"{time!r},{value!r}\n" for time, value in zip(times.tolist(), values.tolist()))
    path.write_text(f"time,{name}\n{rows}")
    return str(path)


def position(times, values, at):
    """Twice the integral of straight lines between samples, piece by piece in closed form; rest before the first one."""
    place, speed, found = 0.0, 0.0, np.zeros_like(at)
    for start, end, first, last in zip(times[:-1], times[1:], values[:-1], values[1:]):
        acceleration = Polynomial([first, (last - first) / (end - start)])
        velocity = acceleration.integ(k=speed)
        displacement = velocity.integ(k=place)
        inside = (at >= start) & (at <= end)
        found[inside] = displacement(at[inside] - start)
        place, speed = displacement(end - start), velocity(end - start)
    behind = at > times[-1]
    found[behind] = place + speed * (at[behind] - times[-1])
    return found


@pytest.mark.parametrize("seed", range(6))
def test_the_cylinder_moves_as_the_integral_of_the_samples_says(fmus, tmp_path, seed):
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(1e-3, 0.1, 40))
    values = random.uniform(-5.0, 5.0, 40)
    scale, offset = random.uniform(-2.0, 2.0), random.uniform(0.0, 0.5)
    is_motion = bool(seed % 2)
    file = write(tmp_path / "random.csv", "acceleration" if is_motion else "force", times, values)
    settings = {"excitation.file": file, "excitation.fileScale": scale, "excitation.fileOffset": offset}
    settings |= {"excitation.kind": MOTION} if is_motion else {"excitation.amplitude": 0.0}
    result = run(fmus["VibroImpactHarvester"], settings, stop_time=3.0, output_interval=0.01)
    mass = 1.0 if is_motion else 0.1245
    expected = position(times + offset, values * scale / mass, result["time"])
    assert result["cylinder.position"] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_model_exchange_agrees_with_co_simulation(fmus):
    settings = {"excitation.kind": MOTION, "excitation.file": str(RECORDINGS / "walking.csv")}
    settings |= {"initial.ballPosition": 0.005, "initial.ballVelocity": 0.1}
    options = {"stop_time": 0.5, "output_interval": 0.01}
    exact = run(fmus["VibroImpactHarvester"], settings, **options)
    integrated = run(fmus["VibroImpactHarvester"], settings, fmi_type="ModelExchange", relative_tolerance=1e-9, **options)
    for name in ["cylinder.position", "ball.position"]:
        at = np.interp(exact["time"], integrated["time"], integrated[name])
        assert at == pytest.approx(exact[name], abs=2e-5)


def test_an_fmu_with_its_recording_inside_needs_the_name_alone(fmus, tmp_path):
    harness.videg("fmu", "build", "--resource", str(RECORDINGS / "walking.csv"), "--output", str(tmp_path))
    settings = {"excitation.kind": MOTION, "excitation.fileRepeat": True}
    options = {"stop_time": 12.0, "output_interval": 0.1}
    inside = run(tmp_path / "VibroImpactHarvester.fmu", settings | {"excitation.file": "walking.csv"}, **options)
    outside = settings | {"excitation.file": str(RECORDINGS / "walking.csv")}
    assert np.array_equal(inside, run(fmus["VibroImpactHarvester"], outside, **options))
    assert inside["gain.voltage"][-1] > 0


def test_two_instances_have_a_recording_each(slave, tmp_path):
    times = np.array([0.0, 1.0])
    slaves = []
    for force in [1.0, 2.0]:
        made = slave("VibroImpactHarvester")
        made.instantiate()
        file = write(tmp_path / f"{force}.csv", "force", times, np.array([force, force]))
        references = {name: variable.valueReference for name, variable in made.variables.items()}
        made.setString([references["excitation.file"]], [file])
        made.setReal([references["excitation.amplitude"]], [0.0])
        made.setupExperiment(startTime=0.0)
        made.enterInitializationMode()
        made.exitInitializationMode()
        assert made.getString([references["excitation.file"]]) == [file.encode()]
        slaves.append((made, references["cylinder.position"]))
    for made, _ in slaves:
        made.doStep(currentCommunicationPoint=0.0, communicationStepSize=0.5)
    found = [made.getReal([reference])[0] for made, reference in slaves]
    assert found == pytest.approx([0.125 / 0.1245, 0.25 / 0.1245], rel=1e-12)


STEP, STEPS = 1e-3, 1000


@pytest.fixture
def force(tmp_path):
    """A recorded force, as settings of the harvester."""
    times = np.linspace(0.1, 0.9, 50)
    return {"excitation.file": write(tmp_path / "force.csv", "force", times, np.sin(40 * times)), "excitation.fileScale": 0.5}


def test_libcosim_sets_the_file(fmus, force):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    fmu = fmus["VibroImpactHarvester"]
    references = {it.name: it.valueReference for it in fmpy.read_model_description(fmu).modelVariables}
    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    index = execution.add_local_slave(CosimLocalSlave(fmu, "harvester"))
    file, scale = force.values()
    assert execution.string_initial_value(index, references["excitation.file"], file)
    assert execution.real_initial_value(index, references["excitation.fileScale"], scale)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.simulate_until(round(STEP * 1e9) * STEPS)
    found = observer.last_real_values(index, [references["cylinder.position"]])[0]
    expected = run(fmu, force, stop_time=STEP * STEPS, output_interval=STEP)["cylinder.position"][-1]
    assert found == pytest.approx(expected, rel=1e-9)


def test_ecos_sets_the_file(fmus, force):
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    EcosLib.set_log_level("warn")
    fmu = fmus["VibroImpactHarvester"]
    with system.temporary_files(), EcosSimulationStructure() as structure:
        structure.add_model("harvester", fmu)
        structure.add_parameter_set("force", {f"harvester::{name}": value for name, value in force.items()})
        with EcosSimulation(structure=structure, step_size=STEP) as simulation:
            assert simulation.init(parameter_set="force"), EcosLib.get_last_error()
            for _ in range(STEPS):
                simulation.step()
            found = simulation.get_real("harvester::cylinder.position")
            simulation.terminate()
    expected = run(fmu, force, stop_time=STEP * STEPS, output_interval=STEP)["cylinder.position"][-1]
    assert found == pytest.approx(expected, rel=1e-9)


def test_a_system_package_carries_its_recording(force, tmp_path):
    settings = [word for name, value in force.items() for word in ("--set", f"{name}={value}")]
    packaged = harness.videg("ssp", *settings, "--output", str(tmp_path))
    assert packaged["warnings"] == [
        "harvester.excitation.file is a text: FMPy 0.3 does not run a system package with such parameters"
    ]
    expected = system.videg(STEP, STEPS, "--circuit", "fmu", *settings)
    other = system.videg(STEP, STEPS, "--circuit", "fmu")
    assert not np.array_equal(expected["harvester.relativeDisplacement"], other["harvester.relativeDisplacement"])
    Path(force["excitation.file"]).unlink()
    found = system.ecos_ssp(packaged["ssp"], STEP, STEPS)
    for name, values in expected.items():
        assert found[name] == pytest.approx(values, rel=0.0, abs=1e-9 * np.abs(values).max()), name


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,force\n0,1\n1,NaN\n", b'line 3: force = "NaN": it must be a finite number in N'),
        ("time [ms],acc\n0,1\n", b"line 1: the heading is"),
        ("time,force\n1,1\n0,1\n", b"line 3: time = 0 s is not above that of the row before, 1 s"),
        ("time,acceleration\n0,1\n1,1\n", b"allowed with it: excitation.kind = motion"),
        (None, b"No such file"),
    ],
)
def test_what_is_no_recording_is_refused_with_line_and_value(fmus, tmp_path, text, said):
    path, messages = tmp_path / "bad.csv", []
    if text is not None:
        path.write_text(text)
    with pytest.raises(Exception):
        run(
            fmus["VibroImpactHarvester"],
            {"excitation.file": str(path)},
            stop_time=0.1,
            logger=lambda *arguments: messages.append(arguments[-1]),
        )
    assert any(said in message and b"excitation.file" in message for message in messages), messages


def test_the_model_description_has_the_file_as_a_string(fmus):
    description = fmpy.read_model_description(fmus["VibroImpactHarvester"], validate=True)
    file = next(variable for variable in description.modelVariables if variable.name == "excitation.file")
    assert (file.type, file.causality, file.variability, file.start) == ("String", "parameter", "fixed", "")


def lines(name):
    """Amplitudes of the samples of a recording, whose time is a multiple of all periods, by frequency."""
    time, value = np.loadtxt(RECORDINGS / f"{name}.csv", delimiter=",", skiprows=1, unpack=True)
    assert value[0] == pytest.approx(value[-1], abs=2e-3), "it goes over into itself"
    amplitudes = 2 * np.abs(np.fft.rfft(value[:-1])) / (len(value) - 1)
    assert amplitudes[0] < 2e-3, "it has no mean"
    return np.fft.rfftfreq(len(value) - 1, time[1] - time[0]), amplitudes


def test_the_machine_has_its_two_lines_and_its_noise():
    frequencies, amplitudes = lines("machine")
    at = {frequency: amplitudes[np.argmin(np.abs(frequencies - frequency))] for frequency in [25.0, 50.0]}
    assert at[25.0] == pytest.approx(40.0, abs=0.2) and at[50.0] == pytest.approx(8.0, abs=0.2)
    # Without the two lines, which hide one each of the noise's own.
    others = ~np.isin(frequencies, [25.0, 50.0])
    assert np.sqrt(np.sum(amplitudes[others] ** 2) / 2) == pytest.approx(3.0, rel=0.01)
    band = (frequencies >= 10.0) & (frequencies <= 200.0)
    assert np.max(amplitudes[~band]) < 2e-3


def test_walking_has_its_harmonics():
    frequencies, amplitudes = lines("walking")
    # The steps scatter by 2 %, so a harmonic is a narrow band, and heel strikes add up to 0.31 m/s2 to each.
    for number, share in enumerate([0.4, 0.1, 0.1], start=1):
        band = np.abs(frequencies - 2.0 * number) < 0.5
        found = np.sqrt(np.sum(amplitudes[band] ** 2))
        assert found == pytest.approx(share * 9.80665, abs=0.45), number


def test_the_script_writes_the_recordings(tmp_path):
    subprocess.run([sys.executable, RECORDINGS / "synthesise.py", tmp_path], check=True, stdout=subprocess.DEVNULL)
    for name in ["walking.csv", "machine.csv"]:
        assert (tmp_path / name).read_text() == (RECORDINGS / name).read_text()
