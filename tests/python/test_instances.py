"""Harvester and circuit as objects: a run in steps of one's own is the run in one go."""

import multiprocessing
import os
import pickle
import random
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import videg
from conftest import SEED, draws


@pytest.mark.parametrize("settings", draws(6))
def test_steps_of_any_length_give_the_same_run(settings: dict) -> None:
    source = random.Random(SEED)
    names = ["left.capacitance", "right.capacitance", "ball.velocity"]
    with videg.Harvester("fig14", set=settings) as harvester, videg.Harvester("fig14", set=settings) as whole:
        while harvester.time < 3.0:
            harvester.step(min(10 ** source.uniform(-5, 0), 3.0 - harvester.time))
        whole.step(3.0)
        assert harvester.time == whole.time == 3.0
        assert harvester["impact.count"] == whole["impact.count"]
        # Times are sums of steps, and rounded.
        np.testing.assert_allclose(harvester.get(names), whole.get(names), rtol=1e-6, atol=1e-12)


def test_a_state_goes_on_anywhere() -> None:
    with videg.Harvester(set={"excitation.phaseNoise": 1.0}) as one:
        one.step(2.5)
        state = pickle.loads(pickle.dumps(one.save()))
        one.step(1.5)
        expected = one.get(["ball.position", "gain.voltage"])
        one.restore(state)
        assert one.time == 2.5
        one.step(1.5)
        np.testing.assert_array_equal(one.get(["ball.position", "gain.voltage"]), expected)
    with videg.Harvester(set={"excitation.phaseNoise": 1.0}) as other:
        other.restore(state)
        other.step(1.5)
        np.testing.assert_array_equal(other.get(["ball.position", "gain.voltage"]), expected)


def test_a_master_of_ones_own_agrees_with_cosim() -> None:
    """Circuit after harvester with C(t) linear in between, as the master's default; its steps also end at impacts, so ours are short."""
    reference = videg.cosim(until=2.0, step=1e-5, window=(1.0, 2.0)).energy
    with videg.Harvester() as harvester:
        sides = ["left.capacitance", "right.capacitance"]
        capacitance = harvester.get(sides)
        with videg.Circuit(set=dict(zip(sides, capacitance, strict=True))) as circuit:
            step = 2e-5
            for _ in range(round(2.0 / step)):
                harvester.step(step)
                new = harvester.get(sides)
                circuit.set_rates(dict(zip(sides, (new - capacitance) / step, strict=True)))
                circuit.step(step)
                capacitance = new
                for side, value in zip(sides, new, strict=True):
                    circuit[side] = value
            assert circuit["supply.energy"] == pytest.approx(reference["supply"], rel=2e-2)
            assert circuit["load.energy"] == pytest.approx(reference["load"], rel=2e-2)


def test_derivatives_are_those_of_finite_differences() -> None:
    with videg.Harvester() as harvester:
        harvester.step(0.731)
        names = ["left.capacitance", "right.capacitance", "cylinder.position"]
        # On the way into a membrane: a capacitance grows.
        while np.abs(harvester.rates(names[:2])).max() < 1e-12:
            harvester.step(1e-3)
        exact, before = harvester.rates(names), harvester.get(names)
        state = harvester.save()
        harvester.step(1e-7)
        np.testing.assert_allclose((harvester.get(names) - before) / 1e-7, exact, rtol=1e-3, atol=1e-16)
        harvester.restore(state)
        assert harvester.derivative("cylinder.position", []).shape == (1, 0)


def test_sensitivities_are_those_of_finite_differences() -> None:
    """How the outputs at the end of a step depend on the force during it, through impacts, too."""
    of, change, step = ["cylinder.position", "cylinder.velocity", "ball.velocity"], 1e-6, 0.3
    with videg.Harvester() as harvester:
        harvester.step(2.0)
        state = harvester.save()

        def after(force: float) -> np.ndarray:
            harvester.restore(state)
            harvester["externalForce"] = force
            harvester.step(step)
            return harvester.get(of)

        expected = (after(0.1 + change) - after(0.1 - change)) / (2 * change)
        after(0.1)
        exact = harvester.derivative(of, "externalForce")
        assert harvester["impact.count"] > 12
    assert exact.shape == (3, 1) and np.abs(exact).min() > 1e-3
    np.testing.assert_allclose(exact[:, 0], expected, rtol=1e-4)


