"""The self-priming pump against its recursion: charge is conserved in each stroke, ideal diodes conduct one way."""

from dataclasses import dataclass

import numpy as np
import pytest

from bench import Bench, Pulses

STAGES = 2


def pump(rng) -> dict[str, float]:
    """A membrane and a pump, F."""
    rest = rng.uniform(10e-12, 20e-12)
    return {"rest": rest, "pump": rng.uniform(5e-12, 30e-12)}


def factor(rest: float, peak: float, pump: float) -> float:
    """Growth of the output in a cycle.

    Relaxing, the output rises from v to u and the membrane ends at m u with m = 3/2: C3 v = m C2 u + 2 Cp (u - v). Stretching
    gives back three charges Cp (u - v'): C3 v' = m C2 u + 3 Cp (u - v').
    """
    ratio = (STAGES + 1) / STAGES
    up = (peak + STAGES * pump) / (ratio * rest + STAGES * pump)
    down = (ratio * rest + (STAGES + 1) * pump) / (peak + (STAGES + 1) * pump)
    return up * down


def netlist(pumps: dict[str, float], start: float, leak=1e18) -> Bench:
    """The netlist with both pumps of these capacitances, and with `start` V at the outputs."""
    changes = {}
    for side in "lr":
        small, large = pumps[side], 2 * pumps[side]
        changes |= {
            f"C1{side}": f"C1{side} p{side} a{side} {small:.17g}",
            f"C2{side}": f"C2{side} p{side} b{side} {large:.17g}",
            f"C3{side}": f"C3{side} m{side} 0 {large:.17g}",
            f"C4{side}": f"C4{side} o{side} 0 {small:.17g}",
            f"Rleak{side}": f"Rleak{side} o{side} 0 {leak:.17g}",
        }
    start_of = {"p": 1.5, "a": 0.5, "b": 1.0, "m": 0.5, "o": 1.0}
    lines = [" ".join(f"v({node}{side})={part * start:.17g}" for node, part in start_of.items()) for side in "lr"]
    return Bench("self_priming", changes | {".ic": f".ic {lines[0]}", "+ v(pr)=150": f"+ {lines[1]}"})


def train(rest: float, peak: float, count: int, period: float, offset=0.0, ramp=5e-3) -> Pulses:
    starts = tuple(offset + period * k for k in range(count))
    return Pulses(rest, (peak,) * count, starts, ramp, ramp)


@pytest.mark.parametrize("seed", range(8))
def test_the_output_grows_in_each_cycle_as_charge_conservation_says(tmp_path, seed):
    rng = np.random.default_rng(seed)
    parts = {side: pump(rng) for side in "lr"}
    ratios = {side: rng.uniform(1.55, 2.6) for side in "lr"}
    pulses = {
        side: train(parts[side]["rest"], ratios[side] * parts[side]["rest"], 12, 0.1, offset)
        for side, offset in (("l", 0.01), ("r", 0.06))
    }
    bench = netlist({side: part["pump"] for side, part in parts.items()}, rng.uniform(200, 600))
    found = bench.run(tmp_path, pulses["l"], pulses["r"], 1.2, "v(ol) v(or)")
    for side in "lr":
        outputs = found.at(f"v(o{side})", np.append(0.0, pulses[side].ends()))
        growth = factor(parts[side]["rest"], pulses[side].peaks[0], parts[side]["pump"])
        assert outputs[1:] / outputs[:-1] == pytest.approx(growth, abs=1e-4), side


def test_it_keeps_its_charge_below_the_threshold(tmp_path):
    rest = 15e-12
    pulses = train(rest, 1.45 * rest, 10, 0.1, 0.01)
    found = netlist({"l": 10e-12, "r": 10e-12}, 500.0).run(tmp_path, pulses, pulses, 1.0, "v(ol)")
    assert found.at("v(ol)", pulses.ends()) == pytest.approx(500.0, rel=1e-4)


