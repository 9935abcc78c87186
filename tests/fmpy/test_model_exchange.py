"""Model exchange: the harvester under CVode, against the same FMU in co-simulation.

Both FMUs come from `target/fmu`; the environment variable VIDEG_FMU_DIR names another folder.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

FOLDER = Path(os.environ.get("VIDEG_FMU_DIR", Path(__file__).resolve().parents[2] / "target" / "fmu"))
FMU = FOLDER / "VibroImpactHarvester.fmu"
OUTPUTS = [
    "impact.count",
    "impact.lastVelocity",
    "gain.voltage",
    "gain.energyEq13",
    "cylinder.position",
    "ball.position",
    "ball.velocity",
    "left.capacitance",
    "right.capacitance",
    "contact.resting",
]
# Fig. 14: the start of the saw-tooth motion of Section 4.2 under A = 0.5 N, r = 0.6.
FIG14 = {
    "initial.cylinderPosition": -0.025432024006610886,
    "initial.ballPosition": -0.0034320240066108842,
    "initial.ballVelocity": 0.027456192052887074,
}
# Table 3 at 2 Hz: the ball chatters and rests on a membrane for a part of each cycle.
FLASHLIGHT = {
    "cylinder.mass": 0.012,
    "cylinder.length": 0.19788558120243696,
    "ball.mass": 0.053,
    "ball.radius": 0.0075,
    "membrane.initialRadius": 0.004,
    "membrane.restitution": 0.5,
    "excitation.amplitude": 5.0,
}


def run(fmi_type, start_values, stop_time, **solver):
    return simulate_fmu(
        FMU,
        fmi_type=fmi_type,
        stop_time=stop_time,
        start_values=start_values,
        output=OUTPUTS,
        output_interval=0.01,
        record_events=False,
        **solver,
    )


def run_both(start_values, stop_time):
    exchanged = run("ModelExchange", start_values, stop_time, solver="CVode", relative_tolerance=1e-8)
    stepped = run("CoSimulation", start_values, stop_time)
    return exchanged, stepped


def at_grid(result, name, grid):
    """Values at the communication points: the last row of each time, which is the one after an event."""
    rows = np.searchsorted(result["time"], grid + 1e-9, side="right") - 1
    return result[name][rows]


def test_the_model_description_is_valid_and_offers_both_interfaces():
    assert validate_fmu(FMU) == []
    description = read_model_description(FMU)
    assert description.modelExchange is not None
    assert description.coSimulation is not None
    assert description.numberOfContinuousStates == 5
    assert description.numberOfEventIndicators == 3
    states = [unknown.variable.derivative.name for unknown in description.derivatives]
    assert states == ["cylinder.position", "cylinder.velocity", "ball.position", "ball.velocity", "energy.damping"]


def test_cvode_finds_the_impacts_of_fig14():
    exchanged, stepped = run_both(FIG14, 20.0)
    assert stepped["impact.count"][-1] > 50
    assert exchanged["impact.count"][-1] == stepped["impact.count"][-1]
    for name in ["gain.voltage", "gain.energyEq13"]:
        assert exchanged[name][-1] == pytest.approx(stepped[name][-1], rel=1e-4)
    grid = np.linspace(0.0, 20.0, 2001)
    for name, tolerance in [("cylinder.position", 1e-5), ("ball.position", 1e-5), ("ball.velocity", 1e-4)]:
        difference = np.abs(at_grid(exchanged, name, grid) - at_grid(stepped, name, grid))
        # A communication point may fall between the two instants of one impact.
        assert np.quantile(difference, 0.99) < tolerance, name
    for name in ["left.capacitance", "right.capacitance"]:
        difference = np.abs(at_grid(exchanged, name, grid) - at_grid(stepped, name, grid))
        assert np.quantile(difference, 0.99) < 1e-3 * stepped[name].max(), name


def test_cvode_comes_through_chattering_rest_and_release():
    exchanged, stepped = run_both(FLASHLIGHT, 3.0)
    assert stepped["contact.resting"].any()
    assert exchanged["contact.resting"].any()
    # The endless tail of a chattering sequence is summed up, here earlier than there: its impacts are not counted.
    assert exchanged["contact.resting"].sum() == pytest.approx(stepped["contact.resting"].sum(), abs=3)
    assert exchanged["gain.energyEq13"][-1] == pytest.approx(stepped["gain.energyEq13"][-1], rel=3e-4)


def test_the_solver_stops_at_each_sample_of_the_phase_noise():
    noisy = FIG14 | {"excitation.phaseNoise": 0.5, "excitation.noiseHold": 0.02}
    exchanged, stepped = run_both(noisy, 4.0)
    assert exchanged["impact.count"][-1] == stepped["impact.count"][-1]
    assert exchanged["gain.voltage"][-1] == pytest.approx(stepped["gain.voltage"][-1], rel=1e-4)


def test_the_default_experiment_keeps_the_cylinder_in_its_place():
    """As users run it: without a tolerance of their own. A free cylinder drifts with each error of its velocity."""
    exchanged, stepped = (run(kind, FIG14, 100.0) for kind in ("ModelExchange", "CoSimulation"))
    drift = exchanged["cylinder.position"][-1] - stepped["cylinder.position"][-1]
    assert abs(drift) < 1e-4
    assert exchanged["gain.voltage"][-1] == pytest.approx(stepped["gain.voltage"][-1], rel=1e-6)


def test_outputs_are_reals_and_twins_say_what_their_variables_say():
    outputs = [variable for variable in read_model_description(FMU).modelVariables if variable.causality == "output"]
    assert {variable.type for variable in outputs} == {"Real"}
    twins = ["impact.count", "impact.countReal", "contact.resting", "contact.restingReal"]
    result = simulate_fmu(FMU, stop_time=10.0, start_values=FLASHLIGHT, output=twins, output_interval=0.01)
    for name in ("impact.count", "contact.resting"):
        assert result[name].any()
        assert np.array_equal(result[name].astype(float), result[f"{name}Real"])
