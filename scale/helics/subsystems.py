"""Harvester and circuit as a master sees them, stepped to the last bit as `videg cosim` does (run/src/cosim/master.rs)."""

from slave import Slave

Pair = list[float]
"""Of the membranes, left and right."""

CAPACITANCES = ["left.capacitance", "right.capacitance"]
VOLTAGES = ["left.voltage", "right.voltage"]

REACH = 10.0
"""Most times that a step may be longer than the one before if voltages are extrapolated at what they did in that."""

FMUS = {"harvester": "VibroImpactHarvester", "circuit": "HarvestingCircuit"}
"""Federates, and the FMUs that they run."""


class Harvester:
    """The FMU VibroImpactHarvester: voltages in, capacitances out."""

    RECORDED = [
        *CAPACITANCES,
        "left.deflection",
        "right.deflection",
        "left.areaRatio",
        "right.areaRatio",
        "cylinder.position",
        "cylinder.velocity",
        "ball.position",
        "ball.velocity",
        "relativeDisplacement",
        "impact.lastVelocity",
        "gain.voltage",
        "gain.energyEq13",
    ]
    KNOTS = ["impact.nextTime", "pulse.nextKnot"]

    def __init__(self, slave: Slave, parameters: dict[str, str], until: float, extrapolate: bool):
        """For a run up to `until`, s. With `extrapolate`, voltages that act on the ball run on as they did in the step
        before; else they are held."""
        self.slave = slave
        self.slave.start(parameters, until)
        self._outputs = self.slave.references(self.RECORDED + self.KNOTS)
        self._inputs = self.slave.references(VOLTAGES)
        self._feels = self.slave.flag("contact.electrostaticFeedback")
        self._extrapolate = extrapolate
        self._before: Pair = [0.0, 0.0]
        self._last_step = 0.0
        self._read()

    def _read(self) -> None:
        values = self.slave.get(self._outputs)
        self.row = values[: len(self.RECORDED)]
        self.capacitance = values[:2]
        self.knot = min(values[-2:])

    def step(self, now: float, then: float, voltage: Pair) -> None:
        """Steps from `now` to `then`, s, with `voltage`, V, at `now`."""
        step = then - now
        self.slave.set(self._inputs, voltage)
        if self._feels:
            held = not self._extrapolate or step > REACH * self._last_step
            rates = [0.0 if held else (u - before) / self._last_step for u, before in zip(voltage, self._before)]
            self.slave.set_rates(self._inputs, rates)
        self.slave.step(now, step)
        self._before, self._last_step = voltage, step
        self._read()


class Circuit:
    """The FMU HarvestingCircuit: capacitances in, voltages out."""

    RECORDED = [
        *VOLTAGES,
        "load.voltage",
        "load.current",
        "supply.current",
        "supply.energy",
        "load.energy",
        "zener.energy",
        "diode.energy",
        "stored.energy",
        "mechanical.energy",
        "supply.charge",
        "load.charge",
        "leakage.energy",
    ]

    def __init__(self, slave: Slave, parameters: dict[str, str], until: float, capacitance: Pair):
        """For a run up to `until`, s, that starts at `capacitance`, F."""
        self.slave = slave
        self.slave.start(parameters, until, dict(zip(CAPACITANCES, capacitance)))
        self._outputs = self.slave.references(self.RECORDED)
        self._inputs = self.slave.references(CAPACITANCES)
        self._given = capacitance
        self._read()

    def _read(self) -> None:
        self.row = self.slave.get(self._outputs)
        self.voltage = self.row[:2]

    def step(self, now: float, then: float, capacitance: Pair) -> None:
        """Steps from `now` to `then`, s, while the capacitances run linearly to these, F, from those given before."""
        step = then - now
        self.slave.set(self._inputs, self._given)
        self.slave.set_rates(self._inputs, [(end - start) / step for start, end in zip(self._given, capacitance)])
        self.slave.step(now, step)
        self._given = capacitance
        self._read()