@dataclass
class State:
    """Voltages of a pump whose membrane is at rest: the capacitors C1 to C4 of the netlist, and the membrane."""

    rest: float
    peak: float
    small: float
    first: float = 1.0
    second: float = 0.5
    middle: float = 0.5
    output: float = 1.0
    membrane: float = 1.5

    def leak(self, kept: float) -> None:
        """The output keeps this part of its voltage. The membrane behind the last diode feeds it through C2."""
        fall = self.output * (1 - kept)
        moved = fall / (1 / self.rest + 1 / (2 * self.small))
        self.output -= fall
        self.membrane -= moved / self.rest
        self.second += moved / (2 * self.small)

    def stretch(self) -> None:
        """C1 from ground, C2 from the first stage, and C4 join the membrane."""
        large = 2 * self.small
        sums, voltages = np.array([self.small, large / 2, self.small]), np.array([self.first, self.second + self.middle, self.output])
        self.membrane = (self.rest * self.membrane + sums @ voltages) / (self.peak + sum(sums))
        gave = sums[1] * (voltages[1] - self.membrane)
        self.first = self.output = self.membrane
        self.second -= gave / large
        self.middle -= gave / large

    def relax(self, clamp: float) -> float:
        """The membrane charges C1 + C3 and C2 + C4, each in series. Returns what flows from the output at the clamp, C."""
        large = 2 * self.small
        series = 1 / (1 / self.small + 1 / large)
        held = self.peak * self.membrane + series * (self.first + self.middle)
        membrane = (held + series * (self.second + self.output)) / (self.rest + 2 * series)
        through = series * (membrane - self.second - self.output)
        spilt = 0.0
        if self.output + through / self.small > clamp:
            membrane = (held + large * (self.second + clamp)) / (self.rest + series + large)
            through = large * (membrane - clamp - self.second)
            spilt = through - self.small * (clamp - self.output)
        into = series * (membrane - self.first - self.middle)
        self.first += into / self.small
        self.middle += into / large
        self.second += through / large
        self.output += (through - spilt) / self.small
        self.membrane = membrane
        return spilt


def growth(state: State, kept: float, cycles=200) -> float:
    """Growth of the output in a cycle, in the end, with a leak."""
    before = state.output
    for _ in range(cycles):
        before = state.output
        state.leak(kept)
        state.stretch()
        state.relax(np.inf)
    return state.output / before


def critical_leak(rest: float, peak: float, small: float, period: float) -> float:
    """The resistance beside the output with which the leak between short pulses takes what a pulse brings, ohm."""
    behind = small + 1 / (1 / rest + 1 / (2 * small))
    low, high = 1e9, 1e16
    while high / low > 1 + 1e-9:
        middle = np.sqrt(low * high)
        grows = growth(State(rest, peak, small), np.exp(-period / (middle * behind))) > 1
        low, high = (low, middle) if grows else (middle, high)
    return np.sqrt(low * high)


def test_the_long_recursion_without_leak_is_the_short_one():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        part, ratio = pump(rng), rng.uniform(1.55, 4)
        rest, peak = part["rest"], ratio * part["rest"]
        assert growth(State(rest, peak, part["pump"]), 1.0) == pytest.approx(factor(rest, peak, part["pump"]), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_it_grows_or_dies_by_the_leak_at_its_output(tmp_path, seed):
    rng = np.random.default_rng(seed)
    part, ratio, period = pump(rng), rng.uniform(1.8, 2.4), 0.1
    rest, peak = part["rest"], ratio * part["rest"]
    critical = critical_leak(rest, peak, part["pump"], period)
    pulses = train(rest, peak, 40, period, 0.05, ramp=1e-4)
    rates = {}
    for part_of_critical in (0.7, 1.0, 1.3):
        bench = netlist({"l": part["pump"], "r": part["pump"]}, 300.0, part_of_critical * critical)
        outputs = bench.run(tmp_path, pulses, Pulses(rest), 4.05, "v(ol)", step=1e-4).at("v(ol)", pulses.ends())
        rates[part_of_critical] = outputs[1:] / outputs[:-1] - 1
    assert rates[1.0][-10:] == pytest.approx(0, abs=1e-4)
    assert np.all(rates[1.3][-10:] > 5e-4)
    # It falls to where the first stage, which keeps its charge, conducts no more.
    assert np.all(rates[0.7] < 0)
    assert np.sum(rates[0.7]) < -0.02


@pytest.mark.parametrize("seed", range(3))
def test_at_the_clamp_the_load_takes_what_the_membrane_gives(tmp_path, seed):
    rng = np.random.default_rng(seed)
    part, ratio, clamp = pump(rng), rng.uniform(1.8, 2.4), 2000.0
    rest, peak = part["rest"], ratio * part["rest"]
    pulses = train(rest, peak, 150, 0.1, 0.01)
    bench = netlist({"l": part["pump"], "r": part["pump"]}, 1900.0)
    bench.changes |= {"Xl": "Vmembrane pl sl 0\nXl sl 0 deg_left\n.ic v(sl)=2850 v(tl)=1900", "Dloadl": "Vload ol tl 0\nDloadl 0 tl load"}
    found = bench.run(tmp_path, pulses, Pulses(rest), 15.0, "v(ol) v(pl) i(vmembrane) i(vload)")
    assert found.at("v(ol)", pulses.ends()[-5:]) == pytest.approx(clamp, rel=1e-5)
    state = State(rest, peak, part["pump"])
    for _ in range(300):
        state.stretch()
        charge = state.relax(1.0)
    expected = charge * clamp**2
    window = {"start": pulses.starts[-2] - 0.005, "end": pulses.starts[-1] - 0.005}
    assert found.integral("v(ol)", "i(vload)", **window) == pytest.approx(expected, rel=1e-4)
    assert -found.integral("v(pl)", "i(vmembrane)", **window) == pytest.approx(expected, rel=1e-4)
