"""FMPy and the FMU VibroImpactHarvester on the paper's Fig. 14."""

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

import harness

HARVESTER = "VibroImpactHarvester"


def test_fmpy_finds_no_problem_in_the_fmu(fmus):
    assert validate_fmu(fmus[HARVESTER]) == []


def test_fmpy_gets_the_numbers_of_the_command_line(fmus, tmp_path):
    expected = harness.videg("simulate", "--case", "fig14", "--output", str(tmp_path))
    result = fmpy.simulate_fmu(
        fmus[HARVESTER],
        stop_time=100.0,
        output_interval=0.5,
        start_values=harness.fig14(),
        output=["gain.voltage", "impact.count"],
    )
    gain = {time: row["gain.voltage"] for time, row in zip(result["time"], result)}
    assert (gain[100.0] - gain[50.0]) / 50.0 == expected["average_voltage_gain"]
    assert result["impact.count"][-1] == expected["impacts"]
    assert expected["average_voltage_gain"] == pytest.approx(8079.0, rel=1e-4)


def run(slave, steps: int) -> dict:
    harvester = slave(HARVESTER)
    harvester.start(harness.fig14(), stop_time=100.0)
    times = np.linspace(0.0, 100.0, steps + 1)
    for now, then in zip(times, times[1:]):
        harvester.doStep(now, then - now)
    return harvester.outputs()


def test_the_step_size_does_not_matter(slave):
    one = run(slave, 1)
    assert one["impact.countReal"] > 590
    for steps in (1000, 7):
        assert run(slave, steps) == one


def test_a_restored_state_goes_on_to_the_same_bits(slave):
    harvester = slave(HARVESTER)
    harvester.start(harness.fig14())
    harvester.doStep(0.0, 3.7)
    state = harvester.getFMUstate()
    before = harvester.outputs()

    def go_on():
        for step in range(100):
            harvester.doStep(3.7 + 0.05 * step, 0.05)
        return harvester.outputs()

    first = go_on()
    harvester.setFMUstate(state)
    assert harvester.outputs() == before
    assert go_on() == first
    assert first["impact.countReal"] > before["impact.countReal"]
    harvester.freeFMUstate(state)


def test_the_rate_of_the_capacitance_is_that_of_its_values(slave):
    harvester = slave(HARVESTER)
    harvester.start(harness.fig14())
    reference = harvester.references(["left.capacitance"])
    step, points = 1e-5, []
    for index in range(100_000):
        harvester.doStep(index * step, step)
        points.append((harvester.getReal(reference)[0], harvester.getRealOutputDerivatives(reference, [1])[0]))
    value, rate = np.array(points).T
    difference = (value[2:] - value[:-2]) / (2 * step)
    error = np.abs(rate[1:-1] - difference)
    largest = np.abs(rate).max()
    assert largest > 1e-10
    # Where the pulse begins and ends the difference is taken across a kink.
    assert np.count_nonzero(error > 1e-3 * largest) <= 3 * 8


def test_a_value_out_of_range_is_an_error(slave):
    harvester = slave(HARVESTER)
    harvester.instantiate()
    with pytest.raises(FMICallException):
        harvester.set({"membrane.restitution": 1.5})


def test_directional_derivatives_are_those_through_the_step(slave):
    harvester = slave(HARVESTER)
    harvester.start(harness.fig14())
    unknown = harvester.references(["cylinder.position", "ball.position", "relativeDisplacement"])
    known, count = harvester.references(["externalForce"]), harvester.references(["impact.count"])
    force, width, size = 0.1, 1e-4, 0.1
    with_impact, without = 0, 0
    for index in range(60):
        before, impacts = harvester.getFMUstate(), harvester.getInteger(count)[0]

        def end(shift):
            harvester.setFMUstate(before)
            harvester.set({"externalForce": force + shift})
            harvester.doStep(index * size, size)
            return np.array(harvester.getReal(unknown)), harvester.getInteger(count)[0]

        (far, near, back, far_back), counts = zip(*(end(shift * width) for shift in (2, 1, -1, -2)))
        counts = set(counts) | {end(0)[1]}
        harvester.freeFMUstate(before)
        if len(counts) > 1:
            continue  # an impact falls on the end of the step
        difference = (8 * (near - back) - (far - far_back)) / (12 * width)
        derivative = np.array(harvester.getDirectionalDerivative(unknown, known, [1.0]))
        # 1e-6 of the natural size, 1 cm by 0.5 N.
        np.testing.assert_allclose(derivative, difference, rtol=1e-6, atol=2e-8)
        with_impact += counts != {impacts}
        without += counts == {impacts}
    assert with_impact > 15
    assert without > 15