def test_variables_tell_unit_and_type() -> None:
    with videg.Harvester() as harvester:
        variables = harvester.variables()
        assert variables["biasVoltage"].unit == "V" and variables["biasVoltage"].type == "Real"
        assert variables["impact.count"].type == "Integer"
        assert "biasVoltage" in harvester and "nothing" not in harvester
        with pytest.raises(TypeError):
            iter(harvester)
        assert isinstance(harvester["impact.count"], int) and isinstance(harvester["contact.law"], str)


def test_what_is_closed_says_so() -> None:
    harvester = videg.Harvester()
    harvester.close()
    harvester.close()
    for call in (lambda: harvester.step(1.0), lambda: harvester["ball.position"], harvester.save, harvester.variables):
        with pytest.raises(videg.Error, match="closed"):
            call()


def test_of_two_threads_that_use_one_instance_at_once_the_second_is_refused() -> None:
    # Noise makes the step take some seconds.
    harvester, ended = videg.Harvester(set={"excitation.phaseNoise": 1.0}), []
    thread = threading.Thread(target=lambda: ended.append(harvester.step(3000.0)))
    thread.start()
    refused = 0
    while thread.is_alive():
        try:
            assert harvester["ball.position"] is not None
        except videg.Error as error:
            assert "another thread" in str(error)
            refused += 1
        time.sleep(1e-3)
    thread.join()
    assert ended == [None] and harvester.time == 3000.0, "the step itself goes on"
    assert refused > 0


def test_an_instance_may_end_on_another_thread() -> None:
    with ThreadPoolExecutor(2) as pool:
        made = list(pool.map(lambda _: videg.Harvester(), range(4)))
        assert [pool.submit(harvester.step, 1.0).result() for harvester in made] == [None] * 4
    assert len({harvester["ball.position"] for harvester in made}) == 1
    del made


def test_rates_hold_over_a_long_step() -> None:
    """A step is made in pieces; the rates of inputs go on over all of them."""
    values = {"left.capacitance": 1e-11, "right.capacitance": 1e-11}
    for step in (0.5, 3.0, 149.0, 770.0):
        with videg.Circuit(set=values) as circuit:
            circuit.set_rates({"left.capacitance": 1e-14})
            circuit.step(step)
            assert circuit["left.capacitance"] == pytest.approx(1e-11 + 1e-14 * step, rel=1e-12)
            circuit.step(2.0)
            assert circuit["left.capacitance"] == pytest.approx(1e-11 + 1e-14 * step, rel=1e-12), "rates are for one step"


def test_instances_on_many_threads_at_once() -> None:
    found = []

    def run() -> None:
        with videg.Harvester() as harvester:
            harvester.step(5.0)
            found.append(harvester["gain.voltage"])

    threads = [threading.Thread(target=run) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8 and len(set(found)) == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_has_fmus_of_its_own() -> None:
    expected = videg.simulate(until=2.0).average_voltage_gain
    harvester = videg.Harvester()

    def child(pipe) -> None:
        try:
            harvester.step(1.0)
            said = "no error"
        except videg.Error as error:
            said = str(error)
        pipe.send((said, videg.simulate(until=2.0).average_voltage_gain))

    here, there = multiprocessing.Pipe()
    context = multiprocessing.get_context("fork")
    process = context.Process(target=child, args=(there,))
    process.start()
    assert here.poll(60)
    said, found = here.recv()
    process.join(60)
    assert process.exitcode == 0 and "process" in said and found == expected
    # What the child has closed is still open here.
    assert videg.simulate(until=2.0).average_voltage_gain == expected
    harvester.step(1.0)


def test_instances_cannot_be_pickled() -> None:
    with videg.Harvester() as harvester, pytest.raises(TypeError, match="save"):
        pickle.dumps(harvester)
