"""The paper's circuit, with and without a leak, against the solution of its equation."""

import numpy as np
import pytest

from bench import Bench, Pulses

SUPPLY = 2000.0


def zener(voltage: float) -> str:
    return f".model zener D(IS=1e-13 N=0.01 BV={voltage:.17g} IBV=1e-13 NBV=0.01)"


def solved(voltage: float, start: float, end: float, duration: float, leak: float, load: float, release: float) -> float:
    """Voltage of the node after C(t) went from `start` to `end`, F.

    d(C V)/dt = -G V - (V - U_z)/R while V > U_z = `release`, with the conductances G = `leak` and 1/R = `load`, S. The supply
    holds V at U_in.
    """
    slope = (end - start) / duration
    limit = load * release / (slope + leak + load) if slope + leak + load else 0.0
    rate = slope + leak + load
    part = (end / start) ** (-rate / slope) if slope else np.exp(-rate * duration / start)
    return max(SUPPLY, limit + (voltage - limit) * part)


def expected(left: Pulses, right: Pulses, times, leak: float, load: float, release: float) -> np.ndarray:
    """Voltages at `times`, from corner to corner of C(t); no corner between two pulses may lift and lower the voltage."""
    corners = sorted({time for side in (left, right) for time, _ in side.corners()} | set(times))
    total = sum(np.interp(corners, *zip(*side.corners(), strict=True)) for side in (left, right))
    voltage, voltages = SUPPLY, {corners[0]: SUPPLY}
    for k in range(1, len(corners)):
        voltage = solved(voltage, total[k - 1], total[k], corners[k] - corners[k - 1], leak, load, release)
        voltages[corners[k]] = voltage
    return np.array([voltages[time] for time in times])


def pulses(rng, period: float, count: int) -> tuple[Pulses, Pulses]:
    """Alternating pulses of random height."""
    sides = []
    for offset in (0.01, 0.01 + period / 2):
        rest = rng.uniform(10e-12, 20e-12)
        peaks = tuple(rest * rng.uniform(1.3, 2.3, count))
        sides.append(Pulses(rest, peaks, tuple(offset + period * k for k in range(count))))
    return sides[0], sides[1]


def instants(left: Pulses, right: Pulses, period: float) -> list[float]:
    """The ends of all pulses, and times at rest after them."""
    ends = np.concatenate([left.ends(), right.ends()])
    return sorted(float(time) for time in np.concatenate([ends, ends + 0.1 * period, ends + 0.3 * period]))


def check(folder, bench: Bench, rng, leak: float, load: float, release: float) -> None:
    period, count = 0.2, 8
    left, right = pulses(rng, period, count)
    times = instants(left, right, period)
    found = bench.run(folder, left, right, times[-1] + 0.01, "v(de)")
    wanted = expected(left, right, times, leak, load, release)
    assert max(wanted) > 1.1 * SUPPLY
    assert found.at("v(de)", times) == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_the_node_follows_its_equation(tmp_path, seed):
    rng = np.random.default_rng(seed)
    load = 10 ** rng.uniform(9.5, 11)
    check(tmp_path, Bench("paper", {"Rload": f"Rload out 0 {load:.17g}"}), rng, 0.0, 1 / load, SUPPLY)


@pytest.mark.parametrize("seed", range(5))
def test_a_leak_lets_the_voltage_decay_between_impacts(tmp_path, seed):
    """Without release it is U(0) exp(-t / (R C))."""
    rng = np.random.default_rng(seed)
    leaks = 10 ** rng.uniform(10.5, 12, 2)
    changes = {"Rleakl": f"Rleakl de 0 {leaks[0]:.17g}", "Rleakr": f"Rleakr de 0 {leaks[1]:.17g}", ".model zener": zener(1e5)}
    check(tmp_path, Bench("leaky", changes), rng, float(sum(1 / leaks)), 0.0, 1e5)


@pytest.mark.parametrize("seed", range(5))
def test_leak_and_load_share_the_charge(tmp_path, seed):
    rng = np.random.default_rng(seed)
    leaks, load = 10 ** rng.uniform(11, 12, 2), 10 ** rng.uniform(10, 11)
    changes = {"Rleakl": f"Rleakl de 0 {leaks[0]:.17g}", "Rleakr": f"Rleakr de 0 {leaks[1]:.17g}", "Rload": f"Rload out 0 {load:.17g}"}
    check(tmp_path, Bench("leaky", changes), rng, float(sum(1 / leaks)), 1 / load, SUPPLY)
