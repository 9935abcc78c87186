"""Points of one's own: the numbers of a sweep over the same points, in the order that was asked for."""

import numpy as np
import pandas as pd
import pytest
import videg
from conftest import RANGES, SEED

CIRCUIT = {"topology": "isolated", "release": "switch", "zener.voltage": 2450.0}


def test_a_sweep_over_the_same_values_gives_the_same_numbers() -> None:
    random = np.random.default_rng(SEED)
    masses, loads = random.uniform(2e-3, 5e-3, 5), 10 ** random.uniform(8, 12, 4)
    table = videg.sweep(vary={"ball.mass": masses, "load.resistance": loads}, set=CIRCUIT, record="net_power", until=10)
    points = table[["ball.mass", "load.resistance"]]
    found = videg.evaluate(points, set=CIRCUIT, record="net_power", until=10)
    for name in ("net_power", "average_voltage_gain", "impacts"):
        np.testing.assert_array_equal(found[name], table[name].to_numpy(), err_msg=name)
    # In another order, on one thread.
    order = random.permutation(len(points))
    again = videg.evaluate(points.iloc[order], set=CIRCUIT, record="net_power", until=10, jobs=1)
    np.testing.assert_array_equal(again["net_power"], found["net_power"][order])


def test_samples_have_common_random_numbers() -> None:
    noise = {"excitation.phaseNoise": 2.0, "excitation.noiseHold": 1e-3}
    found = videg.evaluate({"ball.mass": [3e-3, 3.5e-3, 3e-3]}, set=noise, until=10, samples=4, seed=7)
    assert found["impacts"].shape == (3, 4)
    np.testing.assert_array_equal(found["average_voltage_gain"][0], found["average_voltage_gain"][2])
    assert len(set(found["average_voltage_gain"][0])) == 4
    table = videg.sweep(vary={"ball.mass": [3e-3]}, set=noise, until=10, samples=4, seed=7, common_seeds=True)
    np.testing.assert_array_equal(found["average_voltage_gain"][0], table["average_voltage_gain"])


@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_point_out_of_bounds_fails_alone_wherever_it_is(place: int) -> None:
    for wrong, said in ((2.0, "out of range"), (float("nan"), "membrane.restitution"), (-float("inf"), "membrane.restitution")):
        values = np.full(3, 0.5)
        values[place] = wrong
        found = videg.evaluate({"membrane.restitution": values}, until=2)
        assert list(found.errors) == [place] and said in found.errors[place]
        assert list(np.isnan(found["impacts"])) == [k == place for k in range(3)]
    found = videg.evaluate({"membrane.restitution": values}, until=2, samples=2, set={"excitation.phaseNoise": 1.0})
    assert list(found.errors) == [(place, 0), (place, 1)]


def test_equality_is_identity() -> None:
    one, other = [videg.evaluate({"membrane.restitution": 0.5}, until=2) for _ in range(2)]
    assert one == one and one != other and len({one, other}) == 2
    assert isinstance(repr(one), str) and set(RANGES)
    run = videg.simulate(until=0.1)
    assert run == run and run in [run] and pd.notna(run.time).all()
