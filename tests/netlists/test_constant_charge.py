"""The constant-charge cycle against the conservation of charge and energy.

A switch acts at a time point of ngspice, so short steps place it. The inductors are a tenth of those of the netlist: C(t) must not
change while they charge. So are the strays: 1 fF takes 2e-4 of the charge.
"""

import numpy as np
import pytest

from bench import Bench, Pulses

HOLD, MARGIN = 100.0, 0.5
INDUCTANCE, DAMPING = 1e-3, 1e7
SWITCH = 1.0


def charged(capacitance: float, start: float, supply: float) -> float:
    """Voltage after half an oscillation from `start` with the inductor, whose losses shorten the swing."""
    impedance = np.sqrt(INDUCTANCE / capacitance)
    return supply + (supply - start) * np.exp(-np.pi / 2 * (impedance / DAMPING + SWITCH / impedance))


def peak_voltage(rest: float, peak: float, supply: float) -> float:
    """Voltage at rest after a pulse: the charge at the capacitance where the membrane is 0.5 V above hold, on C2."""
    capacitance = peak * HOLD / (HOLD + MARGIN)
    return charged(capacitance, HOLD + MARGIN, supply) * capacitance / rest


def work(rest: float, peak: float, supply: float) -> float:
    """Area of the membrane's cycle: stretched at hold, charged, relaxed with its charge, discharged to hold at C2, J."""
    capacitance = peak * HOLD / (HOLD + MARGIN)
    low, high = charged(capacitance, HOLD + MARGIN, supply), peak_voltage(rest, peak, supply)
    relaxed = 0.5 * rest * high**2 - 0.5 * capacitance * low**2
    empty = 0.5 * HOLD**2 * (peak - rest) + 0.5 * HOLD**2 * peak * (1 - capacitance / peak)
    return relaxed - empty


def run(folder, rests, peaks, period, supply, saved, step=1e-7):
    count = len(peaks[0])
    pulses = [
        Pulses(rest, tuple(high), tuple(1e-3 + offset + period * k for k in range(count)))
        for rest, high, offset in zip(rests, peaks, (0, period / 2), strict=True)
    ]
    start = f".ic v(in)={supply:.17g}"
    sides = " ".join(f"v({node}{side})={supply:.17g}" for side in "lr" for node in ("c1", "c2", "e1", "e2"))
    changes = {f"L{k}{side}": f"L{k}{side} {nodes} {INDUCTANCE}" for side in "lr" for k, nodes in ((1, f"in c1{side}"), (2, f"e1{side} e2{side}"))}
    changes |= {f"C{k}{side}": f"C{k}{side} {node}{side} 0 0.1f" for side in "lr" for k, node in ((1, "c1"), (2, "c2"), (3, "e1"), (4, "e2"))}
    bench = Bench("constant_charge", changes | {"Vin": f"Vin in 0 {supply:.17g}", ".ic": f"{start} v(hold)=100 v(l)=100 v(r)=100 v(copyl)=100 v(copyr)=100", "+ v(r)=100": f"+ {sides}"})
    return pulses, bench.run(folder, *pulses, period * count, saved, step)


@pytest.mark.parametrize("seed", range(3))
def test_each_pulse_lifts_the_voltage_as_charge_conservation_says(tmp_path, seed):
    rng = np.random.default_rng(seed)
    rests, supply = rng.uniform(12e-12, 18e-12, 2), rng.uniform(700, 1100)
    peaks = rests[:, None] * rng.uniform(1.3, 2.2, (2, 3))
    pulses, found = run(tmp_path, rests, peaks, 0.03, supply, "v(l) v(r)")
    for side, name in enumerate(("v(l)", "v(r)")):
        expected = [peak_voltage(rests[side], peak, supply) for peak in peaks[side]]
        ends = pulses[side].ends()[: 3 - side]
        assert found.at(name, ends) == pytest.approx(np.array(expected[: 3 - side]), rel=1e-4)


def test_what_it_gives_is_the_area_of_the_cycle(tmp_path):
    rest, peak, supply, period = 15e-12, 28.5e-12, 1050.0, 0.03
    pulses, found = run(tmp_path, (rest, rest), ((peak,) * 4, (peak,) * 4), period, supply, "i(vin) i(vhold)")
    window = {"start": 2 * period, "end": 3 * period}
    load = supply**2 / 1e10 * period
    gave = supply * found.integral("i(vin)", **window) + HOLD * found.integral("i(vhold)", **window) + load
    ideal = 0.5 * (2 * supply - HOLD) ** 2 * peak * (peak / rest - 1)
    area = 2 * work(rest, peak, supply)
    print(gave, area, 2 * ideal)
    assert gave == pytest.approx(area, rel=1e-2)
    assert 0.96 * 2 * ideal < gave < 2 * ideal
