"""The half-wave rectifier against its recursion."""

import numpy as np
import pytest

from bench import Bench, Pulses

SUPPLY = 2000.0


def netlist(storage: float, load: float) -> Bench:
    return Bench("half_wave", {"Cs": f"Cs out 0 {storage:.17g}", "Rload": f"Rload out 0 {load:.17g}"})


def after(voltage: float, rest: float, peak: float, storage: float) -> float:
    """A pulse brings the charge C3 U_in to the storage, if that lifts its voltage."""
    return max(voltage, (peak * SUPPLY + storage * voltage) / (rest + storage))


@pytest.mark.parametrize("seed", range(6))
def test_each_pulse_lifts_the_storage_as_charge_conservation_says(tmp_path, seed):
    rng = np.random.default_rng(seed)
    rests, storage, count = rng.uniform(10e-12, 20e-12, 2), rng.uniform(50e-12, 200e-12), 12
    peaks = rng.uniform(1.05, 2.3, (2, count)) * rests[:, None]
    left, right = (
        Pulses(rests[side], tuple(peaks[side]), tuple(0.01 + 0.05 * side + 0.1 * k for k in range(count))) for side in (0, 1)
    )
    found = netlist(storage, 1e18).run(tmp_path, left, right, 1.2, "v(out)")
    voltage, expected = SUPPLY, []
    for k in range(count):
        for side in (0, 1):
            voltage = after(voltage, rests[side], peaks[side, k], storage)
            expected.append(voltage)
    ends = np.column_stack([left.ends(), right.ends()]).ravel()
    assert found.at("v(out)", ends) == pytest.approx(np.array(expected), rel=1e-4)


def test_without_a_load_it_saturates_at_the_supply_times_the_ratio(tmp_path):
    rest, ratio = 15e-12, 1.9
    pulses = Pulses(rest, (ratio * rest,) * 100, tuple(0.01 + 0.02 * k for k in range(100)))
    found = netlist(50e-12, 1e18).run(tmp_path, pulses, pulses, 2.1, "v(out)")
    assert found.at("v(out)", 2.1) == pytest.approx(ratio * SUPPLY, rel=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_it_saturates_where_the_load_takes_what_a_pulse_brings(tmp_path, seed):
    """At rest the membrane discharges with the storage: C2 + Cs. Pulses are short here, and period / (R C) is not."""
    rng = np.random.default_rng(seed)
    rest, storage, period = rng.uniform(10e-12, 20e-12), rng.uniform(50e-12, 100e-12), 0.1
    peak, load, count = rng.uniform(1.6, 2.3) * rest, rng.uniform(2e10, 1e11), 60
    pulses = Pulses(rest, (peak,) * count, tuple(period * (k + 0.5) for k in range(count)), 1e-4, 1e-4)
    found = netlist(storage, load).run(tmp_path, pulses, Pulses(rest), period * count, "v(out)", step=2e-4)
    kept = np.exp(-period / (load * (rest + storage)))
    expected = peak * SUPPLY / (rest + storage - storage * kept)
    assert expected * kept > SUPPLY, "the supply would feed the load"
    assert found.at("v(out)", pulses.ends()[-1]) == pytest.approx(expected, rel=1e-4)
